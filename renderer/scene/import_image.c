/* Finds the image that a material names: inside the model or beside it. */
#include "config.h" /* asprintf */

#include "renderer/scene/import.h"

#include "base/result.h"
#include "renderer/image/read_file.h"

#include <assimp/texture.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int hex_digit(char c)
{
	if (c >= '0' && c <= '9')
		return c - '0';
	if (c >= 'a' && c <= 'f')
		return c - 'a' + 10;
	if (c >= 'A' && c <= 'F')
		return c - 'A' + 10;
	return -1;
}

/* A URI's %20, and the backslashes of other systems' OBJ files. */
static void plain_name(char *name)
{
	char *to = name;

	for (const char *from = name; *from; from++) {
		if (from[0] == '%' && hex_digit(from[1]) >= 0 && hex_digit(from[2]) >= 0) {
			*to++ = (char)(hex_digit(from[1]) * 16 + hex_digit(from[2]));
			from += 2;
		} else {
			*to++ = *from == '\\' ? '/' : *from;
		}
	}
	*to = '\0';
}

char *import_beside(const char *model, const char *name)
{
	const char *slash = strrchr(model, '/');
	int folder = slash && name[0] != '/' ? (int)(slash - model) + 1 : 0;
	char *plain = strdup(name), *path = NULL;

	if (!plain)
		return NULL;
	plain_name(plain);
	if (asprintf(&path, "%.*s%s", folder, model, plain) < 0)
		path = NULL;
	free(plain);
	return path;
}

static int decode_embedded(struct import *import, const struct aiTexture *texture,
			   const char *name, struct scene_image *image)
{
	size_t count;

	if (texture->mHeight == 0)
		return texture_decode((const uint8_t *)texture->pcData, texture->mWidth, name, image,
				      import->diag, import->path);
	if (texture->mWidth < 1 || texture->mWidth > IMPORT_MAX_IMAGE_SIDE ||
	    texture->mHeight > IMPORT_MAX_IMAGE_SIDE) {
		gr_diag_add(import->diag, GR_DIAG_ERROR, import->path, 0, name,
			    "%u x %u pixels; 1 to %d a side are accepted", texture->mWidth,
			    texture->mHeight, IMPORT_MAX_IMAGE_SIDE);
		return GR_ERR_CONFIG;
	}
	image->width = (int)texture->mWidth;
	image->height = (int)texture->mHeight;
	count = (size_t)texture->mWidth * texture->mHeight;
	image->rgba = malloc(count * 4);
	if (!image->rgba)
		return GR_ERR_NOMEM;
	for (size_t i = 0; i < count; i++) {
		image->rgba[4 * i + 0] = texture->pcData[i].r;
		image->rgba[4 * i + 1] = texture->pcData[i].g;
		image->rgba[4 * i + 2] = texture->pcData[i].b;
		image->rgba[4 * i + 3] = texture->pcData[i].a;
	}
	return GR_OK;
}

static int decode_external(struct import *import, const char *name, struct scene_image *image)
{
	char *path = import_beside(import->path, name);
	uint8_t *bytes;
	size_t len;
	int result;

	if (!path)
		return GR_ERR_NOMEM;
	result = read_file(path, IMPORT_MAX_FILE, &bytes, &len, import->diag, "texture");
	if (result == GR_OK) {
		result = texture_decode(bytes, len, "texture", image, import->diag, path);
		free(bytes);
	}
	free(path);
	return result;
}

static const struct aiTexture *embedded(const struct import *import, const char *name)
{
	const struct aiScene *from = import->from;

	if (name[0] == '*') {
		char *end;
		unsigned long index = strtoul(name + 1, &end, 10);

		return *end == '\0' && index < from->mNumTextures ? from->mTextures[index] : NULL;
	}
	/* FBX keeps the file's name although the bytes are inside. */
	for (unsigned i = 0; i < from->mNumTextures; i++) {
		if (from->mTextures[i]->mFilename.length &&
		    strcmp(from->mTextures[i]->mFilename.data, name) == 0)
			return from->mTextures[i];
	}
	return NULL;
}

static int find_image(const struct scene *scene, const char *name, bool srgb)
{
	for (size_t i = 0; i < scene->image_count; i++) {
		if (scene->images[i].srgb == srgb && strcmp(scene->images[i].name, name) == 0)
			return (int)i;
	}
	return -1;
}

static int keep_image(struct import *import, struct scene_image *image)
{
	struct scene *scene = import->scene;
	size_t bytes = (size_t)image->width * (size_t)image->height * 4;
	struct scene_image *images;

	if (scene->image_count == IMPORT_MAX_IMAGES ||
	    bytes > IMPORT_MAX_IMAGE_BYTES - import->image_bytes) {
		gr_diag_add(import->diag, GR_DIAG_ERROR, import->path, 0, image->name,
			    "more than %d textures or %zu MiB of them", IMPORT_MAX_IMAGES,
			    IMPORT_MAX_IMAGE_BYTES >> 20);
		return GR_ERR_CONFIG;
	}
	images = realloc(scene->images, (scene->image_count + 1) * sizeof *images);
	if (!images)
		return GR_ERR_NOMEM;
	scene->images = images;
	images[scene->image_count++] = *image;
	import->image_bytes += bytes;
	return GR_OK;
}

int import_image(struct import *import, const char *name, bool srgb, int *out_index)
{
	struct scene_image image = { .srgb = srgb };
	const struct aiTexture *inside = embedded(import, name);
	int result;

	*out_index = find_image(import->scene, name, srgb);
	if (*out_index >= 0)
		return GR_OK;
	image.name = strdup(name);
	if (!image.name)
		return GR_ERR_NOMEM;
	if (inside)
		result = decode_embedded(import, inside, name, &image);
	else
		result = decode_external(import, name, &image);
	if (result == GR_OK)
		result = keep_image(import, &image);
	if (result != GR_OK) {
		free(image.name);
		free(image.rgba);
		return result;
	}
	*out_index = (int)import->scene->image_count - 1;
	return GR_OK;
}
