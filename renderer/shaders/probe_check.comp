#version 450 core
// Looks at the light of the probes: how many have a coefficient that is not
// finite. Read back later, for people; nothing that is drawn depends on it.
layout(local_size_x = 64) in;

#include "probe_grid.glsl"

layout(location = 0) uniform uint count; // of probes
layout(binding = 8) uniform samplerBuffer light; // PROBE_SH a probe
layout(std430, binding = 15) buffer CheckBuffer {
	uint nonfinite, change, largest, probes_nonfinite;
} check;

void main()
{
	uint group = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
	uint i = group * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
	bool bad = false;

	if (i >= count)
		return;
	for (int c = 0; c < PROBE_SH; c++) {
		vec3 e = texelFetch(light, PROBE_SH * int(i) + c).rgb;

		bad = bad || any(isnan(e)) || any(isinf(e));
	}
	if (bad)
		atomicAdd(check.probes_nonfinite, 1u);
}
