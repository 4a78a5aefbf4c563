// Shadows of emissive patches: a hemicube of depth maps at each patch's origin.
// The patches together make the soft edge; the filter only hides their number.
layout(std430, binding = 6) readonly buffer PatchLayers {
	MapLayer patch_layers[];
};
layout(binding = 7) uniform sampler2DArrayShadow patch_depth_compare;

#define PATCH_TAPS 6

float patch_visibility(Patch patch_, vec3 p, vec3 n)
{
	vec3 d = normalize(p - patch_.origin.xyz);
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
	ShadowPoint s = shadow_point(layer, p, n, -d);

	if (s.axial <= layer.range.x)
		return 1.0;
	// as wide as the patch would blur a blocker two thirds of the way down
	float width = patch_.centre.w * 0.5 / (s.axial * 2.0 * layer.extent.x);
	return shadow_filter(patch_depth_compare, index, s,
			     clamp(width, 1.0 / layer.extent.y, 8.0 / layer.extent.y), PATCH_TAPS);
}
