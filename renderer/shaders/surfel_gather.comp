#version 450 core
// One bounce: the light that the linked surfels reflect, as irradiance, and
// what a patch then reflects itself. Sums in the order of the links, nothing
// added by other invocations: equal inputs, equal bits.
// check: #define MEDIUM
layout(local_size_x = 64) in;

#include "surfel_slice.glsl"

layout(binding = 8) uniform samplerBuffer radiosity; // of the last gather; one more, dark, at the end
#ifdef MEDIUM
layout(binding = 9) uniform usamplerBuffer surfel_texels; // two a surfel
layout(location = 2) uniform float extinction;            // log2 of what a metre lets through
#endif
layout(binding = 10) uniform usamplerBuffer links;   // four a texel; the last are dark
layout(location = 1) uniform uint link_base;         // of the bound part of the links: its first surfel
layout(binding = 11) uniform samplerBuffer albedo;
layout(binding = 12) uniform samplerBuffer emissive;
layout(binding = 13) uniform samplerBuffer direct;
layout(binding = 14) uniform samplerBuffer other;
layout(std430, binding = 12) writeonly buffer Found { vec4 found[]; };
layout(std430, binding = 14) writeonly buffer Radiosity { vec4 next[]; };

void main()
{
	uint i;

	if (!surfel_of_slice(i))
		return;
	uint each = surfels.counts.y, texels = (each + 3u) / 4u;
	uint at = surfel_entry(i - link_base, texels, 0u);
	vec3 sum = vec3(0.0);
#ifdef MEDIUM
	vec3 here = uintBitsToFloat(texelFetch(surfel_texels, int(2u * i)).xyz);
#endif

	for (uint k = 0u; k < texels; k++) {
		uvec4 four = texelFetch(links, int(at + k * SURFEL_GROUP));

		for (int j = 0; j < 4; j++) {
			vec3 b = texelFetch(radiosity, int(four[j])).rgb;
#ifdef MEDIUM
			vec3 there = uintBitsToFloat(texelFetch(surfel_texels, int(2u * four[j])).xyz);

			b *= exp2(extinction * distance(here, there));
#endif
			sum += b;
		}
	}
	vec3 e = sum / float(each) + texelFetch(other, int(i)).rgb;
	vec3 lit = texelFetch(direct, int(i)).rgb + texelFetch(emissive, int(i)).rgb + e;

	found[i] = vec4(e, 0.0);
	next[i] = vec4(texelFetch(albedo, int(i)).rgb * lit, 0.0);
}
