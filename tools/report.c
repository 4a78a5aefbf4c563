#include "tools/report.h"

#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define REPORT_BYTES_MAX (1024 * 1024)
#define REPORT_PATH_MAX 64

struct json_object *report_load(const char *path)
{
	int fd = open(path, O_RDONLY | O_CLOEXEC);
	struct json_object *object = NULL;
	struct stat status;

	if (fd < 0)
		return NULL;
	if (fstat(fd, &status) == 0 && S_ISREG(status.st_mode) &&
	    status.st_size <= REPORT_BYTES_MAX)
		object = json_object_from_fd(fd);
	close(fd);
	if (object && !json_object_is_type(object, json_type_object)) {
		json_object_put(object);
		object = NULL;
	}
	return object;
}

struct json_object *report_member(struct json_object *object, const char *path)
{
	char name[REPORT_PATH_MAX];

	while (object) {
		size_t n = strcspn(path, ".");

		if (n >= sizeof name || !json_object_is_type(object, json_type_object))
			return NULL;
		memcpy(name, path, n);
		name[n] = '\0';
		if (!json_object_object_get_ex(object, name, &object))
			return NULL;
		if (path[n] == '\0')
			return object;
		path += n + 1;
	}
	return NULL;
}

int64_t report_count(struct json_object *object, const char *path)
{
	return json_object_get_int64(report_member(object, path));
}

double report_number(struct json_object *object, const char *path)
{
	return json_object_get_double(report_member(object, path));
}

const char *report_text(struct json_object *object, const char *path)
{
	struct json_object *member = report_member(object, path);

	return json_object_is_type(member, json_type_string) ? json_object_get_string(member) : "?";
}

struct json_object *report_named(struct json_object *object, const char *path, const char *name)
{
	struct json_object *array = report_member(object, path);

	if (!json_object_is_type(array, json_type_array))
		return NULL;
	for (size_t i = 0; i < json_object_array_length(array); i++) {
		struct json_object *element = json_object_array_get_idx(array, i);

		if (strcmp(report_text(element, "name"), name) == 0)
			return element;
	}
	return NULL;
}
