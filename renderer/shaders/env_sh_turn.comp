#version 450 core
// check: #define ORDER 5
// Into the scene's axes, and as the world is turned in this frame.
layout(local_size_x = 64) in;

#include "env_sh.glsl"

void main()
{
	int i = int(gl_LocalInvocationID.x), l = 0, first = 0;

	if (i >= ORDER * ORDER)
		return;
	for (; (l + 1) * (l + 1) <= i; l++)
		first += (2 * l + 1) * (2 * l + 1);
	int columns_ = 2 * l + 1, row = i - l * l;
	vec3 sum = vec3(0.0);

	for (int k = 0; k < columns_; k++)
		sum += turn[first + row * columns_ + k] * unturned[l * l + k].rgb;
	coefficients[i] = vec4(sum, 0.0);
}
