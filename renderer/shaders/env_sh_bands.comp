#version 450 core
// check: #define ORDER 5
// One coefficient, about the picture's own axis.
layout(local_size_x = 64) in;

#include "env_sh.glsl"

layout(location = 0) uniform int rows;
shared vec3 part_sums[64];

void main()
{
	uint i = gl_WorkGroupID.x, me = gl_LocalInvocationID.x;
	int l = 0;

	while ((l + 1) * (l + 1) <= int(i))
		l++;
	int m = int(i) - l * l - l;
	uint series = m == 0 ? 0u : m > 0 ? uint(2 * m - 1) : uint(-2 * m);
	vec3 sum = vec3(0.0);

	for (uint row = me; row < uint(rows); row += 64u) {
		vec3 of_row = vec3(0.0);

		for (uint part = 0u; part < uint(PARTS); part++)
			of_row += sums[(row * uint(PARTS) + part) * uint(SERIES) + series].rgb;
		sum += weights[row * uint(ORDER * ORDER) + i] * of_row;
	}
	part_sums[me] = sum;
	for (uint half_ = 32u; half_ > 0u; half_ /= 2u) {
		barrier();
		if (me < half_)
			part_sums[me] += part_sums[me + half_];
	}
	if (me == 0u)
		unturned[i] = vec4(part_sums[0], 0.0);
}
