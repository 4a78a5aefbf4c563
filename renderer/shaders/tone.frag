#version 450 core
// Radiance to what the display takes: exposure, curve (renderer/tone/curve.h),
// encoding. What is not finite is counted and painted magenta, never hidden.
layout(binding = 0) uniform sampler2D radiance_image;
layout(std430, binding = 7) buffer Counters {
	uint nonfinite; // since the start
};
layout(location = 1) uniform ivec2 corner; // of the picture in the target
layout(location = 2) uniform vec4 tone;    // x: exposure, y: encoding gamma, z: 1 sRGB
layout(location = 3) uniform uint curve;   // enum scene_curve
layout(location = 4) uniform vec4 a;       // struct tone_factors
layout(location = 5) uniform vec4 b;
layout(location = 6) uniform vec2 device;  // x: last entry of the projector's map or 0, y: a step to dither or 0
layout(binding = 1) uniform sampler1D projector_map; // from what is encoded to what this projector takes
layout(location = 0) out vec4 out_colour;

const uint REINHARD = 1u;
const uint DRAGO = 2u;
const uint PATTANAIK = 3u;
const float EXPONENT = 0.73;
const float DISPLAY_MOST = 1e4; // of its white, curve.c

// log(1 + x) / x, also where 1 + x is 1.
float log1p_slope(float x)
{
	return x < 0.02 ? 1.0 - x * (0.5 - x * (1.0 / 3.0 - 0.25 * x)) : log(1.0 + x) / x;
}

float drago(float grey)
{
	// white is white: the curve falls beyond the maximum
	float within = min(1.0, 1.0 / max(grey * a.y, 1e-30));

	return within * log1p_slope(within * grey * a.x) * a.x * a.w /
	       log(2.0 + 8.0 * pow(within * grey * a.y, a.z));
}

vec3 pattanaik(vec3 l, float grey)
{
	float most = 1.0 / (1.0 + pow(b.w / DISPLAY_MOST, EXPONENT));
	float x = pow(grey, EXPONENT);
	// responses over x, so that their shares are there in the dark, too
	vec2 cone_rod = a.zw * a.xy / (1.0 + x * a.xy);
	float both = cone_rod.x + cone_rod.y;
	float saturation = max(b.z * cone_rod.x * x / (1.0 + x * a.x), 1e-6);
	float seen = clamp(both * x * b.x + b.y, 0.0, most);
	float shown = b.w * pow(seen / (1.0 - seen), 1.0 / EXPONENT);
	vec3 colour = grey > 0.0 ? pow(l / grey, vec3(saturation)) : vec3(1.0);

	return shown * mix(vec3(1.0), colour, cone_rod.x / both);
}

vec3 curved(vec3 l)
{
	float grey = dot(l, vec3(0.2126, 0.7152, 0.0722));

	switch (curve) {
	case REINHARD:
		return l / (1.0 + l);
	case DRAGO:
		return l * drago(grey);
	case PATTANAIK:
		return pattanaik(l, grey);
	default:
		return l;
	}
}

// Not by the sampler: its weights have 8 bits.
vec3 projected(vec3 l)
{
	vec3 at = l * device.x;
	ivec3 low = ivec3(min(at, device.x - 1.0));
	vec3 from = vec3(texelFetch(projector_map, low.r, 0).r, texelFetch(projector_map, low.g, 0).g,
			 texelFetch(projector_map, low.b, 0).b);
	vec3 to = vec3(texelFetch(projector_map, low.r + 1, 0).r,
		       texelFetch(projector_map, low.g + 1, 0).g,
		       texelFetch(projector_map, low.b + 1, 0).b);

	return mix(from, to, at - vec3(low));
}

// Even between -1/2 and 1/2 over any few pixels: interleaved gradient noise,
// Jimenez 2014, "Next Generation Post Processing in Call of Duty".
float dithering()
{
	return fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) - 0.5;
}

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
	vec3 l = min(curved(max(radiance * tone.x, 0.0)), 1.0);

	if (tone.z != 0.0)
		l = mix(1.055 * pow(l, vec3(1.0 / 2.4)) - 0.055, 12.92 * l,
			lessThanEqual(l, vec3(0.0031308)));
	else
		l = mix(pow(l, vec3(tone.y)), vec3(0.0), equal(l, vec3(0.0)));
	if (device.x > 0.0)
		l = projected(l);
	out_colour = vec4(l + device.y * dithering(), 1.0);
}
