#version 450 core
// One step of seed 004's own propagation (section 3.3.2, after its listing
// 5.3): a gather over the 26 neighbours, one image per band, coefficients of
// two SH bands in the order (1, -y, z, -x). Written out plainly on purpose: it is what
// the product's kernel is measured against.
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(rgba32f, binding = 0) uniform readonly image3D source_red;
layout(rgba32f, binding = 1) uniform readonly image3D source_green;
layout(rgba32f, binding = 2) uniform readonly image3D source_blue;
layout(rgba32f, binding = 3) uniform writeonly image3D target_red;
layout(rgba32f, binding = 4) uniform writeonly image3D target_green;
layout(rgba32f, binding = 5) uniform writeonly image3D target_blue;
layout(rgba32f, binding = 6) uniform readonly image3D blockers;

layout(std140, binding = 9) uniform ThesisBlock {
	vec4 transfer[26];
	ivec4 neighbour[26]; // xyz offset
	vec4 fraction[26];   // x: share of what is scattered
} table;

layout(location = 0) uniform float kept;      // 1 - lambda_t
layout(location = 1) uniform float scattered; // lambda_s * 2 sqrt(pi)

void main()
{
	ivec3 cell = ivec3(gl_GlobalInvocationID);
	vec4 sum_red = vec4(0.0), sum_green = vec4(0.0), sum_blue = vec4(0.0);

	for (int j = 0; j < 26; j++) {
		ivec3 from = cell - table.neighbour[j].xyz;
		vec4 red = imageLoad(source_red, from);
		vec4 green = imageLoad(source_green, from);
		vec4 blue = imageLoad(source_blue, from);
		vec4 blocker = imageLoad(blockers, from);
		vec4 gamma = table.transfer[j];
		vec3 flux = kept * vec3(dot(red, gamma), dot(green, gamma), dot(blue, gamma));

		flux += scattered * table.fraction[j].x * vec3(red.x, green.x, blue.x);
		flux *= clamp(1.0 - dot(blocker, gamma), 0.0, 1.0);
		flux = max(flux, vec3(0.0));
		sum_red += gamma * flux.r;
		sum_green += gamma * flux.g;
		sum_blue += gamma * flux.b;
	}
	imageStore(target_red, cell, sum_red);
	imageStore(target_green, cell, sum_green);
	imageStore(target_blue, cell, sum_blue);
}
