// Depth maps of lamps and patches (struct map_layer in renderer/view/maps.h).
// Depth is reversed, 1 at near and 0 at far: float depth is then as fine far
// away as nearby, and outside of a map (border 0) everything is lit.
struct MapLayer {
	mat4 clip;   // scene to the layer's clip space
	vec4 extent; // x: half width at distance 1 (perspective) or metres; y: pixels; z: 1 perspective
	vec4 range;  // x: near, y: far, metres
};

// What one comparison needs: where the surface is in the layer and how its
// depth goes on beside it, so that taps on a slanted plane do not shade it.
struct ShadowPoint {
	vec3 uvz;
	vec2 slope; // change of depth per uv
	float axial; // metres along the layer's axis
};

vec3 shadow_uvz(MapLayer layer, vec3 p, out float w)
{
	vec4 clip = layer.clip * vec4(p, 1.0);

	w = clip.w;
	return clip.xyz / clip.w * vec3(0.5, 0.5, 1.0) + vec3(0.5, 0.5, 0.0);
}

// A texel's width at the surface, metres.
float shadow_texel(MapLayer layer, vec3 p)
{
	float w = layer.clip[0].w * p.x + layer.clip[1].w * p.y + layer.clip[2].w * p.z +
		  layer.clip[3].w;

	return 2.0 * layer.extent.x * w / layer.extent.y;
}

// The comparison reads 2 x 2 texels, so the plane's depth may be off by one and
// a half texels times its slope: the point is lifted by so much, and no more
// (a shadow parts from what throws it by up to that and 1 mm).
ShadowPoint shadow_point(MapLayer layer, vec3 p, vec3 n, vec3 to_lamp)
{
	float c = dot(n, to_lamp);
	float lift = 1.5 * shadow_texel(layer, p) * sqrt(max(1.0 - c * c, 0.0)) + 1e-3;
	vec3 q = p + n * lift;
	vec3 helper = abs(n.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0);
	vec3 tangent = normalize(cross(helper, n));
	vec3 bitangent = cross(n, tangent);
	ShadowPoint s;
	float w;

	s.uvz = shadow_uvz(layer, q, w);
	// ortho: w is 1, the distance comes from the depth
	s.axial = layer.extent.z != 0.0 ? w : mix(layer.range.y, layer.range.x, s.uvz.z);

	// A projective map takes planes to planes: depth is affine in uv.
	float h = 0.02 * s.axial;
	vec3 a = shadow_uvz(layer, q + tangent * h, w) - s.uvz;
	vec3 b = shadow_uvz(layer, q + bitangent * h, w) - s.uvz;
	float det = a.x * b.y - a.y * b.x;

	s.slope = abs(det) > 1e-12 ? vec2(a.z * b.y - b.z * a.y, b.z * a.x - a.z * b.x) / det
				   : vec2(0.0);
	return s;
}

// Share of `taps` comparisons on a disc (uv radius) that are lit. The spiral
// (Vogel 1979) is the same everywhere: no term may depend on the picture.
float shadow_filter(sampler2DArrayShadow map, int index, ShadowPoint s, float radius, int taps)
{
	const mat2 golden = mat2(-0.7373688, 0.6754903, -0.6754903, -0.7373688);
	vec2 direction = vec2(1.0, 0.0);
	float lit = 0.0;

	for (int i = 0; i < taps; i++) {
		vec2 at = direction * (radius * sqrt((float(i) + 0.5) / float(taps)));

		lit += texture(map, vec4(s.uvz.xy + at, float(index),
					 s.uvz.z + dot(s.slope, at)));
		direction = golden * direction;
	}
	return lit / float(taps);
}

float shadow_axial(MapLayer layer, float depth)
{
	float n = layer.range.x, f = layer.range.y;

	if (layer.extent.z == 0.0)
		return mix(f, n, depth);
	return n * f / (n + depth * (f - n));
}

// Largest cube face of a direction: +x -x +y -y +z -z.
int shadow_face(vec3 d)
{
	vec3 a = abs(d);

	if (a.x >= a.y && a.x >= a.z)
		return d.x > 0.0 ? 0 : 1;
	if (a.y >= a.z)
		return d.y > 0.0 ? 2 : 3;
	return d.z > 0.0 ? 4 : 5;
}
