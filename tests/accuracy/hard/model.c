#include "tests/accuracy/hard/model.h"

#include "tests/unit/glb.h"
#include "tests/unit/unit.h"

#include <math.h>

int model_material(struct model *model, const char *name, float r, float g, float b)
{
	assert_true(model->material_count < MODEL_MATERIALS);
	model->materials[model->material_count] =
		(struct model_material){ .name = name, .color = { r, g, b } };
	return (int)model->material_count++;
}

void model_triangle(struct model *model, int material, const float a[3], const float b[3],
		    const float c[3])
{
	struct model_triangle *t = &model->triangles[model->count++];

	assert_true(model->count <= MODEL_TRIANGLES);
	memcpy(t->at[0], a, sizeof t->at[0]);
	memcpy(t->at[1], b, sizeof t->at[1]);
	memcpy(t->at[2], c, sizeof t->at[2]);
	t->material = material;
}

void model_quad(struct model *model, int material, const float corner[3], const float u[3],
		const float v[3])
{
	float at[3][3];

	for (int i = 0; i < 3; i++) {
		at[0][i] = corner[i] + u[i];
		at[1][i] = corner[i] + u[i] + v[i];
		at[2][i] = corner[i] + v[i];
	}
	model_triangle(model, material, corner, at[0], at[1]);
	model_triangle(model, material, corner, at[1], at[2]);
}

void model_box(struct model *model, int material, const float low[3], const float high[3],
	       bool inside)
{
	for (int axis = 0; axis < 3; axis++) {
		int first = (axis + 1) % 3, second = (axis + 2) % 3;
		float u[3] = { 0 }, v[3] = { 0 }, corner[3];

		u[first] = high[first] - low[first];
		v[second] = high[second] - low[second];
		memcpy(corner, low, sizeof corner);
		/* u x v points along +axis: the low side looks in, the high side out */
		model_quad(model, material, corner, inside ? u : v, inside ? v : u);
		corner[axis] = high[axis];
		model_quad(model, material, corner, inside ? v : u, inside ? u : v);
	}
}

static size_t write_materials(const struct model *model, char *json, size_t size)
{
	size_t len = 0, images = 0;

	for (size_t m = 0; m < model->material_count; m++) {
		const struct model_material *one = &model->materials[m];
		float strength = fmaxf(fmaxf(one->emission[0], one->emission[1]), one->emission[2]);
		char texture[64] = "";

		if (one->texture)
			snprintf(texture, sizeof texture, ",\"baseColorTexture\":{\"index\":%zu}", images++);
		len += (size_t)snprintf(
			json + len, size - len,
			"%s{\"name\":\"%s\",\"doubleSided\":%s,\"pbrMetallicRoughness\":{\"baseColorFactor\":"
			"[%.9g,%.9g,%.9g,1],\"metallicFactor\":0%s}",
			m ? "," : "", one->name, one->two_sided ? "true" : "false", (double)one->color[0],
			(double)one->color[1], (double)one->color[2], texture);
		if (strength > 0)
			len += (size_t)snprintf(
				json + len, size - len,
				",\"emissiveFactor\":[%.9g,%.9g,%.9g],\"extensions\":{"
				"\"KHR_materials_emissive_strength\":{\"emissiveStrength\":%.9g}}",
				(double)(one->emission[0] / strength), (double)(one->emission[1] / strength),
				(double)(one->emission[2] / strength), (double)strength);
		len += (size_t)snprintf(json + len, size - len, "}");
	}
	len += (size_t)snprintf(json + len, size - len, "]");
	for (int list = 0; list < 2 && images > 0; list++) {
		size_t image = 0;

		len += (size_t)snprintf(json + len, size - len, list ? ",\"images\":[" : ",\"textures\":[");
		for (size_t m = 0; m < model->material_count; m++) {
			if (!model->materials[m].texture)
				continue;
			len += list ? (size_t)snprintf(json + len, size - len, "%s{\"uri\":\"%s\"}",
						       image ? "," : "", model->materials[m].texture)
				    : (size_t)snprintf(json + len, size - len, "%s{\"source\":%zu}",
						       image ? "," : "", image);
			image++;
		}
		len += (size_t)snprintf(json + len, size - len, "]");
	}
	return len;
}

void model_write(const struct model *model, const char *path)
{
	static char json[16384], views[4096], accessors[4096], primitives[4096];
	static float places[MODEL_TRIANGLES][3][3];
	size_t views_len = 0, accessors_len = 0, primitives_len = 0, len, written = 0, used = 0;
	uint8_t *bytes;
	FILE *file;

	for (size_t m = 0; m < model->material_count; m++) {
		size_t first = written;

		for (size_t t = 0; t < model->count; t++)
			if (model->triangles[t].material == (int)m)
				memcpy(places[written++], model->triangles[t].at, sizeof places[0]);
		if (written == first)
			continue;
		views_len += (size_t)snprintf(views + views_len, sizeof views - views_len,
					      "%s{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu}",
					      used ? "," : "", first * sizeof places[0],
					      (written - first) * sizeof places[0]);
		accessors_len += (size_t)snprintf(
			accessors + accessors_len, sizeof accessors - accessors_len,
			"%s{\"bufferView\":%zu,\"componentType\":5126,\"count\":%zu,\"type\":\"VEC3\","
			"\"min\":[0,0,0],\"max\":[1,1,1]}",
			used ? "," : "", used, 3 * (written - first));
		primitives_len += (size_t)snprintf(
			primitives + primitives_len, sizeof primitives - primitives_len,
			"%s{\"attributes\":{\"POSITION\":%zu},\"material\":%zu}", used ? "," : "", used, m);
		used++;
	}
	len = (size_t)snprintf(json, sizeof json,
			       "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
			       "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[%s]}],"
			       "\"accessors\":[%s],\"bufferViews\":[%s],\"buffers\":[{\"byteLength\":%zu}],"
			       "\"materials\":[",
			       primitives, accessors, views, written * sizeof places[0]);
	len += write_materials(model, json + len, sizeof json - len);
	assert_true(len + 1 < sizeof json);
	json[len++] = '}';
	json[len] = '\0';
	bytes = glb_pack(json, places, written * sizeof places[0], &len);
	file = fopen(path, "wb");
	assert_non_null(file);
	assert_int_equal(fwrite(bytes, 1, len, file), len);
	assert_int_equal(fclose(file), 0);
	free(bytes);
}
