#version 450 core
// Irradiance of the indirect light at a list of surface points, for tests and
// benchmarks. GI_SHADER names the method's file.
// check: #define GI_SHADER "gi_lpv.glsl"
layout(local_size_x = 64) in;

#include GI_SHADER

layout(location = 0) uniform int point_count;
layout(std430, binding = 0) readonly buffer PointBuffer { vec4 points[]; }; // position, normal
layout(std430, binding = 1) writeonly buffer FoundBuffer { vec4 found[]; };

void main()
{
	uint k = gl_GlobalInvocationID.x;

	if (k < uint(point_count))
		found[k] = vec4(gi_irradiance(points[2u * k].xyz, points[2u * k + 1u].xyz), 0.0);
}
