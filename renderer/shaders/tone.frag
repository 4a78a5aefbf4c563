#version 450 core
// Radiance to what the display takes: exposure, curve (seed 004, equation 3.3),
// encoding. What is not finite is counted and painted magenta, never hidden.
layout(binding = 0) uniform sampler2D radiance_image;
layout(std430, binding = 7) buffer Counters {
	uint nonfinite; // since the start
};
layout(location = 1) uniform ivec2 corner; // of the picture in the target
layout(location = 2) uniform vec4 tone;    // x: exposure, y: encoding gamma, z: 1 Reinhard, w: 1 sRGB
layout(location = 0) out vec4 out_colour;

void main()
{
	vec3 radiance = texelFetch(radiance_image, ivec2(gl_FragCoord.xy) - corner, 0).rgb;
	// isnan() may be compiled away, the bits may not
	uvec3 exponent = floatBitsToUint(radiance) & 0x7f800000u;

	if (any(equal(exponent, uvec3(0x7f800000u)))) {
		atomicAdd(nonfinite, 1u);
		out_colour = vec4(1.0, 0.0, 1.0, 1.0);
		return;
	}
	vec3 l = max(radiance * tone.x, 0.0);

	if (tone.z != 0.0)
		l = l / (1.0 + l);
	l = min(l, 1.0);
	if (tone.w != 0.0)
		l = mix(1.055 * pow(l, vec3(1.0 / 2.4)) - 0.055, 12.92 * l,
			lessThanEqual(l, vec3(0.0031308)));
	else
		l = mix(pow(l, vec3(tone.y)), vec3(0.0), equal(l, vec3(0.0)));
	out_colour = vec4(l, 1.0);
}
