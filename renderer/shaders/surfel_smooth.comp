#version 450 core
// What shading reads: the light of a surfel and of those around as one weighted
// sum, in the order of the list (surfels_smooth.c has the weights).
layout(local_size_x = 64) in;

#include "surfel_slice.glsl"

layout(binding = 8) uniform samplerBuffer found;
layout(binding = 9) uniform usamplerBuffer first;
layout(binding = 10) uniform usamplerBuffer around; // surfel, weight
layout(std430, binding = 12) writeonly buffer Shown { vec4 shown[]; };

void main()
{
	uint i;

	if (!surfel_of_slice(i))
		return;
	vec3 sum = vec3(0.0);

	uint last = texelFetch(first, int(i) + 1).r;

	for (uint k = texelFetch(first, int(i)).r; k < last; k++) {
		uvec2 one = texelFetch(around, int(k)).rg;

		sum += uintBitsToFloat(one.y) * texelFetch(found, int(one.x)).rgb;
	}
	// The fit may lead below nothing; a NaN must stay one.
	shown[i] = vec4(mix(sum, vec3(0.0), lessThan(sum, vec3(0.0))), 0.0);
}
