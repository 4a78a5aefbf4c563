#version 450 core
// The HUD in the display's own values. Lit from the eye, so that shapes are
// seen; faint where the scene is nearer than it.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 colour;
layout(binding = 0) uniform sampler2D scene_position; // a < 0: nothing is there
layout(location = 2) uniform vec3 eye_room;
layout(location = 3) uniform vec3 eye_scene;
layout(location = 4) uniform ivec2 corner; // of the picture in the target
layout(location = 0) out vec4 out_colour;

const float FAINT = 0.3;
const float SLACK = 0.002; // metres: a HUD that lies on a surface does not flicker

void main()
{
	vec3 to_eye = eye_room - position;
	vec4 scene = texelFetch(scene_position, ivec2(gl_FragCoord.xy) - corner, 0);
	bool hidden = scene.a >= 0.0 && distance(scene.xyz, eye_scene) + SLACK < length(to_eye);
	float facing = abs(dot(normalize(normal), normalize(to_eye)));

	out_colour = vec4(colour.rgb * (0.55 + 0.45 * facing), colour.a * (hidden ? FAINT : 1.0));
}
