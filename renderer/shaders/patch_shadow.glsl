// Shadows of emissive patches: a hemicube of depth maps at each patch's origin.
// The patches together make the soft edge; the taps only hide their number.
layout(binding = 7) uniform sampler2DArray patch_depth;

#define PATCH_TAPS 4

// Of a vector in a patch's axes, as face of the hemicube sees it: right, up,
// away. Faces: along the normal, then +u -u +v -v (map_basis_face in maps.c).
vec3 patch_face_axes(vec3 local, int face)
{
	vec3 r = local.yxz;

	r = face == 1 ? local.zyx : r;
	r = face == 2 ? vec3(-local.z, local.y, -local.x) : r;
	r = face == 3 ? local.xzy : r;
	return face == 4 ? vec3(-local.x, local.z, -local.y) : r;
}

// 0 dark .. 1 lit; of no use where the patch does not shine. As shadow_point, but in the patch's own axes, so that nothing
// has to be read for each face.
float patch_visibility(Patch patch_, vec3 p, vec3 n)
{
	const mat2 golden = mat2(-0.7373688, 0.6754903, -0.6754903, -0.7373688);
	float half_ = patch_map.x, pixels = patch_map.y, near = patch_map.z;
	float far = patch_.origin.w;
	vec3 d = p - patch_.origin.xyz;
	mat3 axes = transpose(mat3(patch_.u.xyz * patch_.u.w, patch_.v.xyz * patch_.v.w,
				   patch_.normal.xyz));
	vec3 local = axes * d, local_normal = axes * n, a = abs(local);
	int face = a.x > local.z && a.x >= a.y ? (local.x > 0.0 ? 1 : 2)
		 : a.y > local.z ? (local.y > 0.0 ? 3 : 4) : 0;
	float metres = length(d), c = dot(n, d);
	float axial = max(max(a.x, a.y), local.z);
	float sine = sqrt(max(metres * metres - c * c, 0.0)) / metres;
	float lift = 3.0 * half_ * axial / pixels * sine + patch_map.w;
	vec3 at = patch_face_axes(local + lift * local_normal, face);
	vec3 normal = patch_face_axes(local_normal, face);
	// texels, and the depth there: reversed, affine in them on a plane
	float by_distance = near * far / (far - near);
	float depth = by_distance / at.z - near / (far - near);
	vec2 centre = (at.xy / (at.z * half_) * 0.5 + 0.5) * pixels;
	vec2 slope = normal.xy * (2.0 * half_ * by_distance / pixels / min(c + lift, -1e-5 * metres));
	// as wide as the patch would blur a blocker two thirds of the way down
	float radius = clamp(patch_.centre.w * 0.25 / (at.z * half_) * pixels, 0.7, 8.0);
	vec2 direction = vec2(1.0, 0.0);
	float lit = 0.0;

	// of a fixed length, so that it is unrolled
	for (int i = 0; i < PATCH_TAPS; i++) {
		vec2 tap = direction * (radius * sqrt((float(i) + 0.5) / float(PATCH_TAPS)));
		vec2 texel = clamp(floor(centre + tap), vec2(0.0), vec2(pixels - 1.0));
		float stored = texelFetch(patch_depth, ivec3(texel, patch_.maps.x + face), 0).r;

		lit += stored > depth + dot(slope, texel + 0.5 - centre) ? 0.0 : 1.0 / float(PATCH_TAPS);
		direction = golden * direction;
	}
	return at.z > near ? lit : 1.0;
}
