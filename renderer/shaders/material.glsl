// Materials of a mesh (renderer/gl/mesh.h): one std430 block at binding 0, the
// draw's index at uniform location 0, textures on units 0 and 1.
struct Material {
	vec4 diffuse;  // rgb reflectance 0..1
	vec4 specular; // rgb reflectance 0..1, a: shininess
	vec4 emission; // rgb radiance, W/(m^2 sr); a: 1 when the diffuse texture also colours the specular
	uvec4 flags;   // x: 1 two-sided
};

layout(std430, binding = 0) readonly buffer Materials {
	Material materials[];
};
layout(location = 0) uniform int material_index;
layout(binding = 0) uniform sampler2D diffuse_image;
layout(binding = 1) uniform sampler2D emission_image;

// What a surface point is made of, textures applied. diffuse + specular <= 1.
struct Surface {
	vec3 diffuse;
	vec3 specular;
	float shininess;
	vec3 emission; // W/(m^2 sr), of the front; two-sided materials emit on both sides
	bool two_sided;
};

Surface material_surface(vec2 uv)
{
	Material m = materials[material_index];
	vec3 tint = texture(diffuse_image, uv).rgb;
	Surface s;

	s.diffuse = m.diffuse.rgb * tint;
	s.specular = m.specular.rgb * mix(vec3(1.0), tint, m.emission.a);
	s.shininess = m.specular.a;
	s.emission = m.emission.rgb * texture(emission_image, uv).rgb;
	s.two_sided = m.flags.x != 0u;
	return s;
}
