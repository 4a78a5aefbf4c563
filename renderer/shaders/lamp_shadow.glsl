// Soft-edged shadows of lamps: percentage-closer filtering whose width follows
// the source's radius and the mean distance of what is in between (Fernando,
// "Percentage-Closer Soft Shadows", 2005).
layout(std430, binding = 4) readonly buffer LampLayers {
	MapLayer lamp_layers[];
};
layout(binding = 5) uniform sampler2DArrayShadow lamp_depth_compare;
layout(binding = 6) uniform sampler2DArray lamp_depth;

#define LAMP_SEARCH_TAPS 8
#define LAMP_FILTER_TAPS 20
// Blockers nearer to the lamp than this share of the way are searched for only
// as widely as if they were there.
#define LAMP_NEAREST_BLOCKER 0.25

// Mean distance of the blockers from the lamp along the layer's axis, 0: none.
float lamp_blocker(MapLayer layer, int index, ShadowPoint s, float radius)
{
	const mat2 golden = mat2(-0.7373688, 0.6754903, -0.6754903, -0.7373688);
	vec2 direction = vec2(1.0, 0.0);
	float sum = 0.0, count = 0.0;

	for (int i = 0; i < LAMP_SEARCH_TAPS; i++) {
		vec2 at = direction * (radius * sqrt((float(i) + 0.5) / float(LAMP_SEARCH_TAPS)));
		vec2 texel = floor((s.uvz.xy + at) * layer.extent.y);
		vec2 centre = (texel + 0.5) / layer.extent.y - s.uvz.xy;
		float depth = texelFetch(lamp_depth, ivec3(clamp(texel, vec2(0.0),
								 vec2(layer.extent.y - 1.0)), index), 0).r;

		if (depth > s.uvz.z + dot(s.slope, centre)) {
			sum += shadow_axial(layer, depth);
			count += 1.0;
		}
		direction = golden * direction;
	}
	return count > 0.0 ? sum / count : 0.0;
}

// 0 dark .. 1 lit.
float lamp_visibility(Lamp lamp, vec3 p, vec3 n, vec3 to_lamp)
{
	int index = lamp.maps.x;

	if (lamp.maps.y == 6)
		index += shadow_face(-to_lamp);

	MapLayer layer = lamp_layers[index];
	ShadowPoint s = shadow_point(layer, p, n, to_lamp);
	float one_texel = 1.0 / layer.extent.y;
	float source = lamp.direction.w == 2.0 ? 0.0 : lamp.position.w / (2.0 * layer.extent.x);

	if (s.axial <= layer.range.x)
		return 1.0;
	if (source <= 0.0)
		return shadow_filter(lamp_depth_compare, index, s, one_texel, 4);

	float nearest = max(layer.range.x, LAMP_NEAREST_BLOCKER * s.axial);
	float widest = source * (1.0 / nearest - 1.0 / s.axial);
	float blocker = lamp_blocker(layer, index, s, max(widest, one_texel));

	if (blocker <= 0.0)
		return 1.0;
	float width = source * (1.0 / blocker - 1.0 / s.axial);
	return shadow_filter(lamp_depth_compare, index, s, clamp(width, one_texel, max(widest, one_texel)),
			     LAMP_FILTER_TAPS);
}
