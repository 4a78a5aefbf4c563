#version 450 core
// The surfels' fixed light, from what was baked to what the air lets through now.
layout(local_size_x = 64) in;

#include "surfel_slice.glsl"
#include "surfel_air.glsl"

layout(location = 1) uniform float more; // 1/m, than when it was baked
layout(binding = 10) uniform samplerBuffer ways; // of emissive, and of other: mean, variance
layout(binding = 11) uniform samplerBuffer baked_emissive;
layout(binding = 12) uniform samplerBuffer baked_other;
layout(std430, binding = 12) writeonly buffer Emissive { vec4 emissive[]; };
layout(std430, binding = 14) writeonly buffer Other { vec4 other[]; };

void main()
{
	uint i;

	if (!surfel_of_slice(i))
		return;
	vec4 way = texelFetch(ways, int(i));

	emissive[i] = texelFetch(baked_emissive, int(i)) * surfel_thinned(way.xy, more);
	other[i] = texelFetch(baked_other, int(i)) * surfel_thinned(way.zw, more);
}
