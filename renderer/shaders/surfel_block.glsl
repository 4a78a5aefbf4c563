// Surfels (renderer/gi/surfel_set.h) on the GPU: sizes, normals, axes.
layout(std140, binding = 8) uniform Surfels {
	vec4 grid;    // xyz: origin of the grid, metres; w: side of a cell, metres
	ivec4 cells;  // xyz: size of the grid; w: slots of its hash table, 0: dense
	vec4 kernel;  // x: 1/radius, 1/m; y: radius, m; z: 1/(how far off a surfel's plane it is
		      // heard), 1/m; w: 1/(sqrt(2) radius), 1/m
	uvec4 counts; // x: surfels, y: links of each, z: taps of each
} surfels;

// Invocations of a group; links and taps lie in blocks of so many surfels, so that a
// group reads in a row.
#define SURFEL_GROUP 64u

// Octahedral (Cigolle et al. 2014): surfel_normal_unpack in surfel_set.c.
vec3 surfel_normal(uint word)
{
	vec2 e = unpackSnorm2x16(word);
	vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
	float under = max(-n.z, 0.0);

	n.xy -= mix(vec2(-under), vec2(under), greaterThanEqual(n.xy, vec2(0.0)));
	return normalize(n);
}

// Axes across a unit normal (Duff et al. 2017): surfel_frame in surfel_set.c.
void surfel_frame(vec3 n, out vec3 u, out vec3 v)
{
	float s = n.z >= 0.0 ? 1.0 : -1.0;
	float a = -1.0 / (s + n.z), b = n.x * n.y * a;

	u = vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x);
	v = vec3(b, s + n.y * n.y * a, -n.y);
}
