#include "renderer/scene/scene_block.h"

#include "base/cursor.h"
#include "base/result.h"
#include "renderer/scene/import.h"
#include "renderer/scene/isolate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK_MAGIC 0x4b4c4247u
#define BLOCK_MAX_LINES 100000
#define BLOCK_MAX_TEXT 4096
#define BLOCK_MAX_NAME 65536

struct block_head {
	uint32_t magic;
	int32_t result;
	uint64_t lines, vertices, indices, draws, materials, images;
	uint64_t dropped_nonfinite, dropped_degenerate, dropped_index;
	float min[3], max[3];
	uint32_t emissive;
	uint32_t zero;
};

struct block_line {
	uint32_t severity, len;
};

struct block_image {
	uint32_t width, height, srgb, name_len;
};

/* The bools of a material apart from it: any other byte than 0 and 1 is no bool. */
struct block_material {
	char name[64];
	float diffuse[3], specular[3], shininess, emission[3];
	int32_t diffuse_image, emission_image;
	uint32_t tinted_specular, two_sided;
};

static int write_lines(int fd, const struct gr_diag *diag)
{
	int result = GR_OK;

	for (size_t i = 0; i < diag->count && i < BLOCK_MAX_LINES && result == GR_OK; i++) {
		size_t len = strlen(diag->items[i].text);
		struct block_line line = {
			.severity = (uint32_t)diag->items[i].severity,
			.len = (uint32_t)(len < BLOCK_MAX_TEXT ? len : BLOCK_MAX_TEXT),
		};

		result = isolate_write(fd, &line, sizeof line);
		if (result == GR_OK)
			result = isolate_write(fd, diag->items[i].text, line.len);
	}
	return result;
}

static int write_materials(int fd, const struct scene *scene)
{
	int result = GR_OK;

	for (size_t i = 0; i < scene->material_count && result == GR_OK; i++) {
		const struct scene_material *from = &scene->materials[i];
		struct block_material to;

		memset(&to, 0, sizeof to);
		memcpy(to.name, from->name, sizeof to.name);
		memcpy(to.diffuse, from->diffuse, sizeof to.diffuse);
		memcpy(to.specular, from->specular, sizeof to.specular);
		memcpy(to.emission, from->emission, sizeof to.emission);
		to.shininess = from->shininess;
		to.diffuse_image = from->diffuse_image;
		to.emission_image = from->emission_image;
		to.tinted_specular = from->tinted_specular;
		to.two_sided = from->two_sided;
		result = isolate_write(fd, &to, sizeof to);
	}
	return result;
}

static int write_images(int fd, const struct scene *scene)
{
	int result = GR_OK;

	for (size_t i = 0; i < scene->image_count && result == GR_OK; i++) {
		const struct scene_image *image = &scene->images[i];
		size_t name_len = strlen(image->name);
		struct block_image head = {
			.width = (uint32_t)image->width,
			.height = (uint32_t)image->height,
			.srgb = image->srgb,
			.name_len = (uint32_t)(name_len < BLOCK_MAX_NAME ? name_len : BLOCK_MAX_NAME),
		};

		result = isolate_write(fd, &head, sizeof head);
		if (result == GR_OK)
			result = isolate_write(fd, image->name, head.name_len);
		if (result == GR_OK)
			result = isolate_write(fd, image->rgba,
					       (size_t)head.width * (size_t)head.height * 4);
	}
	return result;
}

int scene_block_write(int fd, int result, const struct scene *scene, const struct gr_diag *diag)
{
	struct block_head head = { .magic = BLOCK_MAGIC, .result = result };
	int wrote;

	head.lines = diag->count < BLOCK_MAX_LINES ? diag->count : BLOCK_MAX_LINES;
	if (result == GR_OK) {
		head.vertices = scene->vertex_count;
		head.indices = scene->index_count;
		head.draws = scene->draw_count;
		head.materials = scene->material_count;
		head.images = scene->image_count;
		head.dropped_nonfinite = scene->dropped_nonfinite;
		head.dropped_degenerate = scene->dropped_degenerate;
		head.dropped_index = scene->dropped_index;
		head.emissive = scene->emissive;
		memcpy(head.min, scene->min, sizeof head.min);
		memcpy(head.max, scene->max, sizeof head.max);
	}
	wrote = isolate_write(fd, &head, sizeof head);
	if (wrote == GR_OK)
		wrote = write_lines(fd, diag);
	if (wrote != GR_OK || result != GR_OK)
		return wrote;
	wrote = isolate_write(fd, scene->vertices, scene->vertex_count * sizeof scene->vertices[0]);
	if (wrote == GR_OK)
		wrote = isolate_write(fd, scene->indices, scene->index_count * sizeof scene->indices[0]);
	if (wrote == GR_OK)
		wrote = isolate_write(fd, scene->draws, scene->draw_count * sizeof scene->draws[0]);
	if (wrote == GR_OK)
		wrote = write_materials(fd, scene);
	return wrote == GR_OK ? write_images(fd, scene) : wrote;
}

static bool read_into(struct gr_reader *r, void *to, size_t len)
{
	const uint8_t *from = gr_read_bytes(r, len);

	if (from && len)
		memcpy(to, from, len);
	return from != NULL;
}

static int read_lines(struct gr_reader *r, const struct block_head *head, struct gr_diag *diag)
{
	for (uint64_t i = 0; i < head->lines; i++) {
		struct block_line line;
		const uint8_t *text;

		if (!read_into(r, &line, sizeof line) || line.severity > GR_DIAG_ERROR ||
		    line.len > BLOCK_MAX_TEXT)
			return GR_ERR_FORMAT;
		text = gr_read_bytes(r, line.len);
		if (!text)
			return GR_ERR_FORMAT;
		gr_diag_add(diag, (enum gr_severity)line.severity, NULL, 0, NULL, "%.*s",
			    (int)line.len, (const char *)text);
	}
	return GR_OK;
}

/* A copy of the next `count` items; GR_ERR_FORMAT when the block does not hold them. */
static int read_array(struct gr_reader *r, size_t count, size_t size, void **out)
{
	if (count > gr_reader_left(r) / size)
		return GR_ERR_FORMAT;
	*out = malloc(count * size);
	if (!*out)
		return GR_ERR_NOMEM;
	return read_into(r, *out, count * size) ? GR_OK : GR_ERR_FORMAT;
}

static bool finite_all(const float *values, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		if (!isfinite(values[i]))
			return false;
	}
	return true;
}

static bool geometry_fits(const struct scene *s)
{
	for (size_t i = 0; i < s->vertex_count; i++) {
		if (!finite_all(s->vertices[i].position, 3) || !finite_all(s->vertices[i].normal, 3) ||
		    !finite_all(s->vertices[i].uv, 2))
			return false;
	}
	for (size_t i = 0; i < s->index_count; i++) {
		if (s->indices[i] >= s->vertex_count)
			return false;
	}
	for (size_t i = 0; i < s->draw_count; i++) {
		const struct scene_draw *d = &s->draws[i];

		if (d->first_index % 3 || d->index_count % 3 || d->material >= s->material_count ||
		    (size_t)d->first_index + d->index_count > s->index_count)
			return false;
	}
	return finite_all(s->min, 3) && finite_all(s->max, 3);
}

static int read_geometry(struct gr_reader *r, const struct block_head *head, struct scene *s)
{
	void *vertices = NULL, *indices = NULL, *draws = NULL;
	int result;

	if (head->vertices < 1 || head->vertices > IMPORT_MAX_VERTICES || head->indices < 3 ||
	    head->indices > IMPORT_MAX_INDICES || head->indices % 3 || head->draws < 1 ||
	    head->draws > IMPORT_MAX_MATERIALS)
		return GR_ERR_FORMAT;
	result = read_array(r, head->vertices, sizeof s->vertices[0], &vertices);
	s->vertices = vertices;
	if (result == GR_OK)
		result = read_array(r, head->indices, sizeof s->indices[0], &indices);
	s->indices = indices;
	if (result == GR_OK)
		result = read_array(r, head->draws, sizeof s->draws[0], &draws);
	s->draws = draws;
	if (result != GR_OK)
		return result;
	s->vertex_count = head->vertices;
	s->index_count = head->indices;
	s->draw_count = head->draws;
	s->dropped_nonfinite = head->dropped_nonfinite;
	s->dropped_degenerate = head->dropped_degenerate;
	s->dropped_index = head->dropped_index;
	s->emissive = head->emissive != 0;
	memcpy(s->min, head->min, sizeof s->min);
	memcpy(s->max, head->max, sizeof s->max);
	return GR_OK;
}

static bool read_material(struct gr_reader *r, const struct block_head *head,
			  struct scene_material *to)
{
	struct block_material from;
	int64_t images = (int64_t)head->images;

	if (!read_into(r, &from, sizeof from) || !memchr(from.name, 0, sizeof from.name) ||
	    from.tinted_specular > 1 || from.two_sided > 1 || from.diffuse_image < -1 ||
	    from.diffuse_image >= images || from.emission_image < -1 ||
	    from.emission_image >= images || !finite_all(from.diffuse, 3) ||
	    !finite_all(from.specular, 3) || !finite_all(from.emission, 3) ||
	    !isfinite(from.shininess))
		return false;
	memcpy(to->name, from.name, sizeof to->name);
	memcpy(to->diffuse, from.diffuse, sizeof to->diffuse);
	memcpy(to->specular, from.specular, sizeof to->specular);
	memcpy(to->emission, from.emission, sizeof to->emission);
	to->shininess = from.shininess;
	to->diffuse_image = from.diffuse_image;
	to->emission_image = from.emission_image;
	to->tinted_specular = from.tinted_specular;
	to->two_sided = from.two_sided;
	return true;
}

static int read_materials(struct gr_reader *r, const struct block_head *head, struct scene *s)
{
	if (head->materials < 1 || head->materials > IMPORT_MAX_MATERIALS ||
	    head->images > IMPORT_MAX_IMAGES)
		return GR_ERR_FORMAT;
	s->materials = calloc(head->materials, sizeof s->materials[0]);
	if (!s->materials)
		return GR_ERR_NOMEM;
	s->material_count = head->materials;
	for (size_t i = 0; i < s->material_count; i++) {
		if (!read_material(r, head, &s->materials[i]))
			return GR_ERR_FORMAT;
	}
	return GR_OK;
}

static int read_image(struct gr_reader *r, struct scene_image *image)
{
	struct block_image head;
	void *rgba = NULL;
	const uint8_t *name;
	int result;

	if (!read_into(r, &head, sizeof head) || head.width < 1 ||
	    head.width > IMPORT_MAX_IMAGE_SIDE || head.height < 1 ||
	    head.height > IMPORT_MAX_IMAGE_SIDE || head.srgb > 1 || head.name_len > BLOCK_MAX_NAME)
		return GR_ERR_FORMAT;
	name = gr_read_bytes(r, head.name_len);
	if (!name)
		return GR_ERR_FORMAT;
	image->name = strndup((const char *)name, head.name_len);
	if (!image->name)
		return GR_ERR_NOMEM;
	image->width = (int)head.width;
	image->height = (int)head.height;
	image->srgb = head.srgb;
	result = read_array(r, (size_t)head.width * (size_t)head.height, 4, &rgba);
	image->rgba = rgba;
	return result;
}

static int read_scene(struct gr_reader *r, const struct block_head *head, struct scene *s)
{
	int result = read_geometry(r, head, s);

	if (result == GR_OK)
		result = read_materials(r, head, s);
	if (result == GR_OK && head->images) {
		s->images = calloc(head->images, sizeof s->images[0]);
		if (!s->images)
			return GR_ERR_NOMEM;
	}
	for (uint64_t i = 0; result == GR_OK && i < head->images; i++) {
		s->image_count++; /* before, so that half an image is freed, too */
		result = read_image(r, &s->images[i]);
	}
	if (result == GR_OK && (!gr_reader_done(r) || !geometry_fits(s)))
		result = GR_ERR_FORMAT;
	return result;
}

int scene_block_read(const uint8_t *bytes, size_t len, struct scene **out, struct gr_diag *diag)
{
	struct gr_reader r = gr_reader(bytes, len);
	struct block_head head;
	int result;

	*out = NULL;
	if (!read_into(&r, &head, sizeof head) || head.magic != BLOCK_MAGIC ||
	    head.lines > BLOCK_MAX_LINES || head.emissive > 1 || head.result > GR_OK)
		return GR_ERR_FORMAT;
	result = read_lines(&r, &head, diag);
	if (result != GR_OK)
		return result;
	if (head.result != GR_OK)
		return gr_reader_done(&r) ? head.result : GR_ERR_FORMAT;
	*out = calloc(1, sizeof **out);
	if (!*out)
		return GR_ERR_NOMEM;
	result = read_scene(&r, &head, *out);
	if (result != GR_OK)
		scene_destroy(out);
	return result;
}
