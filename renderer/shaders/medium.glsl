// What holds for the whole frame (struct frame_block in renderer/view/blocks.h).
//
// The medium is homogeneous: sigma is the fraction that one metre takes out of
// a ray, so a path of d metres lets (1 - sigma)^d through: the continuous form
// of the lattice's 1 - (1 - sigma)^d per link.
layout(std140, binding = 1) uniform Frame {
	vec4 medium;     // x: log2(1 - absorption - scattering), y: log2(1 - absorption)
	vec4 bounds_min; // of the scene, metres
	vec4 bounds_max;
	vec4 background; // rgb radiance, W/(m^2 sr); a: 1 when only from above the horizon
} frame;

const float PI = 3.14159265358979;

// Light on its way to a surface: what is scattered away comes back as the
// lattice's light, not as this lamp's.
float medium_to_surface(float metres)
{
	return exp2(frame.medium.x * metres);
}

// From a surface to the eye. What is scattered out of the ray is taken to be
// made up for by what is scattered in, so only absorption is left.
float medium_to_eye(float metres)
{
	return exp2(frame.medium.y * metres);
}

// Metres from p along a unit direction to where the scene's bounds end.
float metres_to_bounds(vec3 p, vec3 direction)
{
	vec3 steps = mix(vec3(-1.0), vec3(1.0), greaterThanEqual(direction, vec3(0.0)));
	vec3 divisor = steps * max(abs(direction), vec3(1e-12));
	vec3 ahead = mix(frame.bounds_min.xyz, frame.bounds_max.xyz,
			 greaterThanEqual(direction, vec3(0.0)));
	vec3 t = (ahead - p) / divisor;

	return max(min(min(t.x, t.y), t.z), 0.0);
}
