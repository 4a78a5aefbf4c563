#include "renderer/image/exr_private.h"

#include "base/log.h"
#include "base/result.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

static _Thread_local struct exr_bytes *listener;

void exr_listen(struct exr_bytes *bytes)
{
	listener = bytes;
}

void exr_keep_message(exr_const_context_t context, exr_result_t code, const char *message)
{
	(void)context;
	(void)code;
	if (listener && !listener->message[0])
		snprintf(listener->message, sizeof listener->message, "%s", message);
}

static exr_result_t add_channels(exr_context_t file, const char *const *names, int count)
{
	exr_result_t result = EXR_ERR_SUCCESS;

	for (int c = 0; c < count && result == EXR_ERR_SUCCESS; c++)
		result = exr_add_channel(file, 0, names[c], EXR_PIXEL_FLOAT,
					 EXR_PERCEPTUALLY_LINEAR, 1, 1);
	return result;
}

/* The file keeps channels by the alphabet; each finds its values by its name. */
static void point_channels(exr_encode_pipeline_t *encoder, const struct image *image,
			   const char *const *names, int row)
{
	for (int i = 0; i < encoder->channel_count; i++) {
		exr_coding_channel_info_t *channel = &encoder->channels[i];

		for (int c = 0; c < image->channels; c++) {
			if (strcmp(channel->channel_name, names[c]) != 0)
				continue;
			channel->encode_from_ptr =
				(const uint8_t *)(image->data +
						  (size_t)row * (size_t)image->width *
							  (size_t)image->channels + c);
			channel->user_bytes_per_element = sizeof(float);
			channel->user_data_type = EXR_PIXEL_FLOAT;
			channel->user_pixel_stride = image->channels * (int)sizeof(float);
			channel->user_line_stride = image->width * image->channels * (int)sizeof(float);
		}
	}
}

static exr_result_t write_rows(exr_context_t file, const struct image *image,
			       const char *const *names)
{
	exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
	exr_chunk_info_t chunk;
	int32_t rows = 1;
	exr_result_t result = exr_get_scanlines_per_chunk(file, 0, &rows);
	bool begun = false;

	for (int row = 0; row < image->height && result == EXR_ERR_SUCCESS; row += rows) {
		result = exr_write_scanline_chunk_info(file, 0, row, &chunk);
		if (result != EXR_ERR_SUCCESS)
			break;
		result = begun ? exr_encoding_update(file, 0, &chunk, &encoder)
			       : exr_encoding_initialize(file, 0, &chunk, &encoder);
		if (result != EXR_ERR_SUCCESS)
			break;
		point_channels(&encoder, image, names, row);
		if (!begun)
			result = exr_encoding_choose_default_routines(file, 0, &encoder);
		begun = true;
		if (result == EXR_ERR_SUCCESS)
			result = exr_encoding_run(file, 0, &encoder);
	}
	if (begun)
		exr_encoding_destroy(file, &encoder);
	return result;
}

int image_write_exr(const char *path, const struct image *image, const char *const *channel_names)
{
	static const char *const grey[] = { "Y" };
	static const char *const colors[] = { "R", "G", "B", "A" };
	const char *const *names = channel_names ? channel_names : image->channels == 1 ? grey : colors;
	exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
	struct exr_bytes bytes = { 0 };
	exr_context_t file = NULL;
	struct stat there;
	exr_result_t result;
	int part;

	/* OpenEXR seeks in it, and removes it when writing fails: never a device */
	if (stat(path, &there) == 0 && !S_ISREG(there.st_mode)) {
		gr_error("%s: is there and is no plain file; a picture goes into one", path);
		return GR_ERR_IO;
	}
	settings.error_handler_fn = exr_keep_message;
	exr_listen(&bytes);
	result = exr_start_write(&file, path, EXR_WRITE_FILE_DIRECTLY, &settings);
	if (result == EXR_ERR_SUCCESS)
		result = exr_add_part(file, "grotto", EXR_STORAGE_SCANLINE, &part);
	if (result == EXR_ERR_SUCCESS)
		result = exr_initialize_required_attr_simple(file, 0, image->width, image->height,
							     EXR_COMPRESSION_ZIP);
	if (result == EXR_ERR_SUCCESS)
		result = add_channels(file, names, image->channels);
	if (result == EXR_ERR_SUCCESS)
		result = exr_write_header(file);
	if (result == EXR_ERR_SUCCESS)
		result = write_rows(file, image, names);
	if (result == EXR_ERR_SUCCESS) {
		result = exr_finish(&file);
	} else {
		bool created = file != NULL;

		exr_finish(&file);
		if (created)
			remove(path);
	}
	exr_listen(NULL);
	if (result == EXR_ERR_SUCCESS)
		return GR_OK;
	gr_error("%s: cannot be written: %s", path,
		 bytes.message[0] ? bytes.message : exr_get_default_error_message(result));
	return result == EXR_ERR_OUT_OF_MEMORY ? GR_ERR_NOMEM : GR_ERR_IO;
}
