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

layout(binding = 10) uniform usamplerBuffer taps;
layout(location = 1) uniform uint tap_base; // of the bound part of the taps: its first surfel
#endif
layout(binding = 11) uniform samplerBuffer albedo;
layout(binding = 12) uniform samplerBuffer emissive;
layout(binding = 13) uniform samplerBuffer found; // indirect, and fixed light but the emissive
layout(std430, binding = 13) writeonly buffer Direct { vec4 direct[]; };
layout(std430, binding = 14) writeonly buffer Radiosity { vec4 radiosity[]; };

#ifdef LAMPS
// Of one lamp, by a layer of its map, on a tap: E over the lamp's intensity.
vec3 light_at(Lamp lamp, MapLayer layer, int index, vec3 p, vec3 n, vec3 to_lamp, float metres, vec3 e,
	      float half_m)
{
	float c = dot(n, to_lamp) * lamp_cone_over(lamp, n, to_lamp, metres, half_m);

	return c > 0.0 ? e * (c * lamp_lit(layer, index, p, n, to_lamp, metres)) : vec3(0.0);
}

uvec4 tap_of(uint i, uint k)
{
	return texelFetch(taps, int(surfel_entry(i - tap_base, surfels.counts.z, k)));
}

// Mean over the taps. A lamp with one map has its layer read once; one with six finds
// that of each tap. The lengths of the loops choose, not a branch (see lamp_visibility).
vec3 light_of(Lamp lamp, uint i, float half_m)
{
	bool six = lamp.maps.y == 6;
	MapLayer layer = lamp_layers[lamp.maps.x];
	vec3 sum = vec3(0.0), to_lamp;
	float metres;

	for (uint k = six ? surfels.counts.z : 0u; k < surfels.counts.z; k++) {
		uvec4 tap = tap_of(i, k);
		vec3 p = uintBitsToFloat(tap.xyz), n = surfel_normal(tap.w);
		vec3 e = lamp_irradiance_uncut(lamp, p, to_lamp, metres);

		sum += light_at(lamp, layer, lamp.maps.x, p, n, to_lamp, metres, e, half_m);
	}
	for (uint k = six ? 0u : surfels.counts.z; k < surfels.counts.z; k++) {
		uvec4 tap = tap_of(i, k);
		vec3 p = uintBitsToFloat(tap.xyz), n = surfel_normal(tap.w);
		vec3 e = lamp_irradiance_uncut(lamp, p, to_lamp, metres);
		int index = lamp.maps.x + shadow_face(-to_lamp);

		sum += light_at(lamp, lamp_layers[index], index, p, n, to_lamp, metres, e, half_m);
	}
	return sum / float(surfels.counts.z);
}
#endif

void main()
{
	uint i;

	if (!surfel_of_slice(i))
		return;
	vec4 reflects = texelFetch(albedo, int(i)); // w: m^2 of the patch
	vec3 sum = vec3(0.0);
#ifdef LAMPS
	float half_m = sqrt(reflects.w / float(surfels.counts.z));

	for (int k = 0; k < lamp_count.x; k++)
		sum += light_of(lamps[k], i, half_m);
#endif
	direct[i] = vec4(sum, 0.0);
	sum += texelFetch(emissive, int(i)).rgb + texelFetch(found, int(i)).rgb;
	radiosity[i] = vec4(reflects.rgb * sum, 0.0);
}
