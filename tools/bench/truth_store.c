#include "tools/bench/truth_store.h"

#include "base/clock.h"
#include "base/cursor.h"
#include "base/log.h"
#include "base/result.h"

#include <errno.h>
#include <math.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/*
 * KEY.truth: magic, version (u32), key (32), count (u32), seconds, picture
 * noise (f64 as u64), then three bands and a standard error (f64) a point, a
 * BLAKE2b-256 each of the pictures' bytes (zero: there is none), and one of all before.
 */
#define MAGIC "grotto-t"
#define VERSION 1u
#define HASH 32
#define HEAD (sizeof MAGIC - 1 + 4 + 32 + 4 + 8 + 8)
#define POINT_BYTES 32
#define FILE_SIZE(count) (HEAD + (count) * POINT_BYTES + 3 * HASH)

struct paths {
	char truth[1024], radiance[1024], indirect[1024];
};

static bool make_paths(struct paths *paths, const char *folder, const uint8_t key[32])
{
	char hex[33];
	int longest;

	sodium_bin2hex(hex, sizeof hex, key, 16);
	snprintf(paths->truth, sizeof paths->truth, "%s/%s.truth", folder, hex);
	snprintf(paths->radiance, sizeof paths->radiance, "%s/%s.exr", folder, hex);
	longest = snprintf(paths->indirect, sizeof paths->indirect, "%s/%s-indirect.exr", folder, hex);
	return longest > 0 && (size_t)longest < sizeof paths->indirect;
}

static uint64_t bits_of(double value)
{
	uint64_t bits;

	memcpy(&bits, &value, sizeof bits);
	return bits;
}

static double value_of(uint64_t bits)
{
	double value;

	memcpy(&value, &bits, sizeof value);
	return value;
}

static void image_hash(const struct image *image, uint8_t out[HASH])
{
	size_t values = (size_t)image->width * (size_t)image->height * (size_t)image->channels;

	memset(out, 0, HASH);
	if (image->data)
		crypto_generichash(out, HASH, (const unsigned char *)image->data,
				   values * sizeof *image->data, NULL, 0);
}

/* The whole file, or NULL: missing, or of another size. */
static uint8_t *read_whole(const char *path, size_t size)
{
	FILE *file = fopen(path, "rb");
	uint8_t *bytes = NULL;

	if (!file)
		return NULL;
	bytes = malloc(size + 1);
	if (bytes && fread(bytes, 1, size + 1, file) != size) {
		free(bytes);
		bytes = NULL;
	}
	fclose(file);
	return bytes;
}

static bool load_picture(const char *path, const uint8_t hash[HASH], struct image *out)
{
	static const uint8_t none[HASH];
	struct gr_diag diag = { 0 };
	uint8_t found[HASH];
	bool same = false;

	if (!memcmp(hash, none, HASH))
		return true;
	if (image_read_exr(path, out, &diag) == GR_OK) {
		image_hash(out, found);
		same = !memcmp(found, hash, HASH);
	}
	gr_diag_finish(&diag);
	return same;
}

static bool decode(struct bench_truth *out, const uint8_t *bytes, size_t size, const uint8_t key[32],
		   const struct paths *paths)
{
	struct gr_reader r = gr_reader(bytes, size - HASH);
	const uint8_t *magic = gr_read_bytes(&r, sizeof MAGIC - 1);
	uint32_t version = gr_read_u32(&r);
	const uint8_t *of = gr_read_bytes(&r, 32);
	const uint8_t *pictures[2];
	uint8_t sum[HASH];

	crypto_generichash(sum, HASH, bytes, size - HASH, NULL, 0);
	if (!of || memcmp(magic, MAGIC, sizeof MAGIC - 1) != 0 || version != VERSION ||
	    memcmp(of, key, 32) != 0 || memcmp(sum, bytes + size - HASH, HASH) != 0 ||
	    gr_read_u32(&r) != out->count)
		return false;
	out->seconds = value_of(gr_read_u64(&r));
	out->picture_noise = value_of(gr_read_u64(&r));
	for (size_t k = 0; k < out->count; k++) {
		for (int c = 0; c < 3; c++)
			out->irradiance[k][c] = value_of(gr_read_u64(&r));
		out->error[k] = value_of(gr_read_u64(&r));
	}
	pictures[0] = gr_read_bytes(&r, HASH);
	pictures[1] = gr_read_bytes(&r, HASH);
	return gr_reader_done(&r) && load_picture(paths->radiance, pictures[0], &out->radiance) &&
	       load_picture(paths->indirect, pictures[1], &out->indirect);
}

static bool load(struct bench_truth *out, const uint8_t key[32], const struct paths *paths)
{
	size_t size = FILE_SIZE(out->count);
	uint8_t *bytes = read_whole(paths->truth, size);
	bool good;

	if (!bytes) {
		if (access(paths->truth, F_OK) == 0)
			gr_notice("%s is not whole: traced anew", paths->truth);
		return false;
	}
	good = decode(out, bytes, size, key, paths);
	free(bytes);
	if (!good) {
		gr_notice("%s, or a picture beside it, is damaged or of another version: traced anew",
			  paths->truth);
		image_finish(&out->radiance);
		image_finish(&out->indirect);
	}
	return good;
}

static void encode(const struct bench_truth *truth, const uint8_t key[32], uint8_t *bytes, size_t size)
{
	struct gr_writer w = gr_writer(bytes, size);
	uint8_t hash[HASH];

	gr_write_bytes(&w, MAGIC, sizeof MAGIC - 1);
	gr_write_u32(&w, VERSION);
	gr_write_bytes(&w, key, 32);
	gr_write_u32(&w, (uint32_t)truth->count);
	gr_write_u64(&w, bits_of(truth->seconds));
	gr_write_u64(&w, bits_of(truth->picture_noise));
	for (size_t k = 0; k < truth->count; k++) {
		for (int c = 0; c < 3; c++)
			gr_write_u64(&w, bits_of(truth->irradiance[k][c]));
		gr_write_u64(&w, bits_of(truth->error[k]));
	}
	image_hash(&truth->radiance, hash);
	gr_write_bytes(&w, hash, HASH);
	image_hash(&truth->indirect, hash);
	gr_write_bytes(&w, hash, HASH);
	crypto_generichash(hash, HASH, bytes, w.len, NULL, 0);
	gr_write_bytes(&w, hash, HASH);
}

/* The pictures first: a file of the truth is never there without them. */
static int save(const struct bench_truth *truth, const uint8_t key[32], const struct paths *paths)
{
	size_t size = FILE_SIZE(truth->count);
	uint8_t *bytes = malloc(size);
	int result = bytes ? GR_OK : GR_ERR_NOMEM;
	FILE *file;

	if (result == GR_OK && truth->radiance.data)
		result = image_write_exr(paths->radiance, &truth->radiance, NULL);
	if (result == GR_OK && truth->indirect.data)
		result = image_write_exr(paths->indirect, &truth->indirect, NULL);
	if (result == GR_OK) {
		encode(truth, key, bytes, size);
		file = fopen(paths->truth, "wb");
		if (!file || fwrite(bytes, 1, size, file) != size)
			result = GR_ERR_IO;
		if (file && fclose(file) != 0)
			result = GR_ERR_IO;
		if (result == GR_ERR_IO) {
			gr_warning("%s: %s", paths->truth, strerror(errno));
			unlink(paths->truth);
		}
	}
	free(bytes);
	return result;
}

static int trace(struct bench_truth *out, const struct bench_points *points,
		 const struct bench_truth_source *source)
{
	int64_t start = gr_clock_now(&gr_clock_monotonic);
	int result = GR_OK;

	if (out->count)
		result = source->points(source->ctx, points, out->irradiance, out->error);
	if (result == GR_OK)
		result = source->picture(source->ctx, &out->radiance, &out->indirect,
					 &out->picture_noise);
	out->seconds = (double)(gr_clock_now(&gr_clock_monotonic) - start) * 1e-9;
	return result;
}

static double noise_of(const struct bench_truth *truth)
{
	double sum = 0, square = 0;

	for (size_t k = 0; k < truth->count; k++) {
		for (int c = 0; c < 3; c++)
			sum += truth->irradiance[k][c] / 3;
		square += truth->error[k] * truth->error[k];
	}
	return sum > 0 ? sqrt(square / (double)truth->count) / (sum / (double)truth->count) : (double)NAN;
}

int bench_truth_get(struct bench_truth *out, const char *folder, const uint8_t key[32],
		    const struct bench_points *points, const struct bench_truth_source *source)
{
	struct paths paths = { { 0 }, { 0 }, { 0 } };
	int result = GR_OK;

	*out = (struct bench_truth){ .count = points->count };
	out->irradiance = calloc(points->count + 1, sizeof *out->irradiance);
	out->error = calloc(points->count + 1, sizeof *out->error);
	if (!out->irradiance || !out->error)
		return GR_ERR_NOMEM;
	if (folder && !make_paths(&paths, folder, key))
		return GR_ERR_RANGE;
	out->kept = folder && load(out, key, &paths);
	if (!out->kept)
		result = trace(out, points, source);
	if (result != GR_OK)
		return result;
	out->noise = noise_of(out);
	if (folder && !out->kept && save(out, key, &paths) != GR_OK)
		gr_warning("%s: the truth cannot be kept there; the next run traces it again", folder);
	return GR_OK;
}

void bench_truth_finish(struct bench_truth *truth)
{
	free(truth->irradiance);
	free(truth->error);
	image_finish(&truth->radiance);
	image_finish(&truth->indirect);
	*truth = (struct bench_truth){ 0 };
}
