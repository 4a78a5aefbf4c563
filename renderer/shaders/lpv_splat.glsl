// Reflective shadow maps to cells without floating-point atomics. Every
// texel's flux becomes a 64 bit fixed-point number (two words, carried by
// hand): sums do not depend on the order, so equal nodes get equal bits.
//
// The unit of the fixed point follows the brightest texel: a run of 16 texels
// stays under 2^38 units, 2^25 runs fit before the sign bit.
#include "lpv_front.glsl"

layout(binding = 13) uniform sampler2DArray position_area_map;
layout(binding = 14) uniform sampler2DArray normal_map;
layout(binding = 15) uniform sampler2DArray exitance_map;
layout(location = 0) uniform ivec3 map_size; // pixels, layers, runs per side
layout(std430, binding = 14) buffer SplatBuffer {
	uint peak;       // bits of the largest texel flux of any band
	uint bad_texels; // not finite: left out and counted
	uint unused_0, unused_1;
	uint fixed_sum[]; // per cell 12 pairs: low word, high word
} splat;

const int RUN = 4; // a run is RUN x RUN texels

bool finite3(vec3 v)
{
	return !any(isnan(v)) && !any(isinf(v));
}

// Exact power of two; exp2() may round.
float power_of_two(int e)
{
	return uintBitsToFloat(uint(clamp(e, -126, 127) + 127) << 23);
}

int unit_exponent()
{
	return clamp(33 - (int(splat.peak >> 23) - 127), -120, 120);
}

// This invocation's run of texels; false past the last.
bool run_start(out ivec3 start)
{
	uint group = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
	uint run = group * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
	uint side = uint(map_size.z);

	start = ivec3(RUN * int(run % side), RUN * int((run / side) % side), int(run / (side * side)));
	return start.z < map_size.y;
}
