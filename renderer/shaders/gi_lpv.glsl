// Irradiance of the indirect light from the lattice, W/m^2 per band, at a
// surface point with that unit normal. Depends on nothing but the point: all
// walls see the same light.
//
// Trilinear over the eight cells around the point half a cell in front of the
// surface; cells behind the surface, and cells that do not see the cell in
// front of it (their link's transmittance), do not count.
#include "lpv_lattice.glsl"

float gi_link_through(int surface, ivec3 offset)
{
	int j = offset.x + 1 + 3 * (offset.y + 1) + 9 * (offset.z + 1);

	j -= j > 13 ? 1 : 0;
	uint word = texelFetch(surfaces, 2 * surface + (j >> 4))[(j >> 2) & 3];

	return float((word >> (8 * (j & 3))) & 255u) * (1.0 / 128.0);
}

vec3 gi_irradiance(vec3 position, vec3 normal)
{
	ivec3 base;

	if (!lattice_front_cell(position, normal, base))
		return vec3(0.0);
	vec3 at = (position - lattice.origin.xyz) / lattice.origin.w + 0.5 * normal;
	at = clamp(at, vec3(base), vec3(base) + 1.0) - 0.5;
	ivec3 low = ivec3(floor(at));
	vec3 t = at - vec3(low);
	int surface = int(texelFetch(surface_of, lattice_index(base)).x);
	vec4 red = vec4(0.0), green = vec4(0.0), blue = vec4(0.0);
	float weights = 0.0;

	for (int k = 0; k < 8; k++) {
		ivec3 o = ivec3(k & 1, (k >> 1) & 1, k >> 2);
		ivec3 cell = low + o;
		ivec3 offset = cell - base;
		vec3 f = mix(1.0 - t, t, vec3(o));
		float w = f.x * f.y * f.z;

		if (w <= 0.0 || !lattice_inside(cell))
			continue;
		if (offset != ivec3(0)) {
			if (!lattice_in_front(cell, position, normal))
				continue;
			if (surface != 0)
				w *= gi_link_through(surface, offset);
			if (w <= 0.0)
				continue;
		}
		int i = lattice_index(cell);
		red += w * texelFetch(light, i);
		green += w * texelFetch(light, lattice.size.w + i);
		blue += w * texelFetch(light, 2 * lattice.size.w + i);
		weights += w;
	}
	if (weights <= 0.0)
		return vec3(0.0);
	vec3 e = lattice.look.x * vec3(red.x, green.x, blue.x) -
		 lattice.look.y * vec3(dot(red.yzw, normal), dot(green.yzw, normal),
				       dot(blue.yzw, normal));
	e /= weights;
	// Two bands may go below nothing; a NaN must stay one.
	precise vec3 kept = vec3(e.x < 0.0 ? 0.0 : e.x, e.y < 0.0 ? 0.0 : e.y,
				 e.z < 0.0 ? 0.0 : e.z);
	return kept;
}
