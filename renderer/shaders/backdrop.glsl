// What is seen where no surface is, by direction (renderer/view/backdrop.h).
// With BACKDROP_IMAGE a latitude-longitude picture: renderer/scene/environment.h.
layout(location = 3) uniform mat4 backdrop_rays; // clip space to directions from the eye
#ifdef BACKDROP_IMAGE
layout(location = 4) uniform float backdrop_heading;
layout(binding = 15) uniform sampler2D backdrop_image;
#endif

// clip: of the pixel, x and y -1..1
vec3 backdrop_radiance(vec2 clip)
{
	// A point of the far plane; its distance does not matter.
	vec4 far = backdrop_rays * vec4(clip, 1.0, 1.0);
	vec3 d = normalize(far.xyz / far.w);

	if (frame.background.a > 0.0 && d.y <= 0.0)
		return vec3(0.0);
#ifdef BACKDROP_IMAGE
	float u = (atan(d.z, d.x) + backdrop_heading) / (2.0 * PI) + 0.5;
	float v = acos(clamp(d.y, -1.0, 1.0)) / PI;

	return textureLod(backdrop_image, vec2(u, v), 0.0).rgb;
#else
	return frame.background.rgb;
#endif
}
