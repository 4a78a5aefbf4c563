#version 450 core
// What shading reads: the light of a surfel and of those around as one weighted
// sum, in the order of the list (surfels_smooth.c has the weights).
layout(local_size_x = 64) in;

#include "surfel_slice.glsl"

layout(binding = 8) uniform samplerBuffer found;
layout(std430, binding = 9) readonly buffer First { uint first[]; };
layout(std430, binding = 10) readonly buffer Around { uvec2 around[]; }; // surfel, weight
layout(std430, binding = 11) writeonly buffer Shown { vec4 shown[]; };

void main()
{
	uint i;

	if (!surfel_of_slice(i))
		return;
	vec3 sum = vec3(0.0);

	for (uint k = first[i]; k < first[i + 1u]; k++)
		sum += uintBitsToFloat(around[k].y) * texelFetch(found, int(around[k].x)).rgb;
	// The fit may lead below nothing; a NaN must stay one.
	shown[i] = vec4(mix(sum, vec3(0.0), lessThan(sum, vec3(0.0))), 0.0);
}
