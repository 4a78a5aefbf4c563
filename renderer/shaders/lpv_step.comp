#version 450 core
// One step of the propagation, L <- I + P L (renderer/gi/lpv_cpu.c is the same
// in C). Gather: each cell takes from its 26 neighbours what they send through
// the link, then reflects what its own links stopped of its own light.
layout(local_size_x = 8, local_size_y = 4, local_size_z = 1) in;

#include "lpv_lattice.glsl"

layout(std430, binding = 11) readonly buffer InjectBuffer { vec4 inject[]; }; // three a cell
// Two vec4 each: reflect rgb, direction's number; facing xyz, share that is stopped.
layout(std430, binding = 12) readonly buffer BlockBuffer { vec4 blocks[]; };
layout(std430, binding = 13) writeonly buffer NextBuffer { vec4 next[]; };

const float INVERSE[3] = float[3](1.0, 0.70710678, 0.57735027);

// Clamped and rescaled; a comparison, not max(), so that a NaN goes on.
vec3 kept_flux(vec3 phi, vec3 scale)
{
	precise vec3 kept = vec3(phi.x < 0.0 ? 0.0 : phi.x, phi.y < 0.0 ? 0.0 : phi.y,
				 phi.z < 0.0 ? 0.0 : phi.z);

	return kept * scale;
}

struct Cell {
	vec4 red, green, blue;
};

vec3 cell_flux(vec4 r, vec4 g, vec4 b, vec3 axis, float fa, float fb)
{
	return fa * vec3(r.x, g.x, b.x) +
	       fb * vec3(dot(axis, r.yzw), dot(axis, g.yzw), dot(axis, b.yzw));
}

void hop(inout Cell sum, ivec3 cell, uint words[7], int dx, int dy, int dz, int j)
{
	ivec3 from = cell - ivec3(dx, dy, dz);

	if (!lattice_inside(from))
		return;
	int kind = dx * dx + dy * dy + dz * dz - 1;
	vec3 axis = vec3(dx, dy, dz) * INVERSE[kind];
	int i = 4 * lattice_index(from);
	int back = 25 - j;
	float through = float((words[back >> 2] >> (8 * (back & 3))) & 255u) * (1.0 / 255.0);
	vec3 phi = through * kept_flux(cell_flux(light[i], light[i + 1], light[i + 2], axis,
						 lattice.sector_a[kind], lattice.sector_b[kind]),
				       light[i + 3].xyz);
	vec4 lobe = vec4(1.0, lattice.sector_mu[kind] * axis);

	sum.red += phi.x * lobe;
	sum.green += phi.y * lobe;
	sum.blue += phi.z * lobe;
}

void reflect_own(inout Cell sum, int i, uint word)
{
	vec4 r = light[i], g = light[i + 1], b = light[i + 2];
	vec3 scale = light[i + 3].xyz;
	uint first = word & 0x07ffffffu;
	uint count = word >> 27;

	for (uint k = first; k < first + count; k++) {
		vec4 block = blocks[2u * k];
		int j = floatBitsToInt(block.w);
		int n = j > 12 ? j + 1 : j;
		vec3 o = vec3(n % 3 - 1, (n / 3) % 3 - 1, n / 9 - 1);
		int kind = int(dot(o, o)) - 1;
		vec3 phi = block.xyz * kept_flux(cell_flux(r, g, b, o * INVERSE[kind],
							   lattice.sector_a[kind],
							   lattice.sector_b[kind]),
						 scale);
		vec4 lobe = vec4(1.0, lattice.sector_mu.w * blocks[2u * k + 1u].xyz);

		sum.red += phi.x * lobe;
		sum.green += phi.y * lobe;
		sum.blue += phi.z * lobe;
	}
}

// Factor that keeps the sum of the fluxes when negative ones become zero: over
// pairs of opposite sectors the positive part is e + max(|e|, |o|) with the
// even part e = a F and the odd part o = b J.V.
float clamp_scale(vec4 c)
{
	vec3 e = abs(lattice.sector_a.xyz * c.x);
	vec3 o = c.yzw * lattice.sector_b.x;
	vec3 p = c.yzw * (lattice.sector_b.y * INVERSE[1]);
	vec3 q = c.yzw * (lattice.sector_b.z * INVERSE[2]);
	float sum = max(e.x, abs(o.x)) + max(e.x, abs(o.y)) + max(e.x, abs(o.z));

	sum += max(e.y, abs(p.x + p.y)) + max(e.y, abs(p.x - p.y));
	sum += max(e.y, abs(p.x + p.z)) + max(e.y, abs(p.x - p.z));
	sum += max(e.y, abs(p.y + p.z)) + max(e.y, abs(p.y - p.z));
	sum += max(e.z, abs(q.x + q.y + q.z)) + max(e.z, abs(q.x + q.y - q.z));
	sum += max(e.z, abs(q.x - q.y + q.z)) + max(e.z, abs(q.x - q.y - q.z));
	float half_flux = lattice.sector_a.w * c.x;
	float positive = half_flux + sum;

	return positive == 0.0 ? 0.0 : 2.0 * half_flux / positive;
}

void main()
{
	ivec3 cell = ivec3(gl_GlobalInvocationID);

	if (!lattice_inside(cell))
		return;
	int index = lattice_index(cell);
	uint surface = surface_of[index];
	uint words[7] = uint[7](~0u, ~0u, ~0u, ~0u, ~0u, ~0u, ~0u);
	Cell sum = Cell(inject[3 * index], inject[3 * index + 1], inject[3 * index + 2]);

	if (surface != 0u) {
		uint at = (surface - 1u) * 8u;

		for (int w = 0; w < 7; w++)
			words[w] = surfaces[at + uint(w)];
		reflect_own(sum, 4 * index, surfaces[at + 7u]);
	}
	hop(sum, cell, words, -1, -1, -1, 0);
	hop(sum, cell, words, 0, -1, -1, 1);
	hop(sum, cell, words, 1, -1, -1, 2);
	hop(sum, cell, words, -1, 0, -1, 3);
	hop(sum, cell, words, 0, 0, -1, 4);
	hop(sum, cell, words, 1, 0, -1, 5);
	hop(sum, cell, words, -1, 1, -1, 6);
	hop(sum, cell, words, 0, 1, -1, 7);
	hop(sum, cell, words, 1, 1, -1, 8);
	hop(sum, cell, words, -1, -1, 0, 9);
	hop(sum, cell, words, 0, -1, 0, 10);
	hop(sum, cell, words, 1, -1, 0, 11);
	hop(sum, cell, words, -1, 0, 0, 12);
	hop(sum, cell, words, 1, 0, 0, 13);
	hop(sum, cell, words, -1, 1, 0, 14);
	hop(sum, cell, words, 0, 1, 0, 15);
	hop(sum, cell, words, 1, 1, 0, 16);
	hop(sum, cell, words, -1, -1, 1, 17);
	hop(sum, cell, words, 0, -1, 1, 18);
	hop(sum, cell, words, 1, -1, 1, 19);
	hop(sum, cell, words, -1, 0, 1, 20);
	hop(sum, cell, words, 0, 0, 1, 21);
	hop(sum, cell, words, 1, 0, 1, 22);
	hop(sum, cell, words, -1, 1, 1, 23);
	hop(sum, cell, words, 0, 1, 1, 24);
	hop(sum, cell, words, 1, 1, 1, 25);
	int i = 4 * index;
	next[i] = sum.red;
	next[i + 1] = sum.green;
	next[i + 2] = sum.blue;
	next[i + 3] = vec4(clamp_scale(sum.red), clamp_scale(sum.green), clamp_scale(sum.blue), 0.0);
}
