/*
 * libFuzzer target: any bytes are a scene file or are refused with a message;
 * what is taken writes, reads back and hashes to the same.
 */
#include "base/result.h"
#include "config/scene_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len);
const char *__lsan_default_suppressions(void);

/* libconfig 1.5 forgets the string that it was reading when a file does not parse. */
const char *__lsan_default_suppressions(void)
{
	return "leak:libconfig.so\n";
}

static void check(const struct scene_file *file, struct gr_diag *diag)
{
	struct scene_file *again;
	char *text = NULL, *model = scene_file_model_path(file);
	size_t size;
	FILE *out = open_memstream(&text, &size);
	float gamma = scene_tone_gamma_encode(&file->tone);

	if (!isfinite(gamma) || gamma <= 0 || !gr_pose_valid(&file->room) || !model)
		abort();
	if (!out || scene_file_write(out, file) != GR_OK || fclose(out))
		abort();
	if (scene_file_parse(text, size, file->path, &again, diag) != GR_OK ||
	    memcmp(again->hash, file->hash, sizeof again->hash))
		abort();
	scene_file_destroy(&again);
	free(text);
	free(model);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len)
{
	struct gr_diag diag = { 0 };
	struct scene_file *file;
	int result = scene_file_parse((const char *)bytes, len, "fuzz/fuzz.scene", &file, &diag);

	if ((result == GR_OK) != !!file || (result == GR_OK) != !diag.errors)
		abort();
	if (file)
		check(file, &diag);
	scene_file_destroy(&file);
	gr_diag_finish(&diag);
	return 0;
}
