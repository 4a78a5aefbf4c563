#include "config/layout_check.h"

#include <string.h>
#include <sys/un.h>

static void check_wall_names(struct options_reader *reader, struct layout_file *file)
{
	for (size_t i = 0; i < file->wall_count; i++)
		for (size_t j = 0; j < i; j++)
			if (file->walls[i].name[0] && !strcmp(file->walls[i].name, file->walls[j].name))
				options_fault(reader, GR_DIAG_ERROR, file->walls[i].at, "name",
					      "wall \"%s\" is there twice; each wall needs a name of its own",
					      file->walls[i].name);
}

/* Nobody waits longer than the barrier does: a limit past that would never be met. */
static void check_slow(struct options_reader *reader, const struct layout_file *file)
{
	const struct layout_slow *slow = &file->slow.slow;
	const double deadline_ms = (double)file->rates.rates.barrier_deadline_ns * 1e-6;
	const double most_ms = (double)slow->wait_most_ns * 1e-6, limit_ms = (double)slow->limit_ns * 1e-6;
	const bool waits = slow->policy == LAYOUT_SLOW_WAIT;

	if (!file->slow.at)
		return;
	if (waits && most_ms < deadline_ms)
		options_fault(reader, GR_DIAG_ERROR, file->slow.at, "wait_most_ms",
			      "%g ms is less than all wait anyway (rates.barrier_deadline_ms, %g)", most_ms,
			      deadline_ms);
	else if (waits && limit_ms > most_ms)
		options_fault(reader, GR_DIAG_ERROR, file->slow.at, "limit_ms",
			      "%g ms, but nobody waits longer than wait_most_ms, %g", limit_ms, most_ms);
	else if (!waits && limit_ms > deadline_ms)
		options_fault(reader, GR_DIAG_ERROR, file->slow.at, "limit_ms",
			      "%g ms, but nobody waits longer than rates.barrier_deadline_ms, %g", limit_ms,
			      deadline_ms);
}

static void check_control_socket(struct options_reader *reader, const struct layout_file *file)
{
	const struct sockaddr_un address;
	const char *path = file->control_socket;

	if (!path)
		return;
	if (path[0] != '/')
		options_fault(reader, GR_DIAG_ERROR, file->at, "control_socket",
			      "\"%.100s\" is not absolute; a daemon has no folder of its own, begin with '/'",
			      path);
	else if (strlen(path) >= sizeof address.sun_path)
		options_fault(reader, GR_DIAG_ERROR, file->at, "control_socket",
			      "%zu bytes; a socket's path has at most %zu", strlen(path),
			      sizeof address.sun_path - 1);
}

void layout_check(struct options_reader *reader, struct layout_file *file)
{
	if (!file->wall_count && options_given(file->at, "walls"))
		options_fault(reader, GR_DIAG_ERROR, file->at, "walls", "no walls; a room needs one");
	check_wall_names(reader, file);
	layout_check_walls(reader, file);
	layout_check_nodes(reader, file);
	layout_check_room(reader, file);
	layout_check_network(reader, file);
	layout_check_trackers(reader, file);
	layout_check_hand(reader, file);
	check_slow(reader, file);
	check_control_socket(reader, file);
}
