#include "renderer/renderer_private.h"

#include "base/result.h"

static const struct gi_share_ops *share_ops(const struct renderer *r)
{
	return r->gi ? r->gi->ops->share : NULL;
}

size_t renderer_share_bytes(const struct renderer *renderer, unsigned nodes)
{
	const struct gi_share_ops *ops = share_ops(renderer);
	size_t most = 0;

	for (unsigned count = 2; ops && count <= nodes; count++) {
		const size_t all = count * ops->bytes_max(renderer->gi, count);

		most = all > most ? all : most;
	}
	return most;
}

int renderer_share_set(struct renderer *renderer, unsigned index, unsigned count)
{
	const struct gi_share_ops *ops = share_ops(renderer);

	return ops ? ops->set(renderer->gi, index, count) : GR_ERR_UNSUPPORTED;
}

int renderer_share_take(struct renderer *renderer, uint8_t *bytes, size_t size, size_t *out_len)
{
	const struct gi_share_ops *ops = share_ops(renderer);

	*out_len = 0;
	return ops ? ops->take(renderer->gi, bytes, size, out_len) : GR_ERR_UNSUPPORTED;
}

int renderer_share_put(struct renderer *renderer, const uint8_t *bytes, size_t len)
{
	const struct gi_share_ops *ops = share_ops(renderer);

	return ops ? ops->put(renderer->gi, bytes, len) : GR_ERR_UNSUPPORTED;
}
