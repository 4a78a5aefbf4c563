#version 450 core
// The largest flux of any texel, as float bits (they order like the numbers).
layout(local_size_x = 64) in;

#include "lpv_splat.glsl"

void main()
{
	ivec3 start;
	uint most = 0u, bad = 0u;

	if (!run_start(start))
		return;
	for (int k = 0; k < RUN * RUN; k++) {
		ivec2 at = start.xy + ivec2(k % RUN, k / RUN);

		if (any(greaterThanEqual(at, ivec2(map_size.x))))
			continue;
		vec4 p = texelFetch(position_area_map, ivec3(at, start.z), 0);
		if (p.a == 0.0)
			continue;
		vec3 flux = p.a * texelFetch(exitance_map, ivec3(at, start.z), 0).rgb;
		if (!finite3(flux) || !finite3(p.xyz)) {
			bad++;
			continue;
		}
		most = max(most, floatBitsToUint(max(max(flux.x, flux.y), max(flux.z, 0.0))));
	}
	if (most != 0u)
		atomicMax(splat.peak, most);
	if (bad != 0u)
		atomicAdd(splat.bad_texels, bad);
}
