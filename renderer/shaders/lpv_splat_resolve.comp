#version 450 core
// Fixed-point sums to what the propagation injects; leaves them at zero.
layout(local_size_x = 64) in;

#include "lpv_splat.glsl"

layout(std430, binding = 11) writeonly buffer InjectBuffer { vec4 inject[]; };
layout(std430, binding = 12) writeonly buffer SourceBuffer { vec4 emitted[]; };

float take_fixed(uint at)
{
	uint low = splat.fixed_sum[at], high = splat.fixed_sum[at + 1u];
	bool negative = (high & 0x80000000u) != 0u;

	splat.fixed_sum[at] = 0u;
	splat.fixed_sum[at + 1u] = 0u;
	if (negative) {
		low = ~low + 1u;
		high = ~high + (low == 0u ? 1u : 0u);
	}
	float value = (float(high) * 4294967296.0 + float(low)) * power_of_two(-unit_exponent());

	return negative ? -value : value;
}

void main()
{
	uint group = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
	uint cell = group * gl_WorkGroupSize.x + gl_LocalInvocationID.x;

	if (cell >= uint(lattice.size.w))
		return;
	for (uint c = 0u; c < 3u; c++) {
		vec4 sum;

		for (uint i = 0u; i < 4u; i++)
			sum[i] = take_fixed(24u * cell + 8u * c + 2u * i);
		inject[c * uint(lattice.size.w) + cell] = sum;
		emitted[c * uint(lattice.size.w) + cell] = sum;
	}
}
