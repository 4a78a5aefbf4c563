#version 450 core
// One step of the propagation, L <- I + P L (renderer/gi/lpv_cpu.c is the same
// in plain C). Gather: each cell takes from its 26 neighbours what they send
// through the link, then reflects what its own links stopped of its own light.
//
// An invocation walks up a column of cells: every cell of the nine columns
// around it is read once and serves three layers. The lattice has a dark
// border of one cell, so nothing asks where the edge is; sizes are constants.
// Cells are stored as they are sent, scaled by their clamp (see clamp_scale);
// the last step of a frame (WITH_LOOK) also writes them as they are.
// check: #define LATTICE_X 32
// check: #define LATTICE_Y 32
// check: #define LATTICE_Z 32
// check: #define SEGMENT 16
// check: #define WITH_LOOK
layout(local_size_x = 8, local_size_y = 4, local_size_z = 1) in;

#include "lpv_lattice.glsl"

layout(std430, binding = 11) readonly buffer InjectBuffer { vec4 inject[]; };
// Two vec4 each: reflect rgb, direction's number; facing xyz, share that is stopped.
layout(std430, binding = 12) readonly buffer BlockBuffer { vec4 blocks[]; };
layout(std430, binding = 13) writeonly buffer NextBuffer { vec4 next[]; };
layout(std430, binding = 14) readonly buffer SentBuffer { vec4 sent[]; };
#ifdef WITH_LOOK
layout(std430, binding = 15) writeonly buffer NewLightBuffer { vec4 new_light[]; };
#endif

const int STRIDE_Y = LATTICE_X + 2;
const int STRIDE_Z = STRIDE_Y * (LATTICE_Y + 2);
const float INVERSE[3] = float[3](1.0, 0.70710678, 0.57735027);

struct Sum {
	vec3 f, x, y, z; // of the three bands
};

// A comparison, not max(), so that a NaN goes on to where it is counted.
vec3 kept(vec3 phi)
{
	precise vec3 k = vec3(phi.x < 0.0 ? 0.0 : phi.x, phi.y < 0.0 ? 0.0 : phi.y,
			      phi.z < 0.0 ? 0.0 : phi.z);

	return k;
}

// Transmittance in 1/128 towards the neighbour at (dx, dy, dz); constants after unrolling.
float through(uint words[7], int dx, int dy, int dz)
{
	int n = dx + 1 + 3 * (dy + 1) + 9 * (dz + 1);
	int j = n > 13 ? n - 1 : n;

	return float((words[j >> 2] >> (8 * (j & 3))) & 255u);
}

void add(inout Sum sum, vec3 phi, float mu, int jx, int jy, int jz)
{
	sum.f += phi;
	phi *= mu;
	if (jx != 0)
		sum.x += jx > 0 ? phi : -phi;
	if (jy != 0)
		sum.y += jy > 0 ? phi : -phi;
	if (jz != 0)
		sum.z += jz > 0 ? phi : -phi;
}

#define LESS(kind) ((kind) > 0 ? (kind) - 1 : 0)
// What the cell at (dx, dy) in this layer sends to the layers below, here and above.
#define COLUMN(dx, dy, kind)                                                                  \
	{                                                                                      \
		int at = 3 * (source + (dx) + (dy) * STRIDE_Y);                                \
		vec4 r = sent[at], g = sent[at + 1], b = sent[at + 2];                         \
		vec3 f = vec3(r.x, g.x, b.x);                                                  \
		vec3 up = vec3(r.w, g.w, b.w);                                                 \
		vec3 flat_ = vec3(0.0);                                                        \
		if ((dx) != 0)                                                                 \
			flat_ -= float(dx) * vec3(r.y, g.y, b.y);                              \
		if ((dy) != 0)                                                                 \
			flat_ -= float(dy) * vec3(r.z, g.z, b.z);                              \
		vec3 slant = fa[kind] * f + fb[kind] * flat_;                                  \
		vec3 rise = fb[kind] * up;                                                     \
		add(low, through(low_words, dx, dy, 1) * kept(slant - rise), fm[kind], -(dx),  \
		    -(dy), -1);                                                                \
		add(high, through(high_words, dx, dy, -1) * kept(slant + rise), fm[kind],      \
		    -(dx), -(dy), 1);                                                          \
		if ((kind) > 0)                                                                \
			add(mid,                                                               \
			    through(mid_words, dx, dy, 0) *                                    \
				    kept(fa[LESS(kind)] * f + fb[LESS(kind)] * flat_),         \
			    fm[LESS(kind)], -(dx), -(dy), 0);                                  \
	}

void reflect_own(inout Sum sum, int cell, uint word)
{
	vec4 r = sent[3 * cell], g = sent[3 * cell + 1], b = sent[3 * cell + 2];
	uint first = word & 0x07ffffffu;
	uint count = word >> 27;

	for (uint k = first; k < first + count; k++) {
		vec4 block = blocks[2u * k];
		int j = floatBitsToInt(block.w);
		int n = j > 12 ? j + 1 : j;
		vec3 o = vec3(n % 3 - 1, (n / 3) % 3 - 1, n / 9 - 1);
		int kind = int(dot(o, o)) - 1;
		vec3 along = o * (INVERSE[kind] * lattice.sector_b[kind]);
		vec3 phi = kept(lattice.sector_a[kind] * vec3(r.x, g.x, b.x) +
				vec3(dot(along, r.yzw), dot(along, g.yzw), dot(along, b.yzw)));
		vec3 facing = lattice.sector_mu.w * blocks[2u * k + 1u].xyz;

		phi *= block.xyz;
		sum.f += phi;
		sum.x += facing.x * phi;
		sum.y += facing.y * phi;
		sum.z += facing.z * phi;
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

void finish(Sum sum, ivec3 cell, uint surface)
{
	int index = cell.x + LATTICE_X * (cell.y + LATTICE_Y * cell.z);
	int padded = cell.x + 1 + STRIDE_Y * (cell.y + 1) + STRIDE_Z * (cell.z + 1);

	if (surface != 0u)
		reflect_own(sum, padded, surfaces[8u * surface - 1u]);
	vec4 r = inject[3 * index] + vec4(sum.f.x, sum.x.x, sum.y.x, sum.z.x);
	vec4 g = inject[3 * index + 1] + vec4(sum.f.y, sum.x.y, sum.y.y, sum.z.y);
	vec4 b = inject[3 * index + 2] + vec4(sum.f.z, sum.x.z, sum.y.z, sum.z.z);

	next[3 * padded] = r * clamp_scale(r);
	next[3 * padded + 1] = g * clamp_scale(g);
	next[3 * padded + 2] = b * clamp_scale(b);
#ifdef WITH_LOOK
	new_light[3 * index] = r;
	new_light[3 * index + 1] = g;
	new_light[3 * index + 2] = b;
#endif
}

void main()
{
	ivec3 cell = ivec3(gl_GlobalInvocationID.xy, gl_GlobalInvocationID.z * SEGMENT);
	int end = min(cell.z + SEGMENT, LATTICE_Z);
	const Sum none = Sum(vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
	const uint open[7] = uint[7](~0u, ~0u, ~0u, ~0u, ~0u, ~0u, ~0u);
	Sum low = none, mid = none, high = none;
	uint low_words[7] = open, mid_words[7] = open, high_words[7] = open;
	uint low_surface = 0u, mid_surface = 0u, high_surface = 0u;
	// 1/128 is the unit of the transmittance; a power of two, so exact
	vec3 fa = lattice.sector_a.xyz * (1.0 / 128.0);
	vec3 fb = lattice.sector_b.xyz * vec3(INVERSE[0], INVERSE[1], INVERSE[2]) * (1.0 / 128.0);
	vec3 fm = lattice.sector_mu.xyz * vec3(INVERSE[0], INVERSE[1], INVERSE[2]);

	if (cell.x >= LATTICE_X || cell.y >= LATTICE_Y)
		return;
	for (int z = cell.z - 1; z <= end; z++) {
		int source = cell.x + 1 + STRIDE_Y * (cell.y + 1) + STRIDE_Z * (z + 1);

		low = mid;
		mid = high;
		high = none;
		low_words = mid_words;
		mid_words = high_words;
		low_surface = mid_surface;
		mid_surface = high_surface;
		high_surface = 0u;
		if (z + 1 < end)
			high_surface = surface_of[cell.x + LATTICE_X * (cell.y + LATTICE_Y * (z + 1))];
		if (high_surface != 0u) {
			for (int w = 0; w < 7; w++)
				high_words[w] = surfaces[(high_surface - 1u) * 8u + uint(w)];
		} else {
			for (int w = 0; w < 7; w++)
				high_words[w] = 0x80808080u;
		}
		COLUMN(0, 0, 0)
		COLUMN(-1, 0, 1)
		COLUMN(1, 0, 1)
		COLUMN(0, -1, 1)
		COLUMN(0, 1, 1)
		COLUMN(-1, -1, 2)
		COLUMN(1, -1, 2)
		COLUMN(-1, 1, 2)
		COLUMN(1, 1, 2)
		if (z > cell.z)
			finish(low, ivec3(cell.xy, z - 1), low_surface);
	}
}
