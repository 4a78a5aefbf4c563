#version 450 core
// One step of the propagation, L <- I + P L (renderer/gi/lpv_cpu.c is the same
// in plain C). Gather: each cell takes from its 26 neighbours what they send,
// and what lpv_reflect.comp left there before: the light of the lamps and what
// its own links stopped. Cells with stopped links to neighbours are done there
// as a whole, so this kernel knows no links.
//
// An invocation walks along y, where memory is near, up 2 x 2 columns of cells
// with one band: every cell of the 16 columns around is read once and serves four cells in three layers,
// and all sums stay in registers. The lattice has a dark border of one cell,
// so nothing asks where the edge is; sizes are constants. Cells are stored as
// they are sent, scaled by their clamp (see clamp_scale); the last steps of a
// frame (WITH_LOOK) also write them as they are.
// check: #define LATTICE_X 32
// check: #define LATTICE_Y 32
// check: #define LATTICE_Z 32
// check: #define SEGMENT 16
// check: #define WITH_LOOK
layout(local_size_x = 8, local_size_y = 4, local_size_z = 1) in;

#include "lpv_lattice.glsl"

layout(binding = 11) uniform samplerBuffer sent;
layout(binding = 12) uniform samplerBuffer emitted;
layout(binding = 13) uniform usamplerBuffer whole; // 1: emitted is all the light
// Storage buffers: images take twice as long to write on llvmpipe.
layout(std430, binding = 13) writeonly buffer NextBuffer { vec4 next[]; };
#ifdef WITH_LOOK
layout(std430, binding = 15) writeonly buffer NewLightBuffer { vec4 new_light[]; };
#endif

const int SEGMENTS = (LATTICE_Y + SEGMENT - 1) / SEGMENT;
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

// What a cell at (dx, dz) has of x and z towards here.
float signed_sum(int dx, int dz, float x, float z)
{
	if (dx == 0)
		return dz == 0 ? 0.0 : dz < 0 ? z : -z;
	if (dz == 0)
		return dx < 0 ? x : -x;
	if (dx < 0)
		return dz < 0 ? x + z : x - z;
	return dz < 0 ? z - x : -(x + z);
}

// The cell at (sx, sz) in this layer, times the constants of the three kinds.
#define SOURCE(sx, sz)                                                                         \
	c = texelFetch(sent, source + (sx) + (sz) * STRIDE_Z);                                 \
	flux = fa * c.x;                                                                       \
	to_x = fb * c.y;                                                                       \
	to_z = fb * c.w;                                                                       \
	to_y = fb * c.z;

#define LESS(kind) ((kind) > 0 ? (kind) - 1 : 0)
// What it sends to the layers below, here and above of a column; it lies at (dx, dz) from there.
#define GIVE(column, dx, dz, kind)                                                            \
	{                                                                                      \
		float slant = flux[kind] + signed_sum(dx, dz, to_x[kind], to_z[kind]);         \
		add(low[column], kept(slant - to_y[kind]), fm[kind], -(dx), -1, -(dz));        \
		add(high[column], kept(slant + to_y[kind]), fm[kind], -(dx), 1, -(dz));        \
		if ((kind) > 0)                                                                \
			add(mid[column],                                                       \
			    kept(flux[LESS(kind)] +                                            \
				 signed_sum(dx, dz, to_x[LESS(kind)], to_z[LESS(kind)])),      \
			    fm[LESS(kind)], -(dx), 0, -(dz));                                  \
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

// The cell at (sx, sz) of the four, a layer below the newest that was read.
#define STORE(column, sx, sz)                                                                  \
	if (cell.x + (sx) < LATTICE_X && cell.z + (sz) < LATTICE_Z) {                            \
		int index = below + (sx) + (sz) * LATTICE_X * LATTICE_Y;                                     \
		vec4 e = texelFetch(emitted, band * CELLS + index);                            \
		vec4 l = texelFetch(whole, index).x != 0u ? e : e + low[column];               \
		next[source - STRIDE_Y + (sx) + (sz) * STRIDE_Z] = l * clamp_scale(l); \
		LOOK(band * CELLS + index, l)                                                  \
	}
#ifdef WITH_LOOK
#define LOOK(index, l) new_light[index] = l;
#else
#define LOOK(index, l)
#endif

void main()
{
	int band = int(gl_WorkGroupID.z) / SEGMENTS;
	ivec3 cell = ivec3(2 * gl_GlobalInvocationID.x, (int(gl_WorkGroupID.z) % SEGMENTS) * SEGMENT, 2 * gl_GlobalInvocationID.y);
	int end = min(cell.y + SEGMENT, LATTICE_Y);
	vec4 low[4], mid[4], high[4];
	vec4 c;
	vec3 flux, to_x, to_y, to_z;
	vec3 fa = lattice.sector_a.xyz;
	vec3 fb = lattice.sector_b.xyz * vec3(INVERSE[0], INVERSE[1], INVERSE[2]);
	vec3 fm = lattice.sector_mu.xyz * vec3(INVERSE[0], INVERSE[1], INVERSE[2]);

	if (cell.x >= LATTICE_X || cell.z >= LATTICE_Z)
		return;
	low = mid = high = vec4[4](vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
	for (int y = cell.y - 1; y <= end; y++) {
		int source = band * BORDERED + cell.x + 1 + STRIDE_Y * (y + 1) + STRIDE_Z * (cell.z + 1);
		int below = cell.x + LATTICE_X * (y - 1 + LATTICE_Y * cell.z);

		low = mid;
		mid = high;
		high = vec4[4](vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
		SOURCE(-1, -1) GIVE(0, -1, -1, 2)
		SOURCE(0, -1) GIVE(0, 0, -1, 1) GIVE(1, -1, -1, 2)
		SOURCE(1, -1) GIVE(0, 1, -1, 2) GIVE(1, 0, -1, 1)
		SOURCE(2, -1) GIVE(1, 1, -1, 2)
		SOURCE(-1, 0) GIVE(0, -1, 0, 1) GIVE(2, -1, -1, 2)
		SOURCE(0, 0) GIVE(0, 0, 0, 0) GIVE(1, -1, 0, 1) GIVE(2, 0, -1, 1) GIVE(3, -1, -1, 2)
		SOURCE(1, 0) GIVE(0, 1, 0, 1) GIVE(1, 0, 0, 0) GIVE(2, 1, -1, 2) GIVE(3, 0, -1, 1)
		SOURCE(2, 0) GIVE(1, 1, 0, 1) GIVE(3, 1, -1, 2)
		SOURCE(-1, 1) GIVE(0, -1, 1, 2) GIVE(2, -1, 0, 1)
		SOURCE(0, 1) GIVE(0, 0, 1, 1) GIVE(1, -1, 1, 2) GIVE(2, 0, 0, 0) GIVE(3, -1, 0, 1)
		SOURCE(1, 1) GIVE(0, 1, 1, 2) GIVE(1, 0, 1, 1) GIVE(2, 1, 0, 1) GIVE(3, 0, 0, 0)
		SOURCE(2, 1) GIVE(1, 1, 1, 2) GIVE(3, 1, 0, 1)
		SOURCE(-1, 2) GIVE(2, -1, 1, 2)
		SOURCE(0, 2) GIVE(2, 0, 1, 1) GIVE(3, -1, 1, 2)
		SOURCE(1, 2) GIVE(2, 1, 1, 2) GIVE(3, 0, 1, 1)
		SOURCE(2, 2) GIVE(3, 1, 1, 2)
		if (y > cell.y) {
			STORE(0, 0, 0)
			STORE(1, 1, 0)
			STORE(2, 0, 1)
			STORE(3, 1, 1)
		}
	}
}
