#version 450 core
// Slices' words back into light, where gathers and smoothing read it.
layout(local_size_x = 64) in;

#include "surfel_slice.glsl"
#include "surfel_packed.glsl"

layout(location = 1) uniform uvec2 cut; // slices; groups of surfels in all
layout(binding = 8) uniform usamplerBuffer words;
layout(binding = 9) uniform usamplerBuffer scales; // of each slice
layout(std430, binding = 12) writeonly buffer Found { vec4 found[]; };
layout(std430, binding = 13) writeonly buffer RadiosityA { vec4 radiosity_a[]; };
layout(std430, binding = 14) writeonly buffer RadiosityB { vec4 radiosity_b[]; };

void main()
{
	uint i;

	if (!surfel_of_slice(i))
		return;
	// the last slice that begins no later (run_of in surfels_share.c)
	uint place = ((i / SURFEL_GROUP + 1u) * cut.x - 1u) / cut.y;
	uvec2 word = texelFetch(words, int(i)).rg, scale = texelFetch(scales, int(place)).zw;
	vec4 b = vec4(unpacked_colour(word.x, scale.x), 0.0);
	vec4 e = vec4(unpacked_colour(word.y, scale.y), 0.0);

	found[i] = e;
	radiosity_a[i] = b;
	radiosity_b[i] = b;
}
