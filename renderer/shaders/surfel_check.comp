#version 450 core
// Looks at the surfels after the last gather: those that are not finite, the
// largest change and the largest value (as float bits). Read back later, for
// people; nothing that is drawn depends on it.
layout(local_size_x = 64) in;

#include "surfel_slice.glsl"

layout(binding = 8) uniform samplerBuffer radiosity;
layout(binding = 9) uniform samplerBuffer before;
layout(binding = 10) uniform samplerBuffer found;
layout(std430, binding = 15) buffer CheckBuffer {
	uint nonfinite, change, largest, probes_nonfinite;
} check;
shared uint group_nonfinite, group_change, group_largest;

void main()
{
	uint i;
	bool mine = surfel_of_slice(i);

	if (gl_LocalInvocationID.x == 0u) {
		group_nonfinite = 0u;
		group_change = 0u;
		group_largest = 0u;
	}
	barrier();
	if (mine) {
		vec3 now = texelFetch(radiosity, int(i)).rgb, e = texelFetch(found, int(i)).rgb;
		vec3 moved = abs(now - texelFetch(before, int(i)).rgb);

		if (any(isnan(now)) || any(isinf(now)) || any(isnan(e)) || any(isinf(e))) {
			atomicAdd(group_nonfinite, 1u);
		} else {
			atomicMax(group_change, floatBitsToUint(max(max(moved.r, moved.g), moved.b)));
			atomicMax(group_largest, floatBitsToUint(max(max(now.r, now.g), now.b)));
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
