#version 450 core
// Light of the surfels on the probes, spherical harmonics of three bands: one
// coefficient of one probe an invocation, its links in order.
layout(local_size_x = 64) in;

#include "probe_grid.glsl"
#include "surfel_air.glsl"

layout(location = 0) uniform uvec2 counts;     // coefficients of all probes; links of each
layout(location = 1) uniform float extinction; // log2 of what a metre lets through
layout(location = 2) uniform float more;       // 1/m that the air takes, than when fixed_light was baked
layout(binding = 8) uniform samplerBuffer radiosity;
layout(binding = 9) uniform usamplerBuffer surfel_texels; // two a surfel
layout(binding = 10) uniform usamplerBuffer links;
layout(binding = 11) uniform samplerBuffer basis; // PROBE_SH a link
layout(binding = 12) uniform samplerBuffer fixed_light;
layout(binding = 13) uniform samplerBuffer ways; // one a probe: mean, variance
layout(std430, binding = 12) writeonly buffer Light { vec4 light[]; };

void main()
{
	uint group = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
	uint at = group * gl_WorkGroupSize.x + gl_LocalInvocationID.x;

	if (at >= counts.x)
		return;
	uint probe = at / uint(PROBE_SH), c = at % uint(PROBE_SH);
	uvec3 size = uvec3(probes.size.xyz);
	vec3 here = probes.origin.xyz +
		    probes.origin.w * vec3(probe % size.x, probe / size.x % size.y, probe / (size.x * size.y));
	vec3 sum = vec3(0.0);

	for (uint k = 0u; k < counts.y; k++) {
		int link = int(texelFetch(links, int(probe * counts.y + k)).r);
		vec3 b = texelFetch(radiosity, link).rgb *
			 texelFetch(basis, int(uint(PROBE_SH) * k + c)).r;

		if (extinction != 0.0)
			b *= exp2(extinction *
				  distance(here, uintBitsToFloat(texelFetch(surfel_texels, 2 * link).xyz)));
		sum += b;
	}
	// radiance b/pi, each link 4 pi / links steradians
	vec3 fixed_now = texelFetch(fixed_light, int(at)).rgb *
			 surfel_thinned(texelFetch(ways, int(probe)).rg, more);

	light[at] = vec4(fixed_now + sum * (4.0 / float(counts.y)), 0.0);
}
