// Shadows of emissive patches: a hemicube of depth maps at each patch's origin.
// The patches together make the soft edge; the filter only hides their number.
layout(std140, binding = 6) uniform PatchLayers {
	MapLayer patch_layers[80];
};
layout(binding = 7) uniform sampler2DArray patch_depth;

#define PATCH_TAPS 4

float patch_visibility(Patch patch_, vec3 p, vec3 n, bool reaches)
{
	vec3 d = p - patch_.origin.xyz;
	vec3 local = vec3(dot(d, patch_.u.xyz) * patch_.u.w, dot(d, patch_.v.xyz) * patch_.v.w,
			  dot(d, patch_.normal.xyz));
	vec3 a = abs(local);
	int face = 0; // along the normal, then +u -u +v -v

	if (a.x > local.z && a.x >= a.y)
		face = local.x > 0.0 ? 1 : 2;
	else if (a.y > local.z)
		face = local.y > 0.0 ? 3 : 4;

	int index = patch_.maps.x + face;
	MapLayer layer = patch_layers[index];
	ShadowPoint s = shadow_point(layer, p, n, d, length(d));

	// as wide as the patch would blur a blocker two thirds of the way down
	float width = patch_.centre.w * 0.5 / (s.axial * 2.0 * layer.extent.x);
	float radius = clamp(width * layer.extent.y, 0.7, 8.0);
	int taps = reaches && s.axial > layer.range.x ? PATCH_TAPS : 0;
	const mat2 golden = mat2(-0.7373688, 0.6754903, -0.6754903, -0.7373688);
	vec2 direction = vec2(1.0, 0.0);
	float lit = 0.0;

	for (int i = 0; i < taps; i++) {
		vec2 at = direction * (radius * sqrt((float(i) + 0.5) / float(PATCH_TAPS)));
		vec2 texel = floor(s.uvz.xy * layer.extent.y + at);
		vec2 off = (texel + 0.5) / layer.extent.y - s.uvz.xy;
		float depth = texelFetch(patch_depth, ivec3(clamp(texel, vec2(0.0), vec2(layer.extent.y - 1.0)), index), 0).r;
		lit += depth > s.uvz.z + dot(s.slope, off) ? 0.0 : 1.0;
		direction = golden * direction;
	}
	return taps > 0 ? lit / float(PATCH_TAPS) : 1.0;
}
