// Which cells stand for the space in front of a surface point
// (renderer/gi/front.h); renderer/gi/lpv_cpu.c is the same in plain C.
#include "lpv_lattice.glsl"

// FRONT_MASKS masks a record.
layout(binding = 11) uniform usamplerBuffer fronts;

const int FRONT_MASKS = 48;
const float FRONT_OUT = 0.05;

struct Front {
	ivec3 cell;  // whose neighbourhood the mask is about
	uint mask;   // cells that the surface sees: bit (x+1) + 3 (y+1) + 9 (z+1)
	vec3 at, n;  // surface point in cells, normal
	vec3 out_at; // half a cell out
};

// False where no surface is known and the place in front lies outside.
bool front_of(vec3 position, vec3 normal, out Front f)
{
	f.at = (position - lattice.origin.xyz) / lattice.origin.w;
	f.n = normal;
	f.out_at = f.at + 0.5 * normal;
	f.mask = 0u;
	ivec3 half_cell = ivec3(floor(2.0 * (f.at + FRONT_OUT * normal)));
	vec3 a = abs(normal);
	int axis = a.y > a.x ? 1 : 0;

	axis = a.z > a[axis] ? 2 : axis;
	f.cell = half_cell >> 1;
	if (lattice_inside(f.cell)) {
		int record = int(texelFetch(surface_of, lattice_index(f.cell)).y);
		ivec3 o = half_cell & 1;

		if (record != 0)
			f.mask = texelFetch(fronts, FRONT_MASKS * (record - 1) +
							6 * (o.x + 2 * o.y + 4 * o.z) + 2 * axis +
							(normal[axis] < 0.0 ? 1 : 0)).x;
	}
	if (f.mask != 0u)
		return true;
	// no surface of the scene: the cell half a cell out, and what it sees is not known
	f.cell = ivec3(floor(f.out_at));
	f.mask = 0x7ffffffu;
	return lattice_inside(f.cell);
}

bool front_counts(Front f, ivec3 cell)
{
	ivec3 o = cell - f.cell + 1;

	if (any(lessThan(o, ivec3(0))) || any(greaterThan(o, ivec3(2))) || !lattice_inside(cell) ||
	    (f.mask >> (o.x + 3 * o.y + 9 * o.z) & 1u) == 0u)
		return false;
	return dot(f.n, vec3(cell) + lattice.point.xyz - f.at) > 0.0;
}

// The cell that takes the light of a surface point: the one half a cell out,
// or of those that count the nearest.
bool front_cell(Front f, out ivec3 cell)
{
	float nearest = 1e9;
	ivec3 best = ivec3(0);

	cell = ivec3(floor(f.out_at));
	if (front_counts(f, cell))
		return true;
	for (int k = 0; k < 27; k++) {
		ivec3 c = f.cell + ivec3(k % 3, k / 3 % 3, k / 9) - 1;
		vec3 away = vec3(c) + 0.5 - f.out_at;
		float d = dot(away, away);

		if (d < nearest && front_counts(f, c)) {
			nearest = d;
			best = c;
		}
	}
	cell = best;
	return nearest < 1e9;
}
