/* Scan-line EXR of any compression through OpenEXRCore, from bytes in memory. */
#include "renderer/image/exr_private.h"

#include "base/result.h"
#include "renderer/image/read_file.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define EXR_MAX_FILE ((size_t)1 << 31)

/* May give less than was asked for: the library reads headers ahead, and judges itself. */
static int64_t read_bytes(exr_const_context_t context, void *user, void *buffer, uint64_t size,
			  uint64_t offset, exr_stream_error_func_ptr_t error)
{
	const struct exr_bytes *file = user;

	(void)context;
	(void)error;
	if (offset >= file->len)
		return 0;
	if (size > file->len - offset)
		size = file->len - offset;
	memcpy(buffer, file->bytes + offset, size);
	return (int64_t)size;
}

static int64_t size_of_bytes(exr_const_context_t context, void *user)
{
	(void)context;
	return (int64_t)((const struct exr_bytes *)user)->len;
}

static int refuse(struct gr_diag *diag, const char *name, const char *text)
{
	gr_diag_add(diag, GR_DIAG_ERROR, name, 0, NULL, "%s", text);
	return GR_ERR_CONFIG;
}

/* Names of the channels to read: R G B, or Y, or the only one. 0 when there is no such set. */
static int choose_channels(const exr_attr_chlist_t *list, const char *names[3])
{
	static const char *const wanted[] = { "R", "G", "B", "Y" };
	const char *found[4] = { NULL };

	for (int i = 0; i < list->num_channels; i++) {
		for (int w = 0; w < 4; w++) {
			if (strcmp(list->entries[i].name.str, wanted[w]) == 0)
				found[w] = wanted[w];
		}
	}
	if (found[0] && found[1] && found[2]) {
		memcpy(names, found, 3 * sizeof names[0]);
		return 3;
	}
	names[0] = found[3];
	if (!names[0] && list->num_channels == 1)
		names[0] = list->entries[0].name.str;
	return names[0] ? 1 : 0;
}

static int check_part(exr_context_t file, const char *name, struct gr_diag *diag,
		      const exr_attr_chlist_t **channels, exr_attr_box2i_t *window)
{
	exr_storage_t storage;

	if (exr_get_storage(file, 0, &storage) != EXR_ERR_SUCCESS ||
	    exr_get_channels(file, 0, channels) != EXR_ERR_SUCCESS ||
	    exr_get_data_window(file, 0, window) != EXR_ERR_SUCCESS)
		return refuse(diag, name, "the EXR header is not complete");
	if (storage != EXR_STORAGE_SCANLINE)
		return refuse(diag, name, "tiled or deep EXR; scan lines are read");
	for (int i = 0; i < (*channels)->num_channels; i++) {
		if ((*channels)->entries[i].x_sampling != 1 ||
		    (*channels)->entries[i].y_sampling != 1)
			return refuse(diag, name, "subsampled channels are not read");
	}
	if ((int64_t)window->max.x - window->min.x >= IMAGE_MAX_SIDE ||
	    (int64_t)window->max.y - window->min.y >= IMAGE_MAX_SIDE ||
	    window->max.x < window->min.x || window->max.y < window->min.y)
		return refuse(diag, name, "the picture is empty or larger than 32768 a side");
	return GR_OK;
}

static void point_channels(exr_decode_pipeline_t *decoder, const struct image *image,
			   const char *const *names, int row)
{
	for (int i = 0; i < decoder->channel_count; i++) {
		exr_coding_channel_info_t *channel = &decoder->channels[i];

		channel->decode_to_ptr = NULL;
		for (int c = 0; c < image->channels; c++) {
			if (strcmp(channel->channel_name, names[c]) != 0)
				continue;
			channel->decode_to_ptr = (uint8_t *)(image->data +
							     (size_t)row * (size_t)image->width *
								     (size_t)image->channels + c);
			channel->user_bytes_per_element = sizeof(float);
			channel->user_data_type = EXR_PIXEL_FLOAT;
			channel->user_pixel_stride = image->channels * (int)sizeof(float);
			channel->user_line_stride = image->width * image->channels * (int)sizeof(float);
		}
	}
}

static exr_result_t read_rows(exr_context_t file, const struct image *image,
			      const char *const *names, int first)
{
	exr_decode_pipeline_t decoder = EXR_DECODE_PIPELINE_INITIALIZER;
	exr_chunk_info_t chunk;
	int32_t rows = 1;
	exr_result_t result = exr_get_scanlines_per_chunk(file, 0, &rows);
	bool begun = false;

	for (int row = 0; row < image->height && result == EXR_ERR_SUCCESS; row += rows) {
		result = exr_read_scanline_chunk_info(file, 0, first + row, &chunk);
		if (result != EXR_ERR_SUCCESS)
			break;
		/* What the file says of a chunk must lie within the rows that are there. */
		if (chunk.start_y != first + row || chunk.height < 1 ||
		    chunk.height > image->height - row || chunk.width != image->width) {
			result = EXR_ERR_BAD_CHUNK_LEADER;
			break;
		}
		result = begun ? exr_decoding_update(file, 0, &chunk, &decoder)
			       : exr_decoding_initialize(file, 0, &chunk, &decoder);
		if (result != EXR_ERR_SUCCESS)
			break;
		point_channels(&decoder, image, names, row);
		if (!begun)
			result = exr_decoding_choose_default_routines(file, 0, &decoder);
		begun = true;
		if (result == EXR_ERR_SUCCESS)
			result = exr_decoding_run(file, 0, &decoder);
	}
	if (begun)
		exr_decoding_destroy(file, &decoder);
	return result;
}

static int read_part(exr_context_t file, const char *name, struct image *out,
		     const struct exr_bytes *bytes, struct gr_diag *diag)
{
	const exr_attr_chlist_t *channels;
	const char *names[3];
	exr_attr_box2i_t window;
	exr_result_t exr;
	int result = check_part(file, name, diag, &channels, &window);
	int count;

	if (result != GR_OK)
		return result;
	count = choose_channels(channels, names);
	if (count == 0)
		return refuse(diag, name, "neither R G B nor Y nor a single channel");
	result = image_create(out, window.max.x - window.min.x + 1, window.max.y - window.min.y + 1,
			      count);
	if (result == GR_ERR_RANGE)
		return refuse(diag, name, "the picture has too many pixels");
	if (result != GR_OK)
		return result;
	exr = read_rows(file, out, names, window.min.y);
	if (exr == EXR_ERR_SUCCESS)
		return GR_OK;
	image_finish(out);
	gr_diag_add(diag, GR_DIAG_ERROR, name, 0, NULL, "damaged or cut off: %s",
		    bytes->message[0] ? bytes->message : exr_get_default_error_message(exr));
	return GR_ERR_CONFIG;
}

int image_decode_exr(const uint8_t *bytes, size_t len, const char *name, struct image *out,
		     struct gr_diag *diag)
{
	exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
	struct exr_bytes stream = { .bytes = bytes, .len = len };
	exr_context_t file = NULL;
	exr_result_t exr;
	int result;

	memset(out, 0, sizeof *out);
	settings.error_handler_fn = exr_keep_message;
	settings.user_data = &stream;
	exr_listen(&stream);
	settings.read_fn = read_bytes;
	settings.size_fn = size_of_bytes;
	settings.max_image_width = IMAGE_MAX_SIDE;
	settings.max_image_height = IMAGE_MAX_SIDE;
	exr = exr_start_read(&file, name, &settings);
	if (exr != EXR_ERR_SUCCESS) {
		gr_diag_add(diag, GR_DIAG_ERROR, name, 0, NULL, "not a readable EXR: %s",
			    stream.message[0] ? stream.message : exr_get_default_error_message(exr));
		result = GR_ERR_CONFIG;
	} else {
		result = read_part(file, name, out, &stream, diag);
	}
	exr_finish(&file);
	exr_listen(NULL);
	return result;
}

int image_read_exr(const char *path, struct image *out, struct gr_diag *diag)
{
	uint8_t *bytes;
	size_t len;
	int result;

	memset(out, 0, sizeof *out);
	result = read_file(path, EXR_MAX_FILE, &bytes, &len, diag, "picture");
	if (result != GR_OK)
		return result;
	result = image_decode_exr(bytes, len, path, out, diag);
	free(bytes);
	return result;
}
