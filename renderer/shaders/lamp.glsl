// Lamps without extent (struct lamp_record in renderer/view/blocks.h).
struct Lamp {
	vec4 position;  // scene, metres; w: radius of the source, metres
	vec4 direction; // unit, where the light goes; w: 0 spot, 1 point, 2 directional
	vec4 intensity; // rgb W/sr, directional W/m^2; 0 when off; a: least distance, metres
	vec4 cone;      // x: cos of the umbra's angle, y: cos of the penumbra's, z: 1/(y - x) or 0: hard
	ivec4 maps;     // x: first layer of lamp_layers, y: layers, 1 or 6
};

layout(std140, binding = 3) uniform Lamps {
	ivec4 lamp_count; // x
	Lamp lamps[16];
};

// Seed 004 section 3.3.4 (Direct3D's spotlight): 1 inside, 0 outside the cone.
float lamp_cone(Lamp lamp, vec3 to_lamp)
{
	float c = -dot(lamp.direction.xyz, to_lamp);

	if (lamp.direction.w != 0.0)
		return 1.0;
	if (lamp.cone.z == 0.0)
		return c > lamp.cone.x ? 1.0 : 0.0;
	return clamp((c - lamp.cone.x) * lamp.cone.z, 0.0, 1.0);
}

// The same as a mean over a piece of a plane with that normal, `half_m` metres to both
// sides along the way on which the angle changes most: its edge passes evenly.
float lamp_cone_over(Lamp lamp, vec3 n, vec3 to_lamp, float metres, float half_m)
{
	float c = -dot(lamp.direction.xyz, to_lamp);
	vec3 slope = lamp.direction.xyz + c * to_lamp; // of c, times the distance

	slope -= dot(slope, n) * n;
	// nearby a straight course does not hold: never over a quarter of the cone
	float reach = clamp(length(slope) * half_m / metres, 1e-4, max(0.25 * (1.0 - lamp.cone.x), 1e-4));
	// integral of lamp_cone up to both ends: none, a parabola, a straight line
	vec2 from = vec2(c + reach, c - reach) - lamp.cone.x;
	float width = lamp.cone.z == 0.0 ? 0.0 : lamp.cone.y - lamp.cone.x;
	vec2 edge = clamp(from, 0.0, width);
	vec2 sum = 0.5 * lamp.cone.z * edge * edge + max(from - width, 0.0);

	return lamp.direction.w != 0.0 || from.y >= width ? 1.0 : clamp((sum.x - sum.y) / (2.0 * reach), 0.0, 1.0);
}

// Irradiance on a plane through p that faces the lamp, W/m^2, nothing in
// between but the medium, and as if a spot had no cone. Out: unit vector to the
// lamp and the distance.
vec3 lamp_irradiance_uncut(Lamp lamp, vec3 p, out vec3 to_lamp, out float metres)
{
	if (lamp.direction.w == 2.0) {
		to_lamp = -lamp.direction.xyz;
		metres = metres_to_bounds(p, to_lamp);
		return lamp.intensity.rgb * medium_to_surface(metres);
	}
	vec3 d = lamp.position.xyz - p;

	// A surface inside the source gets what the source's own surface has.
	metres = max(length(d), lamp.intensity.a);
	to_lamp = d / metres;
	return lamp.intensity.rgb * (medium_to_surface(metres) / (metres * metres));
}

vec3 lamp_irradiance(Lamp lamp, vec3 p, out vec3 to_lamp, out float metres)
{
	vec3 e = lamp_irradiance_uncut(lamp, p, to_lamp, metres);

	return e * lamp_cone(lamp, to_lamp);
}
