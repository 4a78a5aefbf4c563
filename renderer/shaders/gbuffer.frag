#version 450 core
// check: #define EMISSIVE
#include "material.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 0) out vec4 out_position; // a: shininess, -1 where nothing is
layout(location = 1) out vec4 out_normal;   // unit, towards the eye's side of the surface
layout(location = 2) out vec4 out_diffuse;
layout(location = 3) out vec4 out_specular;
#ifdef EMISSIVE
layout(location = 4) out vec4 out_emission;
#endif

void main()
{
	Surface s = material_surface(uv);

	out_position = vec4(position, s.shininess);
	out_normal = vec4(normalize(normal) * (gl_FrontFacing ? 1.0 : -1.0), 0.0);
	out_diffuse = vec4(s.diffuse, 1.0);
	out_specular = vec4(s.specular, 1.0);
#ifdef EMISSIVE
	// the back of a one-sided surface is not drawn
	out_emission = vec4(s.emission, 1.0);
#endif
}
