/* Light that does not change: of emissive surfaces and of the environment. */
#include "renderer/gi/surfel_bake_private.h"

#include "base/result.h"

#include <stdlib.h>

int bake_fixed(struct bake *bake)
{
	struct surfel_set *set = bake->set;

	set->fixed_emissive = calloc(set->count + 1, sizeof *set->fixed_emissive);
	set->fixed_other = calloc(set->count + 1, sizeof *set->fixed_other);
	return set->fixed_emissive && set->fixed_other ? GR_OK : GR_ERR_NOMEM;
}
