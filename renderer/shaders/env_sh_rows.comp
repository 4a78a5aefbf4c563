#version 450 core
// check: #define ORDER 5
// One part of a row: every sixteenth column, so that neighbours read neighbours.
layout(local_size_x = 16, local_size_y = 4) in;

#include "env_sh.glsl"

layout(binding = 0) uniform sampler2D picture;

void main()
{
	ivec2 size = textureSize(picture, 0);
	int part = int(gl_GlobalInvocationID.x), row = int(gl_GlobalInvocationID.y);
	vec3 sum[SERIES];

	if (row >= size.y)
		return;
	for (int i = 0; i < SERIES; i++)
		sum[i] = vec3(0.0);
	for (int x = part; x < size.x; x += PARTS) {
		vec3 radiance = texelFetch(picture, ivec2(x, row), 0).rgb;
		vec2 one = columns[x], turned = one;

		sum[0] += radiance;
		for (int m = 1; m < ORDER; m++) {
			sum[2 * m - 1] += radiance * turned.x;
			sum[2 * m] += radiance * turned.y;
			turned = vec2(turned.x * one.x - turned.y * one.y, turned.x * one.y + turned.y * one.x);
		}
	}
	for (int i = 0; i < SERIES; i++)
		sums[(row * PARTS + part) * SERIES + i] = vec4(sum[i], 0.0);
}
