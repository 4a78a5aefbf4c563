// Irradiance of the indirect light from the probes around, W/m^2 per band, at a
// surface point with that unit normal: trilinear over eight probes, those that
// are behind the surface or do not see the point counting little (Majercik,
// Guertin, Nowrouzezahrai and McGuire, "Dynamic Diffuse Global Illumination
// with Ray-Traced Irradiance Fields", 2019). Nothing depends on the camera, so
// the point is moved along its normal only.
#include "probe_grid.glsl"

layout(binding = 8) uniform samplerBuffer probe_light; // PROBE_SH a probe
layout(binding = 9) uniform sampler2D probe_distance;  // octahedral tiles: mean and mean square
layout(binding = 10) uniform usamplerBuffer probe_alive;

const int PROBE_SIDE = 16;
// How far the point is moved off its surface, in distances between probes.
const float PROBE_LIFT = 0.15;
// What a probe counts that does not see the point: only where none does.
const float PROBE_LAST = 1e-6;

vec2 probe_octahedral(vec3 d)
{
	vec2 e = d.xy / (abs(d.x) + abs(d.y) + abs(d.z));
	vec2 folded = (1.0 - abs(e.yx)) * mix(vec2(-1.0), vec2(1.0), greaterThanEqual(e, vec2(0.0)));

	return d.z < 0.0 ? folded : e;
}

// 0 hidden .. 1 seen: Chebyshev's bound on the share of the surfaces around that
// direction that are farther than the point. d: from the probe, metres its length.
float probe_sees(int probe, vec3 d, float metres)
{
	vec2 tile = vec2(probe % probes.size.w, probe / probes.size.w) * float(PROBE_SIDE + 2);
	vec2 at = tile + 1.0 + (probe_octahedral(d) * 0.5 + 0.5) * float(PROBE_SIDE);
	vec2 m = textureLod(probe_distance, at * probes.texel.xy, 0.0).rg;
	float spread = max(m.y - m.x * m.x, 1e-6 * m.x * m.x), beyond = metres - m.x;
	float seen = beyond > 0.0 ? spread / (spread + beyond * beyond) : 1.0;

	return seen * seen * seen;
}

vec3 probe_irradiance(int probe, vec3 n)
{
	int at = PROBE_SH * probe;
	// the cosine lobe takes pi, 2 pi/3 and pi/4 of the bands (Ramamoorthi and Hanrahan 2001)
	vec3 e = 0.88622693 * texelFetch(probe_light, at).rgb;

	e += 1.02332671 * (n.y * texelFetch(probe_light, at + 1).rgb + n.z * texelFetch(probe_light, at + 2).rgb +
			   n.x * texelFetch(probe_light, at + 3).rgb);
	e += 0.85808553 * (n.x * n.y * texelFetch(probe_light, at + 4).rgb +
			   n.y * n.z * texelFetch(probe_light, at + 5).rgb +
			   n.x * n.z * texelFetch(probe_light, at + 7).rgb);
	e += 0.24770796 * (3.0 * n.z * n.z - 1.0) * texelFetch(probe_light, at + 6).rgb;
	return e + 0.42904276 * (n.x * n.x - n.y * n.y) * texelFetch(probe_light, at + 8).rgb;
}

vec3 gi_irradiance(vec3 position, vec3 normal)
{
	vec3 lifted = position + normal * (PROBE_LIFT * probes.origin.w);
	vec3 at = clamp((lifted - probes.origin.xyz) / probes.origin.w, vec3(0.0),
			vec3(probes.size.xyz - 1));
	ivec3 low = ivec3(min(floor(at), vec3(max(probes.size.xyz - 2, ivec3(0)))));
	vec3 t = at - vec3(low), sum = vec3(0.0);
	float weights = 0.0;

	for (int k = 0; k < 8; k++) {
		ivec3 o = ivec3(k & 1, (k >> 1) & 1, k >> 2);
		ivec3 cell = min(low + o, probes.size.xyz - 1);
		int probe = cell.x + probes.size.x * (cell.y + probes.size.y * cell.z);
		vec3 there = probes.origin.xyz + probes.origin.w * vec3(cell);
		vec3 d = lifted - there;
		float metres = max(length(d), 1e-6);
		float front = dot(normalize(there - position + 1e-6 * normal), normal) * 0.5 + 0.5;
		vec3 f = max(mix(1.0 - t, t, vec3(o)), vec3(1e-3));
		float w = (front * front + 0.05) * probe_sees(probe, d / metres, metres);

		// what little is left of hidden ones would add up
		w = w < 0.2 ? w * w * w * 25.0 : w;
		w = (w + PROBE_LAST) * f.x * f.y * f.z * float(texelFetch(probe_alive, probe).r);
		sum += w * probe_irradiance(probe, normal);
		weights += w;
	}
	vec3 e = weights > 0.0 ? sum / weights : vec3(0.0);
	// Three bands may go below nothing; a NaN must stay one.
	precise vec3 kept = vec3(e.x < 0.0 ? 0.0 : e.x, e.y < 0.0 ? 0.0 : e.y, e.z < 0.0 ? 0.0 : e.z);
	return kept;
}
