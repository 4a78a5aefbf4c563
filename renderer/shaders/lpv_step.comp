#version 450 core
// One step of the propagation, L <- I + P L (renderer/gi/lpv_cpu.c is the same
// in plain C). Gather: each cell takes from its 26 neighbours what they send
// through the link, and what lpv_reflect.comp left there before: the light of
// the lamps and what its own links stopped.
//
// An invocation walks up a column of cells with one band: every cell of the
// nine columns around it is read once and serves three layers, and all sums
// stay in registers. The lattice has a dark border of one cell, so nothing
// asks where the edge is; sizes are constants. Cells are stored as they are
// sent, scaled by their clamp (see clamp_scale); the last steps of a frame
// (WITH_LOOK) also write them as they are.
// check: #define LATTICE_X 32
// check: #define LATTICE_Y 32
// check: #define LATTICE_Z 32
// check: #define SEGMENT 8
// check: #define WITH_LOOK
layout(local_size_x = 8, local_size_y = 4, local_size_z = 1) in;

#include "lpv_lattice.glsl"

layout(std430, binding = 13) writeonly buffer NextBuffer { vec4 next[]; };
layout(binding = 11) uniform samplerBuffer sent;
layout(binding = 12) uniform samplerBuffer emitted;
#ifdef WITH_LOOK
layout(std430, binding = 15) writeonly buffer NewLightBuffer { vec4 new_light[]; };
#endif

const int SEGMENTS = (LATTICE_Z + SEGMENT - 1) / SEGMENT;
const int STRIDE_Y = LATTICE_X + 2;
const int STRIDE_Z = STRIDE_Y * (LATTICE_Y + 2);
const int BORDERED = STRIDE_Z * (LATTICE_Z + 2);
const int CELLS = LATTICE_X * LATTICE_Y * LATTICE_Z;

// A comparison, not max(), so that a NaN goes on to where it is counted.
float kept(float phi)
{
	precise float k = phi < 0.0 ? 0.0 : phi;

	return k;
}

// Transmittance in 1/128 towards the neighbour at (dx, dy, dz); constants after unrolling.
float through(uint words[7], int dx, int dy, int dz)
{
	int n = dx + 1 + 3 * (dy + 1) + 9 * (dz + 1);
	int j = n > 13 ? n - 1 : n;

	// by way of int: AVX2 has no conversion from unsigned
	return float(int((words[j >> 2] >> (8 * (j & 3))) & 255u));
}

void add(inout vec4 sum, float phi, float mu, int jx, int jy, int jz)
{
	sum.x += phi;
	phi *= mu;
	if (jx != 0)
		sum.y += jx > 0 ? phi : -phi;
	if (jy != 0)
		sum.z += jy > 0 ? phi : -phi;
	if (jz != 0)
		sum.w += jz > 0 ? phi : -phi;
}

#define LESS(kind) ((kind) > 0 ? (kind) - 1 : 0)
// What the cell at (dx, dy) in this layer sends to the layers below, here and above.
#define COLUMN(dx, dy, kind)                                                                  \
	{                                                                                      \
		vec4 c = texelFetch(sent, source + (dx) + (dy) * STRIDE_Y);                    \
		float across = 0.0;                                                            \
		if ((dx) != 0)                                                                 \
			across = (dx) < 0 ? c.y : -c.y;                                        \
		if ((dy) != 0)                                                                 \
			across += (dy) < 0 ? c.z : -c.z;                                       \
		float slant = fa[kind] * c.x + fb[kind] * across;                              \
		float rise = fb[kind] * c.w;                                                   \
		add(low, through(low_words, dx, dy, 1) * kept(slant - rise), fm[kind], -(dx),  \
		    -(dy), -1);                                                                \
		add(high, through(high_words, dx, dy, -1) * kept(slant + rise), fm[kind],      \
		    -(dx), -(dy), 1);                                                          \
		if ((kind) > 0)                                                                \
			add(mid,                                                               \
			    through(mid_words, dx, dy, 0) *                                    \
				    kept(fa[LESS(kind)] * c.x + fb[LESS(kind)] * across),      \
			    fm[LESS(kind)], -(dx), -(dy), 0);                                  \
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
	int band = int(gl_WorkGroupID.z) / SEGMENTS;
	ivec3 cell = ivec3(gl_GlobalInvocationID.xy, (int(gl_WorkGroupID.z) % SEGMENTS) * SEGMENT);
	int end = min(cell.z + SEGMENT, LATTICE_Z);
	vec4 low = vec4(0.0), mid = vec4(0.0), high = vec4(0.0);
	uint low_words[7], mid_words[7], high_words[7];
	// 1/128 is the unit of the transmittance; a power of two, so exact
	vec3 fa = lattice.sector_a.xyz * (1.0 / 128.0);
	vec3 fb = lattice.sector_b.xyz * vec3(INVERSE[0], INVERSE[1], INVERSE[2]) * (1.0 / 128.0);
	vec3 fm = lattice.sector_mu.xyz * vec3(INVERSE[0], INVERSE[1], INVERSE[2]);

	if (cell.x >= LATTICE_X || cell.y >= LATTICE_Y)
		return;
	for (int w = 0; w < 7; w++)
		high_words[w] = mid_words[w] = 0u;
	for (int z = cell.z - 1; z <= end; z++) {
		int source = band * BORDERED + cell.x + 1 + STRIDE_Y * (cell.y + 1) + STRIDE_Z * (z + 1);
		int above = cell.x + LATTICE_X * (cell.y + LATTICE_Y * min(z + 1, LATTICE_Z - 1));
		int record = 2 * int(texelFetch(surface_of, above).x);
		uvec4 first_words = texelFetch(surfaces, record);
		uvec4 last_words = texelFetch(surfaces, record + 1);

		low = mid;
		mid = high;
		high = vec4(0.0);
		low_words = mid_words;
		mid_words = high_words;
		high_words = uint[7](first_words.x, first_words.y, first_words.z, first_words.w,
				     last_words.x, last_words.y, last_words.z);
		COLUMN(0, 0, 0)
		COLUMN(-1, 0, 1)
		COLUMN(1, 0, 1)
		COLUMN(0, -1, 1)
		COLUMN(0, 1, 1)
		COLUMN(-1, -1, 2)
		COLUMN(1, -1, 2)
		COLUMN(-1, 1, 2)
		COLUMN(1, 1, 2)
		if (z > cell.z) {
			int index = band * CELLS + cell.x + LATTICE_X * (cell.y + LATTICE_Y * (z - 1));
			vec4 c = texelFetch(emitted, index) + low;

			next[source - STRIDE_Z] = c * clamp_scale(c);
#ifdef WITH_LOOK
			new_light[index] = c;
#endif
		}
	}
}
