// The lattice, for propagation and for shading: struct lattice_block in
// renderer/gi/lpv_private.h, struct links in renderer/gi/link.h, and the light.
layout(std140, binding = 8) uniform LatticeBlock {
	ivec4 size;       // cells along x, y, z; w: all
	vec4 origin;      // lower corner, scene, metres; w: side of a cell
	vec4 sector_a;    // xyz: face, edge, corner, medium folded in; w: half the sum over all 26
	vec4 sector_b;
	vec4 sector_mu;   // w: flux vector of light that leaves a surface, per flux
	vec4 look;        // irradiance = x F - y (V.n)
	vec4 point;       // xyz: the point that stands for a cell, in cells from its lower corner
} lattice;

// Everything that is only read is a buffer texture: one fetch for four words,
// where a storage buffer takes four loads (on llvmpipe four times the time).
// F, V [W] per cell: all of red, all of green, all of blue.
layout(binding = 8) uniform samplerBuffer light;
// Per cell: x its surface record, record 0 is that of cells with all links open;
// y its record among the masks of lpv_front.glsl, plus 1.
layout(binding = 9) uniform usamplerBuffer surface_of;
// Two uvec4: 26 bytes of transmittance in 1/128; the last word: first block, their number from
// bit 27 on.
layout(binding = 10) uniform usamplerBuffer surfaces;

// Over the length of a neighbour's offset, by its kind.
const float INVERSE[3] = float[3](1.0, 0.70710678, 0.57735027);

bool lattice_inside(ivec3 cell)
{
	return all(greaterThanEqual(cell, ivec3(0))) && all(lessThan(cell, lattice.size.xyz));
}

int lattice_index(ivec3 cell)
{
	return cell.x + lattice.size.x * (cell.y + lattice.size.y * cell.z);
}
