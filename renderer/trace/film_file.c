/*
 * A film as a file, little endian: magic, version, width, height, samples,
 * seed, nonfinite, key, the four sums of all pixels as doubles, and the
 * BLAKE2b-256 of all that.
 */
#include "renderer/trace/reference.h"

#include "base/cursor.h"
#include "base/log.h"
#include "base/result.h"
#include "renderer/image/read_file.h"
#include "renderer/trace/sampler.h"

#include <errno.h>
#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define VERSION 1
#define HASH_BYTES 32
#define HEAD_BYTES (8 + 4 * 4 + 2 * 8 + 32)
#define PIXEL_BYTES (4 * 3 * sizeof(double))
/*
 * Of a sum: 2^30 samples of the largest float, squared, are 1.3e86. What is
 * more was never summed, and its square might not be finite.
 */
#define SUM_MOST 1e90
/* As for pictures. */
#define PIXELS_MOST (IMAGE_MAX_SAMPLES / 3)

static const char magic[8] = { 'g', 'r', 'o', 't', 'f', 'i', 'l', 'm' };

static void write_head(const struct reference_film *film, uint8_t head[HEAD_BYTES])
{
	struct gr_writer w = gr_writer(head, HEAD_BYTES);

	gr_write_bytes(&w, magic, sizeof magic);
	gr_write_u32(&w, VERSION);
	gr_write_u32(&w, (uint32_t)film->width);
	gr_write_u32(&w, (uint32_t)film->height);
	gr_write_u32(&w, (uint32_t)film->samples);
	gr_write_u64(&w, film->seed);
	gr_write_u64(&w, film->nonfinite);
	gr_write_bytes(&w, film->key, sizeof film->key);
}

struct output {
	FILE *file;
	crypto_generichash_state hash;
	bool ok;
};

static void put(struct output *out, const uint8_t *bytes, size_t len)
{
	crypto_generichash_update(&out->hash, bytes, len);
	out->ok = out->ok && fwrite(bytes, 1, len, out->file) == len;
}

static void put_sums(struct output *out, const double *sums, size_t count)
{
	uint8_t block[4096];

	while (count > 0) {
		size_t n = count < sizeof block / 8 ? count : sizeof block / 8;
		struct gr_writer w = gr_writer(block, sizeof block);

		for (size_t i = 0; i < n; i++) {
			uint64_t bits;

			memcpy(&bits, &sums[i], sizeof bits);
			gr_write_u64(&w, bits);
		}
		put(out, block, 8 * n);
		sums += n;
		count -= n;
	}
}

static bool write_all(const struct reference_film *film, FILE *file)
{
	const double *sums[] = { film->radiance, film->squares, film->indirect,
				 film->indirect_squares };
	size_t values = 3 * (size_t)film->width * (size_t)film->height;
	struct output out = { .file = file, .ok = true };
	uint8_t head[HEAD_BYTES], hash[HASH_BYTES];

	crypto_generichash_init(&out.hash, NULL, 0, sizeof hash);
	write_head(film, head);
	put(&out, head, sizeof head);
	for (size_t i = 0; i < sizeof sums / sizeof sums[0]; i++)
		put_sums(&out, sums[i], values);
	crypto_generichash_final(&out.hash, hash, sizeof hash);
	return out.ok && fwrite(hash, 1, sizeof hash, file) == sizeof hash && fflush(file) == 0 &&
	       fsync(fileno(file)) == 0;
}

int reference_film_save(const struct reference_film *film, const char *path)
{
	size_t size = strlen(path) + 5;
	char *beside = malloc(size);
	FILE *file;
	bool done;

	if (!beside)
		return GR_ERR_NOMEM;
	/* Beside it and renamed: an interruption leaves the old one whole. */
	snprintf(beside, size, "%s.new", path);
	file = fopen(beside, "wb");
	done = file && write_all(film, file);
	if (file)
		done = fclose(file) == 0 && done;
	done = done && rename(beside, path) == 0;
	if (!done) {
		gr_error("%s: cannot be written: %s", path, strerror(errno));
		if (file)
			remove(beside);
	}
	free(beside);
	return done ? GR_OK : GR_ERR_IO;
}

struct input {
	const char *name;
	struct gr_diag *diag;
};

static int refuse(const struct input *in, int result, const char *why)
{
	gr_diag_add(in->diag, GR_DIAG_ERROR, in->name, 0, NULL,
		    "%s; start anew without it, or give the file that belongs here", why);
	return result;
}

static int read_head(const struct input *in, struct gr_reader *r, struct reference_film *film)
{
	const uint8_t *start = gr_read_bytes(r, sizeof magic), *key;
	uint32_t version = gr_read_u32(r), size[2], samples;

	if (!start || memcmp(start, magic, sizeof magic) != 0)
		return refuse(in, GR_ERR_FORMAT, "no film of grotto reference");
	if (!r->ok)
		return refuse(in, GR_ERR_FORMAT, "cut short within its first bytes");
	if (version != VERSION)
		return refuse(in, GR_ERR_VERSION, "a film of another version of grotto");
	size[0] = gr_read_u32(r);
	size[1] = gr_read_u32(r);
	samples = gr_read_u32(r);
	film->seed = gr_read_u64(r);
	film->nonfinite = gr_read_u64(r);
	key = gr_read_bytes(r, sizeof film->key);
	if (!key)
		return refuse(in, GR_ERR_FORMAT, "cut short within its first bytes");
	if (size[0] < 1 || size[1] < 1 || size[0] > IMAGE_MAX_SIDE || size[1] > IMAGE_MAX_SIDE ||
	    (size_t)size[0] * size[1] > PIXELS_MOST || samples > 1u << 30 ||
	    samples % SAMPLER_SET != 0)
		return refuse(in, GR_ERR_FORMAT, "its size or number of samples cannot be");
	memcpy(film->key, key, sizeof film->key);
	film->width = (int)size[0];
	film->height = (int)size[1];
	film->samples = (int)samples;
	return GR_OK;
}

static int read_sums(const struct input *in, struct gr_reader *r, struct reference_film *film)
{
	double **sums[] = { &film->radiance, &film->squares, &film->indirect,
			    &film->indirect_squares };
	size_t values = 3 * (size_t)film->width * (size_t)film->height;

	for (size_t s = 0; s < sizeof sums / sizeof sums[0]; s++) {
		*sums[s] = malloc(values * sizeof **sums[s]);
		if (!*sums[s])
			return GR_ERR_NOMEM;
		for (size_t i = 0; i < values; i++) {
			uint64_t bits = gr_read_u64(r);

			memcpy(*sums[s] + i, &bits, sizeof bits);
			if (!(fabs((*sums[s])[i]) <= SUM_MOST))
				return refuse(in, GR_ERR_FORMAT, "a sum in it is not one of light");
		}
	}
	return GR_OK;
}

int reference_film_parse(struct reference_film *film, const uint8_t *bytes, size_t len,
			 const char *name, struct gr_diag *diag)
{
	const struct input in = { name, diag };
	struct gr_reader r = gr_reader(bytes, len);
	uint8_t hash[HASH_BYTES];
	size_t wanted;
	int result = read_head(&in, &r, film);

	if (result != GR_OK)
		goto out;
	wanted = (size_t)film->width * (size_t)film->height * PIXEL_BYTES + HASH_BYTES;
	if (gr_reader_left(&r) != wanted) {
		result = refuse(&in, GR_ERR_FORMAT,
				gr_reader_left(&r) < wanted ? "cut short" : "longer than what it holds");
		goto out;
	}
	crypto_generichash(hash, sizeof hash, bytes, len - sizeof hash, NULL, 0);
	if (memcmp(hash, bytes + len - sizeof hash, sizeof hash) != 0) {
		result = refuse(&in, GR_ERR_FORMAT, "damaged: its checksum does not fit");
		goto out;
	}
	result = read_sums(&in, &r, film);
out:
	if (result != GR_OK)
		reference_film_finish(film);
	return result;
}

int reference_film_load(struct reference_film *film, const char *path, struct gr_diag *diag)
{
	uint8_t *bytes;
	size_t len;
	int result = read_file(path, HEAD_BYTES + PIXELS_MOST * PIXEL_BYTES + HASH_BYTES, &bytes,
			       &len, diag, "film");

	if (result != GR_OK)
		return result == GR_ERR_CONFIG ? GR_ERR_IO : result;
	result = reference_film_parse(film, bytes, len, path, diag);
	free(bytes);
	return result;
}
