#version 450 core
// After the last step: the light to where shading, checks and hash read it.
layout(local_size_x = 64) in;

#include "lpv_lattice.glsl"

layout(std430, binding = 13) writeonly buffer StoreBuffer { vec4 stored[]; };
layout(rgba32f, binding = 0) uniform readonly image3D source_red;
layout(rgba32f, binding = 1) uniform readonly image3D source_green;
layout(rgba32f, binding = 2) uniform readonly image3D source_blue;

void main()
{
	uint group = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
	int i = int(group * gl_WorkGroupSize.x + gl_LocalInvocationID.x);

	if (i >= lattice.size.w)
		return;
	ivec3 cell = ivec3(i % lattice.size.x, (i / lattice.size.x) % lattice.size.y,
			   i / (lattice.size.x * lattice.size.y));
	stored[i] = imageLoad(source_red, cell);
	stored[lattice.size.w + i] = imageLoad(source_green, cell);
	stored[2 * lattice.size.w + i] = imageLoad(source_blue, cell);
}
