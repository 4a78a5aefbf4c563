#version 450 core
// The HUD's boxes and cones, an instance each; room frame.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in mat4 room_part; // 2 to 5
layout(location = 6) in vec4 colour;
layout(location = 1) uniform mat4 clip_room;
layout(location = 0) out vec3 out_position;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec4 out_colour;

void main()
{
	vec4 p = room_part * vec4(position, 1.0);
	mat3 m = mat3(room_part);

	out_position = p.xyz;
	// the transposed inverse, up to a positive factor
	out_normal = mat3(cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])) * normal;
	out_colour = colour;
	gl_Position = clip_room * p;
}
