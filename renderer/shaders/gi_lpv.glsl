// Irradiance of the indirect light from the lattice, W/m^2 per band, at a
// surface point with that unit normal. Depends on nothing but the point: all
// walls see the same light.
//
// Trilinear over the eight cells around the point half a cell in front of the
// surface; only cells that the surface sees count. In corners these may be few
// or none: then all cells around that it sees come in by their distance.
#include "lpv_front.glsl"

// Share of the eight cells under which the others come in.
const float FRONT_FEW = 0.1;

struct Sum {
	vec4 red, green, blue;
	float weights;
};

void add_cell(inout Sum sum, ivec3 cell, float w)
{
	int i = lattice_index(cell);

	sum.red += w * texelFetch(light, i);
	sum.green += w * texelFetch(light, lattice.size.w + i);
	sum.blue += w * texelFetch(light, 2 * lattice.size.w + i);
	sum.weights += w;
}

vec3 gi_irradiance(vec3 position, vec3 normal)
{
	Front front;
	Sum sum = Sum(vec4(0.0), vec4(0.0), vec4(0.0), 0.0);

	if (!front_of(position, normal, front))
		return vec3(0.0);
	ivec3 low = ivec3(floor(front.out_at - 0.5));
	vec3 t = front.out_at - 0.5 - vec3(low);

	for (int k = 0; k < 8; k++) {
		ivec3 o = ivec3(k & 1, (k >> 1) & 1, k >> 2);
		vec3 f = mix(1.0 - t, t, vec3(o));
		float w = f.x * f.y * f.z;

		if (w > 0.0 && front_counts(front, low + o))
			add_cell(sum, low + o, w);
	}
	if (sum.weights < FRONT_FEW) {
		float share = FRONT_FEW - sum.weights;

		for (int k = 0; k < 27; k++) {
			ivec3 cell = front.cell + ivec3(k % 3, k / 3 % 3, k / 9) - 1;
			vec3 away = vec3(cell) + 0.5 - front.out_at;
			float d = dot(away, away) + 0.1;

			if (front_counts(front, cell))
				add_cell(sum, cell, share / (d * d));
		}
	}
	if (sum.weights <= 0.0)
		return vec3(0.0);
	vec3 e = lattice.look.x * vec3(sum.red.x, sum.green.x, sum.blue.x) -
		 lattice.look.y * vec3(dot(sum.red.yzw, normal), dot(sum.green.yzw, normal),
				       dot(sum.blue.yzw, normal));
	e /= sum.weights;
	// Two bands may go below nothing; a NaN must stay one.
	precise vec3 kept = vec3(e.x < 0.0 ? 0.0 : e.x, e.y < 0.0 ? 0.0 : e.y,
				 e.z < 0.0 ? 0.0 : e.z);
	return kept;
}
