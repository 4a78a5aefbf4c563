#version 450 core
// Reflective shadow map of one lamp, or of a group of emissive patches (seed
// 004 section 3.3.1): what struct rsm_set in renderer/gi/gi.h says.
// check: #define PATCHES
#include "medium.glsl"
#include "material.glsl"
#ifdef PATCHES
#include "patch.glsl"
#else
#include "lamp.glsl"
#endif

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 0) out vec4 out_position_area;
layout(location = 1) out vec4 out_normal;
layout(location = 2) out vec4 out_exitance;
layout(location = 2) uniform vec4 origin;  // xyz where the map looks from, or, w 0, where it looks to
layout(location = 3) uniform vec4 texel;   // x: width of a texel at distance 1, or metres; yzw: axis
layout(location = 4) uniform ivec2 source; // lamp, or first patch and number of patches

// Below this cosine a texel's area is no longer that of one small patch; the
// flux (area times exitance) falls with the cosine from there on.
#define GRAZING 1e-3

void main()
{
	Surface s = material_surface(uv);
	vec3 n = normalize(normal) * (gl_FrontFacing ? 1.0 : -1.0);
	vec3 irradiance = vec3(0.0);
	vec3 to_origin = origin.w != 0.0 ? origin.xyz - position : -origin.xyz;
	float metres = length(to_origin);
	float lean = dot(n, to_origin) / metres;
	float area = texel.x * texel.x;

	// Perspective: the texel's solid angle is its area at distance 1 times the
	// cube of the cosine to the map's axis.
	if (origin.w != 0.0) {
		float c = -dot(to_origin, texel.yzw) / metres;

		area *= c * c * c * metres * metres;
	}
	area /= max(lean, GRAZING);

	// The back of a one-sided surface stops light and reflects none.
	if (lean > 0.0 && (gl_FrontFacing || s.two_sided)) {
#ifdef PATCHES
		mat3 frame_n = patch_frame(n);

		for (int i = source.x; i < source.x + source.y; i++) {
			Patch patch_ = patches[i];

			irradiance += patch_.radiance.rgb *
				      (PI * patch_form_factor(patch_, position, frame_n) *
				       medium_to_surface(distance(patch_.centre.xyz, position)));
		}
#else
		vec3 to_lamp;
		float distance_;

		irradiance = lamp_irradiance(lamps[source.x], position, to_lamp, distance_) *
			     max(dot(n, to_lamp), 0.0);
#endif
	}
	out_position_area = vec4(position, area);
	out_normal = vec4(n, 0.0);
	out_exitance = vec4(s.diffuse * irradiance, 0.0);
}
