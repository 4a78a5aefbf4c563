#version 450 core
layout(location = 0) in vec3 position;
layout(location = 1) uniform mat4 clip_scene;

void main()
{
	gl_Position = clip_scene * vec4(position, 1.0);
}
