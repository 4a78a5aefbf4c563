/* Which of several HID devices is meant, and what it says of itself. */
#include "tracking/hid.h"

#include "base/result.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

bool track_hid_has_usage(const struct track_hid_node *node, uint32_t usage)
{
	for (int i = 0; i < TRACK_HID_USAGES; i++)
		if (node->usages[i] == usage)
			return true;
	return false;
}

const char *track_hid_port(const struct track_hid_node *node)
{
	const char *slash = strrchr(node->device, '/');

	return slash ? slash + 1 : node->device;
}

int track_hid_choice_set(struct track_hid_choice *choice, const char *serial, const char *path,
			 int number)
{
	*choice = (struct track_hid_choice){ .number = number };
	if ((serial && strlen(serial) >= sizeof choice->serial) ||
	    (path && strlen(path) >= sizeof choice->path))
		return GR_ERR_RANGE;
	strcpy(choice->serial, serial ? serial : "");
	strcpy(choice->path, path ? path : "");
	return GR_OK;
}

static bool fits(const struct track_hid_choice *choice, const struct track_hid_node *node)
{
	return (!choice->serial[0] || !strcmp(choice->serial, node->serial)) &&
	       (!choice->path[0] || !strcmp(choice->path, track_hid_port(node)));
}

const struct track_hid_node *track_hid_choose(const struct track_hid_choice *choice,
					      const struct track_hid_node *nodes, int count,
					      const char *what, char *why, size_t size)
{
	char number[24] = "";
	int found = 0;

	for (int i = 0; i < count; i++)
		if (fits(choice, &nodes[i]) && found++ == choice->number)
			return &nodes[i];
	if (choice->number)
		snprintf(number, sizeof number, " number %d", choice->number);
	snprintf(why, size, "no %s%s%s%s%s%s is plugged in", what, number,
		 choice->serial[0] ? " with serial number " : "", choice->serial,
		 choice->path[0] ? " at USB " : "", choice->path);
	return NULL;
}

size_t track_hid_descriptor(const struct track_hid_node *node, uint8_t *out, size_t room)
{
	const char *name = strrchr(node->path, '/');
	char path[128];
	size_t len = 0;
	ssize_t n = 1;
	uint8_t more;
	int fd;

	snprintf(path, sizeof path, "/sys/class/hidraw/%s/device/report_descriptor",
		 name ? name + 1 : node->path);
	fd = open(path, O_RDONLY | O_CLOEXEC);
	if (fd < 0)
		return 0;
	while (n > 0 && len < room) {
		n = read(fd, out + len, room - len);
		len += n > 0 ? (size_t)n : 0;
	}
	/* One that goes on is not cut short: what it says would be something else. */
	if (n < 0 || (n > 0 && read(fd, &more, 1) == 1))
		len = 0;
	close(fd);
	return len;
}
