#version 450 core
// Light of the lamps on surfels: the mean over the taps of a patch, each with
// one comparison in the lamp's shadow map, so that a shadow's edge moves over a
// patch in as many steps as it has taps. What a patch reflects follows at once,
// so that the gather after this one has the new light.
// check: #define LAMPS
layout(local_size_x = 64) in;

#include "surfel_slice.glsl"
#ifdef LAMPS
#include "medium.glsl"
#include "lamp.glsl"
#include "shadow.glsl"
#include "lamp_shadow.glsl"

layout(location = 1) uniform uint tap_base; // of the bound part of the taps: its first surfel
layout(std430, binding = 9) readonly buffer Taps { uvec4 taps[]; };
#endif
layout(std430, binding = 10) readonly buffer Albedo { vec4 albedo[]; };
layout(std430, binding = 11) readonly buffer Emissive { vec4 emissive[]; };
layout(std430, binding = 12) readonly buffer Found { vec4 found[]; }; // indirect, and fixed light but the emissive
layout(std430, binding = 13) buffer Direct { vec4 direct[]; };
layout(std430, binding = 14) writeonly buffer Radiosity { vec4 radiosity[]; };

#ifdef LAMPS
vec3 light_at(vec3 p, vec3 n)
{
	vec3 sum = vec3(0.0);

	for (int k = 0; k < lamp_count.x; k++) {
		Lamp lamp = lamps[k];
		vec3 to_lamp;
		float metres;
		vec3 e = lamp_irradiance(lamp, p, to_lamp, metres);
		float c = dot(n, to_lamp);
		bool reaches = c > 0.0 && e != vec3(0.0);
		float lit = lamp_lit(lamp, p, n, to_lamp, metres, reaches);

		sum += reaches ? e * (c * lit) : vec3(0.0);
	}
	return sum;
}
#endif

void main()
{
	uint i;

	if (!surfel_of_slice(i))
		return;
	vec3 sum = vec3(0.0);
#ifdef LAMPS
	for (uint k = 0u; k < surfels.counts.z; k++) {
		uvec4 tap = taps[surfel_entry(i - tap_base, surfels.counts.z, k)];

		sum += light_at(uintBitsToFloat(tap.xyz), surfel_normal(tap.w));
	}
	sum /= float(surfels.counts.z);
#endif
	direct[i] = vec4(sum, 0.0);
	radiosity[i] = vec4(albedo[i].rgb * (sum + emissive[i].rgb + found[i].rgb), 0.0);
}
