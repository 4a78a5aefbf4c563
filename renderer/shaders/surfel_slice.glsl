// Which surfel an invocation of a pass over a run of surfels has.
#include "surfel_block.glsl"

layout(location = 0) uniform uvec2 slice; // first surfel, a multiple of SURFEL_GROUP; one past the last

// False past the end.
bool surfel_of_slice(out uint i)
{
	uint group = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;

	i = slice.x + group * SURFEL_GROUP + gl_LocalInvocationID.x;
	return i < slice.y;
}

// Place of entry k of surfel i in a block with `each` entries a surfel.
uint surfel_entry(uint i, uint each, uint k)
{
	return (i / SURFEL_GROUP * each + k) * SURFEL_GROUP + i % SURFEL_GROUP;
}
