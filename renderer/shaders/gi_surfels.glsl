// Irradiance of the indirect light from the surfels around, W/m^2 per band, at
// a surface point with that unit normal. Depends on nothing but the point: all
// walls see the same light.
//
// Moving least squares (Lancaster and Salkauskas 1981): of the surfels that the
// point hears, the plane that fits their light best with their weights, at the
// point. A linear course of light comes out as it is, wherever the surfels are.
#include "surfel_block.glsl"

layout(binding = 8) uniform usamplerBuffer surfel_texels; // two a surfel: position, normal; reach
layout(binding = 9) uniform samplerBuffer surfel_light;   // irradiance
layout(binding = 10) uniform usamplerBuffer cell_first;
layout(binding = 11) uniform usamplerBuffer cell_members;
layout(binding = 12) uniform usamplerBuffer cell_keys;

// Slopes are held back as if the surfels' spread were larger by this, in squares of the radius.
const float SURFEL_STIFF = 0.01;
// Least share of the mean that a slope leaves.
const float SURFEL_FLOOR = 0.1;
// What a surfel counts that shares no more than the half space in front: only where no other is heard.
const float SURFEL_LAST = 1e-7;

// Members of the cell around a point: begin, end (surfel_set_cell in surfel_grid.c).
uvec2 surfel_cell(vec3 position)
{
	ivec3 at = clamp(ivec3(floor((position - surfels.grid.xyz) / surfels.grid.w)), ivec3(0),
			 surfels.cells.xyz - 1);
	uint cell = uint(at.x) + uint(surfels.cells.x) * (uint(at.y) + uint(surfels.cells.y) * uint(at.z));
	uint slot = cell;

	if (surfels.cells.w != 0) {
		uint mask = uint(surfels.cells.w) - 1u, x = cell * 0x9e3779b1u, key;

		slot = (x ^ (x >> 15)) & mask;
		while ((key = texelFetch(cell_keys, int(slot)).r) != 0u && key != cell + 1u)
			slot = (slot + 1u) & mask;
	}
	return uvec2(texelFetch(cell_first, int(slot)).r, texelFetch(cell_first, int(slot) + 1).r);
}

// How far (x, y), the way from a surfel along its axes, is on the way to the end of its
// sight (surfel_sight in surfel_set.c).
float surfel_sight(uvec4 reach, float x, float y)
{
	float size = abs(x) + abs(y);
	float a = x / max(size, 1e-20), b = y / max(size, 1e-20);
	float quarter = y >= 0.0 ? (x >= 0.0 ? b : 1.0 - a) : (x < 0.0 ? 2.0 - b : 3.0 + a);
	float step_ = quarter * 4.0, low = floor(step_);
	uint i = uint(low) & 15u, j = (i + 1u) & 15u;
	uint r = (reach[i >> 2] >> (8u * (i & 3u))) & 255u;
	uint s = (reach[j >> 2] >> (8u * (j & 3u))) & 255u;

	return size * surfels.kernel.w *
	       mix(r == 255u ? 0.0 : 255.0 / float(r), s == 255u ? 0.0 : 255.0 / float(s), step_ - low);
}

// surfel_weight in surfel_set.h. d: from the surfel to the point, metres.
float surfel_weight(vec3 d, vec3 own, vec3 normal, uvec4 reach)
{
	vec3 u, v;
	float near = max(1.0 - dot(d, d) * surfels.kernel.x * surfels.kernel.x, 0.0);
	float facing = max(2.0 * dot(own, normal) - 1.0, 0.0);
	float off = 0.5 * dot(d, own + normal) * surfels.kernel.z;
	float level = max(1.0 - off * off, 0.0);
	float product = near * facing * level;

	surfel_frame(own, u, v);
	float sight = surfel_sight(reach, dot(d, u), dot(d, v));
	float t = clamp((sight - 0.6) / 0.4, 0.0, 1.0);
	float fade = sight > 1.0 ? (sight <= 1.05 ? 1e-4 : 0.0) : 1.0 - 0.95 * t * t * (3.0 - 2.0 * t);

	return product * product * fade;
}

vec3 gi_irradiance(vec3 position, vec3 normal)
{
	uvec2 run = surfel_cell(position);
	vec3 u, v;
	// sums of weight: 1, x, y; xx, xy, yy; light and light times x, y
	vec3 m = vec3(0.0), mm = vec3(0.0);
	vec3 e = vec3(0.0), ex = vec3(0.0), ey = vec3(0.0);

	surfel_frame(normal, u, v);
	for (uint k = run.x; k < run.y; k++) {
		int i = int(texelFetch(cell_members, int(k)).r);
		uvec4 head = texelFetch(surfel_texels, 2 * i);
		uvec4 reach = texelFetch(surfel_texels, 2 * i + 1);
		vec3 light = texelFetch(surfel_light, i).rgb;
		vec3 own = surfel_normal(head.w);
		vec3 d = position - uintBitsToFloat(head.xyz);
		float w = surfel_weight(d, own, normal, reach), c = dot(own, normal);

		d *= surfels.kernel.x;
		w += c > 0.0 ? SURFEL_LAST * c / (0.01 + dot(d, d)) : 0.0;
		float x = dot(d, u), y = dot(d, v);
		vec3 we = w * light;

		m += w * vec3(1.0, x, y);
		mm += w * vec3(x * x, x * y, y * y);
		e += we;
		ex += we * x;
		ey += we * y;
	}
	if (m.x <= 0.0)
		return vec3(0.0);
	m.yz /= m.x;
	mm /= m.x;
	e /= m.x;
	float xx = mm.x - m.y * m.y + SURFEL_STIFF, yy = mm.z - m.z * m.z + SURFEL_STIFF;
	float xy = mm.y - m.y * m.z, inverse = 1.0 / (xx * yy - xy * xy);
	vec3 gx = ex / m.x - m.y * e, gy = ey / m.x - m.z * e;
	vec3 fit = e - (m.y * (yy * gx - xy * gy) + m.z * (xx * gy - xy * gx)) * inverse;
	vec3 least = SURFEL_FLOOR * e;

	// A slope may lead below nothing; a NaN must stay one.
	precise vec3 kept = vec3(fit.x < least.x ? least.x : fit.x, fit.y < least.y ? least.y : fit.y,
				 fit.z < least.z ? least.z : fit.z);
	return kept;
}
