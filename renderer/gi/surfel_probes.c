/* Probes for what moves: links over the whole sphere. */
#include "renderer/gi/surfel_bake_private.h"

#include "base/result.h"

int bake_probes(struct bake *bake)
{
	(void)bake;
	return GR_OK;
}
