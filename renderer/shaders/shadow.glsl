// Depth maps of lamps and patches (struct map_layer in renderer/view/maps.h).
// Depth is reversed, 1 at near and 0 at far: float depth is then as fine far
// away as nearby, and outside of a map (border 0) everything is lit.
struct MapLayer {
	mat4 clip;   // scene to the layer's clip space
	vec4 extent; // x: half width at distance 1 (perspective) or metres; y: pixels;
		     // z: 1 perspective; w: change of depth per 1/distance, or per metre
	vec4 range;  // x: near, y: far, z: lift off the surface; metres
};

// What one comparison needs: where the surface is in the layer and how its
// depth goes on beside it, so that taps on a slanted plane do not shade it.
struct ShadowPoint {
	vec3 uvz;
	vec2 slope;  // change of depth per uv
	float axial; // metres along the layer's axis
};

// from: vector from the lamp to p, its length metres. The comparison reads 2 x 2
// texels, so the plane's depth may be off by one and a half texels times its
// slope: the point is lifted by so much, and no more (a shadow parts from what
// throws it by up to that and 1 mm, in small scenes less).
ShadowPoint shadow_point(MapLayer layer, vec3 p, vec3 n, vec3 from, float metres)
{
	vec4 at = layer.clip * vec4(p, 1.0);
	vec4 along = layer.clip * vec4(n, 0.0);
	float c = dot(n, from);
	float sine = sqrt(max(metres * metres - c * c, 0.0)) / metres;
	float lift = 3.0 * layer.extent.x * at.w / layer.extent.y * sine + layer.range.z;
	ShadowPoint s;

	at += along * lift;
	s.uvz = at.xyz / at.w * vec3(0.5, 0.5, 1.0) + vec3(0.5, 0.5, 0.0);
	if (layer.extent.z != 0.0) {
		// On a plane 1/distance, and so depth, is affine in uv.
		s.axial = at.w;
		s.slope = along.xy * (2.0 * layer.extent.x * layer.extent.x * layer.extent.w /
				      min(c + lift, -1e-5 * metres));
	} else {
		// along.z is the normal's part along the axis times the change of depth
		s.axial = mix(layer.range.y, layer.range.x, s.uvz.z);
		s.slope = along.xy * (-2.0 * layer.extent.x * layer.extent.x * layer.extent.w *
				      layer.extent.w / max(along.z, 1e-5 * layer.extent.w));
	}
	return s;
}

// Share of `taps` comparisons on a disc (uv radius) that are lit; 1 for none. The spiral
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
	return taps > 0 ? lit / float(taps) : 1.0;
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
