// The lattice, for propagation and for shading: struct lattice_block in
// renderer/gi/lpv_gl.h, struct links in renderer/gi/link.h, and the light.
layout(std140, binding = 8) uniform LatticeBlock {
	ivec4 size;       // cells along x, y, z; w: all
	vec4 origin;      // lower corner, scene, metres; w: side of a cell
	vec4 sector_a;    // xyz: face, edge, corner, medium folded in; w: half the sum over all 26
	vec4 sector_b;
	vec4 sector_mu;   // w: flux vector of light that leaves a surface, per flux
	vec4 look;        // irradiance = x F - y (V.n)
	vec4 point;       // xyz: the point that stands for a cell, in cells from its lower corner
} lattice;

// Per cell three vec4: F, V of red, of green, of blue [W].
layout(std430, binding = 8) readonly buffer LightBuffer { vec4 light[]; };
// Per cell: 0 where all links are open, else index + 1 of its surface record.
layout(std430, binding = 9) readonly buffer SurfaceOfBuffer { uint surface_of[]; };
// Eight words: 26 bytes of transmittance in 1/128; word 7: first block, their number from bit 27 on.
layout(std430, binding = 10) readonly buffer SurfaceBuffer { uint surfaces[]; };

bool lattice_inside(ivec3 cell)
{
	return all(greaterThanEqual(cell, ivec3(0))) && all(lessThan(cell, lattice.size.xyz));
}

int lattice_index(ivec3 cell)
{
	return cell.x + lattice.size.x * (cell.y + lattice.size.y * cell.z);
}

// Whether the cell's point lies in front of a surface.
bool lattice_in_front(ivec3 cell, vec3 position, vec3 normal)
{
	vec3 point = lattice.origin.xyz + (vec3(cell) + lattice.point.xyz) * lattice.origin.w;

	return dot(normal, point - position) > 0.0;
}

// The cell that stands for the space in front of a surface point: half a cell
// out, or a whole one where that cell's point still lies behind. False outside.
bool lattice_front_cell(vec3 position, vec3 normal, out ivec3 cell)
{
	vec3 at = (position - lattice.origin.xyz) / lattice.origin.w;

	cell = ivec3(floor(at + 0.5 * normal));
	if (lattice_inside(cell) && lattice_in_front(cell, position, normal))
		return true;
	cell = ivec3(floor(at + normal));
	return lattice_inside(cell) && lattice_in_front(cell, position, normal);
}
