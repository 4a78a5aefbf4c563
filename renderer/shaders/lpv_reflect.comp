#version 450 core
// Before each step, for the cells that meet surfaces: what the cell emits is
// the light of the lamps there and what its stopped links throw back of its
// own light. Other cells' entries hold the light of the lamps all the time.
// Cells with stopped links to cells of the lattice come first in the list, and
// also take here (WITH_GATHER) what their neighbours send through;
// lpv_step.comp adds nothing to them.
// check: #define LATTICE_X 32
// check: #define LATTICE_Y 32
// check: #define LATTICE_Z 32
// check: #define WITH_GATHER
layout(local_size_x = 64) in;

#include "lpv_lattice.glsl"

layout(std430, binding = 11) writeonly buffer SourceBuffer { vec4 emitted[]; };
// Two vec4 each: reflect rgb, direction (offset + 1 in two bits each, kind); facing xyz, share that is stopped.
layout(binding = 12) uniform samplerBuffer blocks;
layout(binding = 11) uniform samplerBuffer sent;
layout(binding = 13) uniform samplerBuffer inject;
layout(binding = 14) uniform usamplerBuffer surface_cells; // cell, surface record
layout(location = 0) uniform int start; // of this dispatch's share of the list
layout(location = 1) uniform int end;

const int STRIDE_Y = LATTICE_X + 2;
const int STRIDE_Z = STRIDE_Y * (LATTICE_Y + 2);
const int BORDERED = STRIDE_Z * (LATTICE_Z + 2);
const int CELLS = LATTICE_X * LATTICE_Y * LATTICE_Z;

float kept(float phi)
{
	precise float k = phi < 0.0 ? 0.0 : phi;

	return k;
}

#ifdef WITH_GATHER
vec3 fluxes(vec4 weight, int from)
{
	return vec3(kept(dot(weight, texelFetch(sent, from))),
		    kept(dot(weight, texelFetch(sent, BORDERED + from))),
		    kept(dot(weight, texelFetch(sent, 2 * BORDERED + from))));
}

// What the neighbour at (dx, dy, dz) sends through the link; all constants but for the light.
#define NUMBER(dx, dy, dz) ((dx) + 1 + 3 * ((dy) + 1) + 9 * ((dz) + 1))
#define DIRECTION(n) ((n) > 13 ? (n) - 1 : (n))
#define KIND(dx, dy, dz) (abs(dx) + abs(dy) + abs(dz) - 1)
#define TAKE(dx, dy, dz)                                                                      \
	{                                                                                      \
		const int j = DIRECTION(NUMBER(dx, dy, dz));                                   \
		const int kind = KIND(dx, dy, dz);                                             \
		const vec3 o = -vec3(dx, dy, dz);                                              \
		/* by way of int: AVX2 has no conversion from unsigned; in 1/128 */            \
		float through = float(int((words[j >> 2] >> (8 * (j & 3))) & 255u)) / 128.0;   \
		vec3 phi = through * fluxes(vec4(lattice.sector_a[kind], fb[kind] * o),        \
					    at + (dx) + STRIDE_Y * (dy) + STRIDE_Z * (dz));    \
		vec4 lobe = vec4(1.0, fm[kind] * o);                                           \
		red += phi.x * lobe;                                                           \
		green += phi.y * lobe;                                                         \
		blue += phi.z * lobe;                                                          \
	}
#define ROW(dy, dz) TAKE(-1, dy, dz) TAKE(0, dy, dz) TAKE(1, dy, dz)
#define LAYER(dz) ROW(-1, dz) ROW(0, dz) ROW(1, dz)
#endif

void main()
{
	uint s = (gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x) * gl_WorkGroupSize.x +
		 gl_LocalInvocationID.x + uint(start);

	if (s >= uint(end))
		return;
	ivec2 entry = ivec2(texelFetch(surface_cells, int(s)).xy);
	int index = entry.x;
	ivec3 cell = ivec3(index % LATTICE_X, (index / LATTICE_X) % LATTICE_Y,
			   index / (LATTICE_X * LATTICE_Y));
	int at = cell.x + 1 + STRIDE_Y * (cell.y + 1) + STRIDE_Z * (cell.z + 1);
	vec4 r = texelFetch(sent, at);
	vec4 g = texelFetch(sent, BORDERED + at);
	vec4 b = texelFetch(sent, 2 * BORDERED + at);
	vec4 red = texelFetch(inject, index);
	vec4 green = texelFetch(inject, CELLS + index);
	vec4 blue = texelFetch(inject, 2 * CELLS + index);
	uvec4 first_words = texelFetch(surfaces, 2 * entry.y);
	uvec4 last_words = texelFetch(surfaces, 2 * entry.y + 1);
	uint word = last_words.w;
	int first = int(word & 0x07ffffffu);
	int count = int(word >> 27);

	vec3 fb = lattice.sector_b.xyz * vec3(INVERSE[0], INVERSE[1], INVERSE[2]);

	for (int k = first; k < first + count; k++) {
		vec4 block = texelFetch(blocks, 2 * k);
		int code = floatBitsToInt(block.w);
		vec3 o = vec3((ivec3(code) >> ivec3(0, 2, 4)) & 3) - 1.0;
		int kind = code >> 6;
		float a = kind == 0 ? lattice.sector_a.x : kind == 1 ? lattice.sector_a.y : lattice.sector_a.z;
		float b_ = kind == 0 ? fb.x : kind == 1 ? fb.y : fb.z;
		vec4 weight = vec4(a, o * b_);
		vec4 lobe = vec4(1.0, lattice.sector_mu.w * texelFetch(blocks, 2 * k + 1).xyz);

		red += block.x * kept(dot(weight, r)) * lobe;
		green += block.y * kept(dot(weight, g)) * lobe;
		blue += block.z * kept(dot(weight, b)) * lobe;
	}
#ifdef WITH_GATHER
	uint words[7] = uint[7](first_words.x, first_words.y, first_words.z, first_words.w,
				last_words.x, last_words.y, last_words.z);
	vec3 fm = lattice.sector_mu.xyz * vec3(INVERSE[0], INVERSE[1], INVERSE[2]);

	LAYER(-1)
	ROW(-1, 0)
	TAKE(-1, 0, 0)
	TAKE(1, 0, 0)
	ROW(1, 0)
	LAYER(1)
#endif
	emitted[index] = red;
	emitted[CELLS + index] = green;
	emitted[2 * CELLS + index] = blue;
}
