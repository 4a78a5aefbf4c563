#include "tools/demo_plan.h"

#include "base/result.h"

#include <config.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#define LOOPBACK "127.0.0.1"
/* Below this a wall's picture says nothing, above it no GL target can be made. */
#define PIXELS_MIN 16
#define PIXELS_MAX 16384

static int set_text(char **text, const char *value)
{
	char *copy = value ? strdup(value) : NULL;

	if (value && !copy)
		return GR_ERR_NOMEM;
	free(*text);
	*text = copy;
	return GR_OK;
}

/* A UDP port that was free a moment ago; *out_fd holds it until it is closed. */
static int free_port(uint16_t *out_port, int *out_fd)
{
	struct sockaddr_in address = { .sin_family = AF_INET,
				       .sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
	socklen_t size = sizeof address;

	*out_fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
	if (*out_fd < 0)
		return GR_ERR_IO;
	if (bind(*out_fd, (struct sockaddr *)&address, sizeof address) != 0 ||
	    getsockname(*out_fd, (struct sockaddr *)&address, &size) != 0)
		return GR_ERR_IO;
	*out_port = ntohs(address.sin_port);
	return GR_OK;
}

/* All ports are held until all are known, so that no two are the same. */
static int choose_ports(struct layout *layout)
{
	int held[LAYOUT_MAX_NODES + 1];
	size_t count = 0;
	int result = GR_OK;
	int error;

	for (size_t i = 0; i <= layout->node_count && result == GR_OK; i++) {
		uint16_t *port = i < layout->node_count ? &layout->nodes[i].port
							: &layout->network.master_port;

		result = free_port(port, &held[count]);
		if (held[count] >= 0)
			count++;
	}
	error = errno;
	for (size_t i = 0; i < count; i++)
		close(held[i]);
	errno = error;
	return result;
}

static int plan_network(const struct demo_plan *plan, struct layout *layout)
{
	struct layout_network *network = &layout->network;
	int result = set_text(&network->master_address, LOOPBACK);

	for (size_t i = 0; i < layout->node_count && result == GR_OK; i++)
		result = set_text(&layout->nodes[i].address, LOOPBACK);
	if (result == GR_OK)
		result = set_text(&network->interface, NULL);
	if (result == GR_OK)
		result = set_text(&network->group, NULL);
	if (result == GR_OK)
		result = set_text(&network->key_file, NULL);
	if (result == GR_OK)
		result = set_text(&layout->control_socket, plan->control_socket);
	network->cast = LAYOUT_UNICAST;
	return result == GR_OK ? choose_ports(layout) : result;
}

/* Files named beside the old layout are not beside the new one. */
static int plan_files(struct layout *layout)
{
	char folder[PATH_MAX];
	char path[PATH_MAX];
	char *slash;

	if (!realpath(layout->path, folder))
		return GR_ERR_IO;
	slash = strrchr(folder, '/');
	if (slash)
		*slash = '\0';
	for (size_t i = 0; i < layout->tracker_count; i++) {
		struct layout_tracker *tracker = &layout->trackers[i];
		int n;

		if (!tracker->file || tracker->file[0] == '/')
			continue;
		n = snprintf(path, sizeof path, "%s/%s", folder, tracker->file);
		if (n < 0 || (size_t)n >= sizeof path) {
			errno = ENAMETOOLONG;
			return GR_ERR_IO;
		}
		if (set_text(&tracker->file, path) != GR_OK)
			return GR_ERR_NOMEM;
	}
	return GR_OK;
}

static int plan_pixels(const struct demo_plan *plan, struct layout *layout, struct gr_diag *diag)
{
	for (size_t i = 0; i < layout->wall_count; i++) {
		struct layout_wall *wall = &layout->walls[i];

		for (int k = 0; k < 2; k++) {
			float pixels = rintf((float)wall->pixels[k] * plan->pixels_scale);

			if (!(pixels >= PIXELS_MIN && pixels <= PIXELS_MAX)) {
				gr_diag_add(diag, GR_DIAG_ERROR, layout->path, wall->line, wall->name,
					    "scaled by %g it would be %g pixels %s; give a scale "
					    "that leaves %d to %d", (double)plan->pixels_scale,
					    (double)pixels, k ? "high" : "wide", PIXELS_MIN,
					    PIXELS_MAX);
				return GR_ERR_CONFIG;
			}
			wall->pixels[k] = (int)pixels;
		}
	}
	return GR_OK;
}

static void plan_targets(const struct demo_plan *plan, struct layout *layout)
{
	for (size_t i = 0; i < layout->node_count; i++) {
		struct layout_node *node = &layout->nodes[i];

		node->target = plan->window ? LAYOUT_TARGET_WINDOW : LAYOUT_TARGET_HEADLESS;
		node->gpu = -1;
		/* The room's projectors are not here: pictures are for people who look at files. */
		free(node->projector.table);
		node->projector = (struct layout_projector){ .gain = { 1, 1, 1 },
							     .gamma = { NAN, NAN, NAN } };
		/* Quad buffers need a stereo screen, which a demo cannot count on. */
		if (node->eyes == LAYOUT_EYES_QUAD_BUFFER ||
		    (plan->stereo && node->eyes == LAYOUT_EYES_MONO))
			node->eyes = LAYOUT_EYES_SIDE_BY_SIDE;
	}
}

int demo_plan_apply(const struct demo_plan *plan, struct layout *layout, struct gr_diag *diag)
{
	int result = plan_pixels(plan, layout, diag);

	if (result != GR_OK)
		return result;
	plan_targets(plan, layout);
	if (plan->rate_hz > 0)
		layout->rates.frame_hz = plan->rate_hz;
	result = plan_files(layout);
	if (result == GR_OK)
		result = plan_network(plan, layout);
	if (result != GR_OK)
		gr_diag_add(diag, GR_DIAG_ERROR, layout->path, 0, NULL, "a loopback layout: %s",
			    result == GR_ERR_IO ? strerror(errno) : gr_result_name(result));
	return result;
}
