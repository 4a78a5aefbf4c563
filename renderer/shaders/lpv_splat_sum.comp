#version 450 core
// Adds each texel's light to the cell in front of it. Neighbouring texels of a
// run mostly share a cell: they are summed first, in a fixed order.
layout(local_size_x = 64) in;

#include "lpv_splat.glsl"

void add_fixed(uint at, float value, float unit)
{
	float magnitude = floor(abs(value) * unit + 0.5);
	uint high = uint(magnitude * (1.0 / 4294967296.0));
	uint low = uint(magnitude - float(high) * 4294967296.0);

	if (high == 0u && low == 0u)
		return;
	if (value < 0.0) {
		low = ~low + 1u;
		high = ~high + (low == 0u ? 1u : 0u);
	}
	uint old = atomicAdd(splat.fixed_sum[at], low);
	atomicAdd(splat.fixed_sum[at + 1u], high + (old + low < old ? 1u : 0u));
}

void flush(int cell, vec4 red, vec4 green, vec4 blue)
{
	float unit = power_of_two(unit_exponent());
	uint at = 24u * uint(cell);

	for (int i = 0; i < 4; i++) {
		add_fixed(at + 2u * uint(i), red[i], unit);
		add_fixed(at + 8u + 2u * uint(i), green[i], unit);
		add_fixed(at + 16u + 2u * uint(i), blue[i], unit);
	}
}

void main()
{
	ivec3 start;
	int current = -1;
	vec4 red = vec4(0.0), green = vec4(0.0), blue = vec4(0.0);

	if (!run_start(start) || splat.peak == 0u)
		return;
	for (int k = 0; k < RUN * RUN; k++) {
		// back and forth, so that one texel's neighbour comes next
		int row = k / RUN;
		ivec2 at = start.xy + ivec2((row & 1) == 0 ? k % RUN : RUN - 1 - k % RUN, row);
		ivec3 cell;

		if (any(greaterThanEqual(at, ivec2(map_size.x))))
			continue;
		vec4 p = texelFetch(position_area_map, ivec3(at, start.z), 0);
		if (p.a == 0.0)
			continue;
		vec3 flux = p.a * texelFetch(exitance_map, ivec3(at, start.z), 0).rgb;
		vec3 normal = texelFetch(normal_map, ivec3(at, start.z), 0).xyz;
		if (!finite3(flux) || !finite3(p.xyz) || !finite3(normal) || all(equal(flux, vec3(0.0))))
			continue;
		normal = normalize(normal);
		Front front;
		if (!front_of(p.xyz, normal, front) || !front_cell(front, cell))
			continue;
		int index = lattice_index(cell);
		if (index != current) {
			if (current >= 0)
				flush(current, red, green, blue);
			red = green = blue = vec4(0.0);
			current = index;
		}
		vec4 lobe = vec4(1.0, lattice.sector_mu.w * normal);
		red += flux.x * lobe;
		green += flux.y * lobe;
		blue += flux.z * lobe;
	}
	if (current >= 0)
		flush(current, red, green, blue);
}
