#version 450 core
// One bounce: the light that the linked surfels reflect, as irradiance, and
// what a patch then reflects itself. Sums in the order of the links, nothing
// added by other invocations: equal inputs, equal bits.
// check: #define MEDIUM
layout(local_size_x = 64) in;

#include "surfel_slice.glsl"

layout(binding = 8) uniform samplerBuffer radiosity; // of the last gather; one more, dark, at the end
layout(location = 1) uniform uint link_base;         // of the bound part of the links: its first surfel
#ifdef MEDIUM
layout(binding = 9) uniform usamplerBuffer surfel_texels; // two a surfel
layout(location = 2) uniform float extinction;            // log2 of what a metre lets through
#endif
layout(std430, binding = 9) readonly buffer Links { uint links[]; };
layout(std430, binding = 10) readonly buffer Albedo { vec4 albedo[]; };
layout(std430, binding = 11) readonly buffer Emissive { vec4 emissive[]; };
layout(std430, binding = 12) writeonly buffer Found { vec4 found[]; };
layout(std430, binding = 13) readonly buffer Direct { vec4 direct[]; };
layout(std430, binding = 14) writeonly buffer Radiosity { vec4 next[]; };
layout(std430, binding = 15) readonly buffer Other { vec4 other[]; };

void main()
{
	uint i;

	if (!surfel_of_slice(i))
		return;
	uint each = surfels.counts.y;
	uint at = surfel_entry(i - link_base, each, 0u);
	vec3 sum = vec3(0.0);
#ifdef MEDIUM
	vec3 here = uintBitsToFloat(texelFetch(surfel_texels, int(2u * i)).xyz);
#endif

	for (uint k = 0u; k < each; k++) {
		uint link = links[at + k * SURFEL_GROUP];
		vec3 b = texelFetch(radiosity, int(link)).rgb;
#ifdef MEDIUM
		vec3 there = uintBitsToFloat(texelFetch(surfel_texels, int(2u * link)).xyz);

		b *= exp2(extinction * distance(here, there));
#endif
		sum += b;
	}
	vec3 e = sum / float(each) + other[i].rgb;

	found[i] = vec4(e, 0.0);
	next[i] = vec4(albedo[i].rgb * (direct[i].rgb + emissive[i].rgb + e), 0.0);
}
