#version 450 core
// Radiance of one eye's picture from its G-buffer. Only what the scene has is
// compiled in: LAMPS, EMISSIVE, GI; KEEP_INDIRECT writes that part apart.
// check: #define LAMPS
// check: #define EMISSIVE
// check: #define KEEP_INDIRECT
// check: #define BACKDROP
// check: #define BACKDROP_IMAGE
// check: #define GI_SHADER "gi_none.glsl"
#include "medium.glsl"
#ifdef LAMPS
#include "lamp.glsl"
#endif
#ifdef EMISSIVE
#include "patch.glsl"
#endif
#include "shadow.glsl"
#ifdef LAMPS
#include "lamp_shadow.glsl"
#endif
#ifdef EMISSIVE
#include "patch_shadow.glsl"
#endif
#include GI_SHADER
#ifdef BACKDROP
#include "backdrop.glsl"
#endif

layout(binding = 0) uniform sampler2D position_image;
layout(binding = 1) uniform sampler2D normal_image;
layout(binding = 2) uniform sampler2D diffuse_image;
layout(binding = 3) uniform sampler2D specular_image;
#ifdef EMISSIVE
layout(binding = 4) uniform sampler2D emission_image;
#endif
layout(location = 1) uniform vec3 eye; // scene
layout(location = 2) uniform int indirect_on;
layout(location = 0) out vec4 out_radiance;
#ifdef KEEP_INDIRECT
layout(location = 1) out vec4 out_indirect;
#endif

struct Point {
	vec3 position, normal, to_eye;
	vec3 diffuse, specular;
	float shininess;
};

// Normalised Blinn-Phong over Lambert (seed 004, equation 3.2).
vec3 reflectance(Point p, vec3 to_lamp)
{
	vec3 h = normalize(to_lamp + p.to_eye);
	float c = max(dot(p.normal, h), 1e-6);

	return p.diffuse / PI +
	       p.specular * ((p.shininess + 8.0) / (8.0 * PI) * exp2(p.shininess * log2(c)));
}

#ifdef LAMPS
vec3 from_lamps(Point p)
{
	vec3 sum = vec3(0.0);

	for (int i = 0; i < lamp_count.x; i++) {
		Lamp lamp = lamps[i];
		vec3 to_lamp;
		float metres;
		vec3 e = lamp_irradiance(lamp, p.position, to_lamp, metres);
		float c = dot(p.normal, to_lamp);

		bool reaches = c > 0.0 && e != vec3(0.0);

		float visible = lamp_visibility(lamp, p.position, p.normal, to_lamp, metres,
						reaches);

		sum += reaches ? reflectance(p, to_lamp) * e * (c * visible) : vec3(0.0);
	}
	return sum;
}
#endif

#ifdef EMISSIVE
vec3 from_patches(Point p)
{
	vec3 sum = vec3(0.0);
	mat3 frame_n = patch_frame(p.normal);

	for (uint left = patches_that_shine(p.position, p.normal); left != 0u; left &= left - 1u) {
		Patch patch_ = patches[findLSB(left)];
		float f = patch_form_factor(patch_, p.position, frame_n);
		vec3 to_patch = patch_.centre.xyz - p.position;
		float metres = length(to_patch);

		to_patch /= metres;
		float visible = patch_visibility(patch_, p.position, p.normal);

		sum += f > 0.0 ? reflectance(p, to_patch) * patch_.radiance.rgb *
					 (PI * f * medium_to_surface(metres) * visible)
			       : vec3(0.0);
	}
	return sum;
}
#endif

void main()
{
	ivec2 at = ivec2(gl_FragCoord.xy);
	vec4 position = texelFetch(position_image, at, 0);
	vec3 indirect = vec3(0.0);
	vec3 radiance = vec3(0.0);

	if (position.a >= 0.0) {
		Point p;
		vec3 to_eye = eye - position.xyz;
		float seen_from = length(to_eye);
		float thinned = medium_to_eye(seen_from);

		p.position = position.xyz;
		p.shininess = position.a;
		p.normal = normalize(texelFetch(normal_image, at, 0).xyz);
		p.to_eye = to_eye / seen_from;
		p.diffuse = texelFetch(diffuse_image, at, 0).rgb;
		p.specular = texelFetch(specular_image, at, 0).rgb;
		if (indirect_on != 0)
			indirect = p.diffuse / PI * gi_irradiance(p.position, p.normal) * thinned;
#ifdef LAMPS
		radiance += from_lamps(p);
#endif
#ifdef EMISSIVE
		radiance += from_patches(p) + texelFetch(emission_image, at, 0).rgb;
#endif
		radiance = radiance * thinned + indirect;
	} else {
#ifdef BACKDROP
		radiance = backdrop_radiance(2.0 * gl_FragCoord.xy / vec2(textureSize(position_image, 0)) -
					     1.0);
#else
		radiance = frame.background.rgb;
#endif
	}
	out_radiance = vec4(radiance, 1.0);
#ifdef KEEP_INDIRECT
	out_indirect = vec4(indirect, 1.0);
#endif
}
