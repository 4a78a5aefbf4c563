// Seed 004's own look-up (section 3.3.3, algorithm 3) for comparison: half a
// cell out, trilinear, cosine lobe against the normal, over d^2, square root.
// Its result is mixed with the surface colour directly, so what stands for
// irradiance here is pi times that.
#include "lpv_lattice.glsl"

vec3 gi_irradiance(vec3 position, vec3 normal)
{
	vec3 at = (position - lattice.origin.xyz) / lattice.origin.w;
	ivec3 low;
	vec3 t;
	vec4 red = vec4(0.0), green = vec4(0.0), blue = vec4(0.0);

	at = clamp(at + 0.5 * normal - 0.5, vec3(0.0), vec3(lattice.size.xyz) - 1.0);
	low = ivec3(floor(at));
	t = at - vec3(low);
	for (int k = 0; k < 8; k++) {
		ivec3 o = ivec3(k & 1, (k >> 1) & 1, k >> 2);
		ivec3 cell = min(low + o, lattice.size.xyz - 1);
		vec3 f = mix(1.0 - t, t, vec3(o));
		float w = f.x * f.y * f.z;
		int i = lattice_index(cell);

		red += w * texelFetch(light, i);
		green += w * texelFetch(light, lattice.size.w + i);
		blue += w * texelFetch(light, 2 * lattice.size.w + i);
	}
	// cosine lobe of -normal in the order (1, -y, z, -x)
	vec4 lobe = vec4(0.886226925, 1.023326708 * vec3(normal.y, -normal.z, normal.x));
	vec3 l = vec3(dot(red, lobe), dot(green, lobe), dot(blue, lobe)) /
		 (lattice.origin.w * lattice.origin.w);
	precise vec3 kept = vec3(l.x < 0.0 ? 0.0 : l.x, l.y < 0.0 ? 0.0 : l.y, l.z < 0.0 ? 0.0 : l.z);

	return 3.14159265 * sqrt(kept);
}
