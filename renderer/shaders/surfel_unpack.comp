#version 450 core
// A slice's words back into light, where gathers and smoothing read it.
layout(local_size_x = 64) in;

#include "surfel_slice.glsl"
#include "surfel_packed.glsl"

layout(location = 1) uniform uint place; // of the slice among the scales
layout(std430, binding = 8) readonly buffer Words { uvec2 words[]; };
layout(std430, binding = 12) writeonly buffer Found { vec4 found[]; };
layout(std430, binding = 13) writeonly buffer RadiosityA { vec4 radiosity_a[]; };
layout(std430, binding = 14) writeonly buffer RadiosityB { vec4 radiosity_b[]; };
layout(std430, binding = 15) readonly buffer Scales { uvec4 scales[]; };

void main()
{
	uint i;

	if (!surfel_of_slice(i))
		return;
	uvec2 word = words[i], scale = scales[place].zw;
	vec4 b = vec4(unpacked_colour(word.x, scale.x), 0.0);
	vec4 e = vec4(unpacked_colour(word.y, scale.y), 0.0);

	found[i] = e;
	radiosity_a[i] = b;
	radiosity_b[i] = b;
}
