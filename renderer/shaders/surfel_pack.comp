#version 450 core
// A slice's light as two words a surfel. STAGE 0: the largest values; 1: the words.
// check: #define STAGE 1
layout(local_size_x = 64) in;

#include "surfel_slice.glsl"
#include "surfel_packed.glsl"

layout(location = 1) uniform uint place; // of the slice among the scales
layout(binding = 8) uniform samplerBuffer radiosity;
layout(std430, binding = 8) writeonly buffer Words { uvec2 words[]; };
layout(binding = 9) uniform samplerBuffer found;
// largest radiosity and irradiance as float bits, then their exponents (unpacking reads those)
layout(std430, binding = 15) buffer Scales { uvec4 scales[]; };

uint largest(vec3 c)
{
	c = mix(c, vec3(0.0), lessThan(c, vec3(0.0)));
	return any(isnan(c)) || any(isinf(c)) ? 0u : floatBitsToUint(max(max(c.r, c.g), c.b));
}

void main()
{
	uint i;

	if (!surfel_of_slice(i))
		return;
	vec3 b = texelFetch(radiosity, int(i)).rgb, e = texelFetch(found, int(i)).rgb;
#if STAGE == 0
	atomicMax(scales[place].x, largest(b));
	atomicMax(scales[place].y, largest(e));
#else
	uvec2 scale = min(uvec2(packed_exponent(scales[place].x), packed_exponent(scales[place].y)),
			  uvec2(254u));

	words[i] = uvec2(packed_colour(b, scale.x), packed_colour(e, scale.y));
	if (i == slice.x)
		scales[place].zw = scale;
#endif
}
