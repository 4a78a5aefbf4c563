// The scene asks for no indirect light.
vec3 gi_irradiance(vec3 position, vec3 normal)
{
	return vec3(0.0);
}
