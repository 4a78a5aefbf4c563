#include "tracking/source.h"

#include <stddef.h>

int track_poll(struct track_source *source, int64_t now_ns, struct track_sample *out, int room)
{
	return room > 0 ? source->ops->poll(source, now_ns, out, room) : 0;
}

int track_fd(const struct track_source *source)
{
	return source->ops->fd ? source->ops->fd(source) : -1;
}

int64_t track_next(const struct track_source *source, int64_t now_ns)
{
	return source->ops->next ? source->ops->next(source, now_ns) : INT64_MAX;
}

const char *track_body_name(enum track_body body)
{
	static const char *const name[TRACK_BODIES] = { "head", "wand" };

	return (unsigned)body < TRACK_BODIES ? name[body] : "unknown body";
}

void track_source_destroy(struct track_source **source)
{
	if (!*source)
		return;
	(*source)->ops->destroy(*source);
	*source = NULL;
}
