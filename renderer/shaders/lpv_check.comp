#version 450 core
// Looks at the light after the last step: cells that are not finite, the
// largest change and the largest value (as float bits). Read back later, for
// people; nothing that is drawn depends on it.
layout(local_size_x = 64) in;

#include "lpv_lattice.glsl"

layout(binding = 11) uniform samplerBuffer before;
layout(std430, binding = 15) buffer CheckBuffer {
	uint nonfinite, change, largest, bad_texels;
} check;
shared uint group_nonfinite, group_change, group_largest;

void main()
{
	uint group = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
	uint cell = group * gl_WorkGroupSize.x + gl_LocalInvocationID.x;

	if (gl_LocalInvocationID.x == 0u) {
		group_nonfinite = 0u;
		group_change = 0u;
		group_largest = 0u;
	}
	barrier();
	if (cell < uint(lattice.size.w)) {
		bool bad = false;
		float change = 0.0, largest = 0.0;

		for (uint c = 0u; c < 3u; c++) {
			vec4 now = texelFetch(light, int(uint(lattice.size.w) * c + cell));

			bad = bad || any(isnan(now)) || any(isinf(now));
			vec4 moved = abs(now - texelFetch(before, int(uint(lattice.size.w) * c + cell)));
			change = max(change, max(max(moved.x, moved.y), max(moved.z, moved.w)));
			largest = max(largest, abs(now.x));
		}
		if (bad) {
			atomicAdd(group_nonfinite, 1u);
		} else {
			atomicMax(group_change, floatBitsToUint(change));
			atomicMax(group_largest, floatBitsToUint(largest));
		}
	}
	barrier();
	if (gl_LocalInvocationID.x == 0u) {
		if (group_nonfinite != 0u)
			atomicAdd(check.nonfinite, group_nonfinite);
		atomicMax(check.change, group_change);
		atomicMax(check.largest, group_largest);
	}
}
