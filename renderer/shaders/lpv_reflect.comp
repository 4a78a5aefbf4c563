#version 450 core
// Before each step, for the cells that meet surfaces: what the cell emits is
// the light of the lamps there and what its stopped links throw back of its
// own light. Other cells' entries hold the light of the lamps all the time.
// check: #define LATTICE_X 32
// check: #define LATTICE_Y 32
// check: #define LATTICE_Z 32
layout(local_size_x = 64) in;

#include "lpv_lattice.glsl"

layout(std430, binding = 11) writeonly buffer SourceBuffer { vec4 emitted[]; };
// Two vec4 each: reflect rgb, direction (offset + 1 in two bits each, kind); facing xyz, share that is stopped.
layout(binding = 12) uniform samplerBuffer blocks;
layout(binding = 11) uniform samplerBuffer sent;
layout(binding = 13) uniform samplerBuffer inject;
layout(binding = 14) uniform usamplerBuffer surface_cells;
layout(location = 0) uniform int surface_count;

const int STRIDE_Y = LATTICE_X + 2;
const int STRIDE_Z = STRIDE_Y * (LATTICE_Y + 2);
const int BORDERED = STRIDE_Z * (LATTICE_Z + 2);
const int CELLS = LATTICE_X * LATTICE_Y * LATTICE_Z;

float kept(float phi)
{
	precise float k = phi < 0.0 ? 0.0 : phi;

	return k;
}

void main()
{
	uint s = (gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x) * gl_WorkGroupSize.x +
		 gl_LocalInvocationID.x;

	if (s >= uint(surface_count))
		return;
	int index = int(texelFetch(surface_cells, int(s)).x);
	ivec3 cell = ivec3(index % LATTICE_X, (index / LATTICE_X) % LATTICE_Y,
			   index / (LATTICE_X * LATTICE_Y));
	int at = cell.x + 1 + STRIDE_Y * (cell.y + 1) + STRIDE_Z * (cell.z + 1);
	vec4 r = texelFetch(sent, at);
	vec4 g = texelFetch(sent, BORDERED + at);
	vec4 b = texelFetch(sent, 2 * BORDERED + at);
	vec4 red = texelFetch(inject, index);
	vec4 green = texelFetch(inject, CELLS + index);
	vec4 blue = texelFetch(inject, 2 * CELLS + index);
	uint word = texelFetch(surfaces, 2 * int(s) + 3).w; // record s + 1
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
	emitted[index] = red;
	emitted[CELLS + index] = green;
	emitted[2 * CELLS + index] = blue;
}
