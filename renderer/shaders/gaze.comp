#version 450 core
// Luminance of a wall in cells, and of those in the cone of the gaze the sum of
// their logarithms by solid angle; a sum for each work group (renderer/tone/gaze.h).
layout(local_size_x = 16, local_size_y = 16) in;

layout(binding = 0) uniform sampler2D radiance_image;
struct Sum {
	float log_sum, solid_angle, most;
	uint nonfinite;
};
layout(std430, binding = 8) writeonly buffer Sums {
	Sum sums[];
};
layout(location = 0) uniform ivec2 cells;
layout(location = 1) uniform vec3 corner; // lower left of the wall, from the eye, metres
layout(location = 2) uniform vec3 right;  // along its lower side, whole
layout(location = 3) uniform vec3 up;     // along its left side, whole
layout(location = 4) uniform vec4 gaze;   // direction, unit; cosine of half the cone
layout(location = 5) uniform vec3 level;  // to cd/m2; least and most that is told apart

const int GROUP = 256;
shared float log_sums[GROUP], solid_angles[GROUP], mosts[GROUP];
shared uint nonfinites[GROUP];

// Mean luminance of the cell's pixels and its brightest, cd/m2; x < 0: it has none.
vec2 cell_light(ivec2 cell, out uint nonfinite)
{
	ivec2 size = textureSize(radiance_image, 0);
	ivec2 first = cell * size / cells, end = (cell + 1) * size / cells;
	float sum = 0.0, most = 0.0;
	int count = 0;

	nonfinite = 0u;
	for (int y = first.y; y < end.y; y++)
		for (int x = first.x; x < end.x; x++) {
			vec3 radiance = texelFetch(radiance_image, ivec2(x, y), 0).rgb;
			uvec3 exponent = floatBitsToUint(radiance) & 0x7f800000u;
			float l;

			// isnan() may be compiled away, the bits may not
			if (any(equal(exponent, uvec3(0x7f800000u)))) {
				nonfinite++;
				continue;
			}
			// before the sum: what is far too bright does not make it infinite
			l = min(level.x * dot(max(radiance, 0.0), vec3(0.2126, 0.7152, 0.0722)), level.z);
			sum += l;
			most = max(most, l);
			count++;
		}
	return count > 0 ? vec2(sum / float(count), most) : vec2(-1.0, 0.0);
}

void main()
{
	uint self = gl_LocalInvocationIndex;
	ivec2 cell = ivec2(gl_GlobalInvocationID.xy);
	float log_sum = 0.0, solid_angle = 0.0, most = 0.0;
	uint nonfinite = 0u;

	if (all(lessThan(cell, cells))) {
		vec2 light = cell_light(cell, nonfinite);
		vec2 at = (vec2(cell) + 0.5) / vec2(cells);
		vec3 to = corner + at.x * right + at.y * up, area = cross(right, up);
		float distance2 = dot(to, to);

		most = light.y;
		if (light.x >= 0.0 && dot(to, gaze.xyz) >= gaze.w * sqrt(distance2)) {
			solid_angle = abs(dot(area, to)) /
				      (distance2 * sqrt(distance2) * float(cells.x * cells.y));
			log_sum = solid_angle * log(clamp(light.x, level.y, level.z));
		}
	}
	log_sums[self] = log_sum;
	solid_angles[self] = solid_angle;
	mosts[self] = most;
	nonfinites[self] = nonfinite;
	for (int half_count = GROUP / 2; half_count > 0; half_count /= 2) {
		barrier();
		if (self < uint(half_count)) {
			uint other = self + uint(half_count);

			log_sums[self] += log_sums[other];
			solid_angles[self] += solid_angles[other];
			mosts[self] = max(mosts[self], mosts[other]);
			nonfinites[self] += nonfinites[other];
		}
	}
	if (self == 0u)
		sums[gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x] =
			Sum(log_sums[0], solid_angles[0], mosts[0], nonfinites[0]);
}
