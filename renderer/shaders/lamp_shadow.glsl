// Soft-edged shadows of lamps: percentage-closer filtering whose width follows
// the source's radius (or angle, for parallel light) and the mean distance of
// what is in between (Fernando, "Percentage-Closer Soft Shadows", 2005).
layout(std140, binding = 4) uniform LampLayers {
	MapLayer lamp_layers[96];
};
layout(binding = 5) uniform sampler2DArrayShadow lamp_depth_compare;
layout(binding = 6) uniform sampler2DArray lamp_depth;

#define LAMP_SEARCH_TAPS 8
#define LAMP_FILTER_TAPS 16
#define LAMP_HARD_TAPS 4
// Blockers nearer to the lamp than this share of the way are searched for only
// as widely as if they were there.
#define LAMP_NEAREST_BLOCKER 0.25

// 0 dark .. 1 lit. Where the lamp does not shine (reaches false) nothing is
// looked up. The lengths of the loops, and not branches, leave work out:
// software runs both sides of a branch.
float lamp_visibility(Lamp lamp, vec3 p, vec3 n, vec3 to_lamp, float metres, bool reaches)
{
	const mat2 golden = mat2(-0.7373688, 0.6754903, -0.6754903, -0.7373688);
	int index = lamp.maps.x + (lamp.maps.y == 6 ? shadow_face(-to_lamp) : 0);
	MapLayer layer = lamp_layers[index];
	ShadowPoint s = shadow_point(layer, p, n, -to_lamp * metres, metres);
	float one_texel = 1.0 / layer.extent.y;
	bool parallel = layer.extent.z == 0.0;
	float source = lamp.position.w / (2.0 * layer.extent.x);
	bool far_enough = reaches && s.axial > layer.range.x;
	bool soft = source > 0.0 && far_enough;

	// mean distance of the blockers from the lamp
	float nearest = max(layer.range.x, LAMP_NEAREST_BLOCKER * s.axial);
	float widest = max(source * (parallel ? s.axial - layer.range.x : 1.0 / nearest - 1.0 / s.axial),
			   one_texel);
	float sum = 0.0, count = 0.0;
	vec2 direction = vec2(1.0, 0.0);
	int taps = soft ? LAMP_SEARCH_TAPS : 0;

	for (int i = 0; i < taps; i++) {
		float radius = widest * sqrt((float(i) + 0.5) / float(LAMP_SEARCH_TAPS));
		vec2 texel = floor((s.uvz.xy + direction * radius) * layer.extent.y);
		vec2 centre = (texel + 0.5) * one_texel - s.uvz.xy;
		ivec2 at = ivec2(clamp(texel, vec2(0.0), vec2(layer.extent.y - 1.0)));
		float depth = texelFetch(lamp_depth, ivec3(at, index), 0).r;

		if (depth > s.uvz.z + dot(s.slope, centre)) {
			sum += shadow_axial(layer, depth);
			count += 1.0;
		}
		direction = golden * direction;
	}

	float width = source * (parallel ? s.axial - sum / max(count, 1.0)
					 : count / max(sum, 1e-6) - 1.0 / s.axial);

	taps = !far_enough ? 0 : !soft ? LAMP_HARD_TAPS : count > 0.0 ? LAMP_FILTER_TAPS : 0;
	return shadow_filter(lamp_depth_compare, index, s,
			     soft ? clamp(width, one_texel, widest) : one_texel, taps);
}

// Whether a point is lit, by one comparison of 2 x 2 texels of a layer: for what takes
// the mean over many points.
float lamp_lit(MapLayer layer, int index, vec3 p, vec3 n, vec3 to_lamp, float metres)
{
	ShadowPoint s = shadow_point(layer, p, n, -to_lamp * metres, metres);
	float lit = texture(lamp_depth_compare, vec4(s.uvz.xy, float(index), s.uvz.z));

	return s.axial > layer.range.x ? lit : 1.0;
}
