#version 450 core
// Surfaces for the G-buffer and the reflective shadow maps.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 1) uniform mat4 clip_scene;
layout(location = 0) out vec3 out_position;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec2 out_uv;

void main()
{
	out_position = position;
	out_normal = normal;
	out_uv = uv;
	gl_Position = clip_scene * vec4(position, 1.0);
}
