#version 450 core
// Seed 004, equation 3.4: this frame's light on the surfaces mixed with where
// the last frame's light had come to, before the first step.
layout(local_size_x = 64) in;

#include "lpv_lattice.glsl"

layout(binding = 11) uniform samplerBuffer inject; // F, F n
layout(rgba32f, binding = 3) uniform writeonly image3D target_red;
layout(rgba32f, binding = 4) uniform writeonly image3D target_green;
layout(rgba32f, binding = 5) uniform writeonly image3D target_blue;
layout(location = 0) uniform vec2 share; // of the last frame, of this one's

const float C0 = 0.886226925; // sqrt(pi)/2
const float C1 = 1.023326708; // sqrt(pi/3)

vec4 mixed(int at)
{
	vec4 lobe = texelFetch(inject, at); // band after band, as light

	return share.x * texelFetch(light, at) + share.y * vec4(C0 * lobe.x, -C1 * lobe.z, C1 * lobe.w, -C1 * lobe.y);
}

void main()
{
	uint group = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
	int i = int(group * gl_WorkGroupSize.x + gl_LocalInvocationID.x);

	if (i >= lattice.size.w)
		return;
	ivec3 cell = ivec3(i % lattice.size.x, (i / lattice.size.x) % lattice.size.y,
			   i / (lattice.size.x * lattice.size.y));
	imageStore(target_red, cell, mixed(i));
	imageStore(target_green, cell, mixed(lattice.size.w + i));
	imageStore(target_blue, cell, mixed(2 * lattice.size.w + i));
}
