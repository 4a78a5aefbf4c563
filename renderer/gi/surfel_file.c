#include <config.h>

#include "renderer/gi/surfel_file.h"

#include "base/cursor.h"
#include "base/result.h"
#include "renderer/gi/surfel_file_private.h"

#include <errno.h>
#include <fcntl.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "arrays are written as they lie in memory");

static const char magic[8] = { 'G', 'R', 'S', 'U', 'R', 'F', 'E', 'L' };

void surfel_file_key(const struct scene *scene, const struct surfel_bake_params *params,
		     uint8_t key[SURFEL_KEY_BYTES])
{
	crypto_generichash_state state;
	uint8_t numbers[64];
	struct gr_writer w = gr_writer(numbers, sizeof numbers);

	gr_write_u32(&w, SURFEL_BAKE_VERSION);
	gr_write_f32(&w, params->spacing_m);
	gr_write_u32(&w, (uint32_t)params->links);
	gr_write_u32(&w, (uint32_t)params->taps);
	gr_write_u32(&w, (uint32_t)params->probes);
	gr_write_f32(&w, params->absorption_per_m);
	gr_write_f32(&w, params->scattering_per_m);
	gr_write_u64(&w, params->seed);
	crypto_generichash_init(&state, NULL, 0, SURFEL_KEY_BYTES);
	crypto_generichash_update(&state, numbers, w.len);
	crypto_generichash_update(&state, scene->hash, sizeof scene->hash);
	crypto_generichash_final(&state, key, SURFEL_KEY_BYTES);
}

/* --- writing --- */

static size_t encode_head(const struct surfel_set *set, const uint8_t key[SURFEL_KEY_BYTES],
			  uint8_t bytes[SURFEL_HEAD_BYTES])
{
	const struct surfel_grid *grid = &set->grid;
	const struct surfel_probes *probes = &set->probes;
	struct gr_writer w = gr_writer(bytes, SURFEL_HEAD_BYTES);
	struct surfel_part parts[SURFEL_PARTS];
	uint64_t length = SURFEL_HEAD_BYTES + surfel_set_parts(set, parts) + SURFEL_SUM_BYTES;

	gr_write_bytes(&w, magic, sizeof magic);
	gr_write_u32(&w, SURFEL_FILE_FORM);
	gr_write_u32(&w, SURFEL_BAKE_VERSION);
	gr_write_bytes(&w, key, SURFEL_KEY_BYTES);
	gr_write_u64(&w, length);
	gr_write_f32(&w, set->spacing_m);
	gr_write_f32(&w, set->radius_m);
	gr_write_u64(&w, set->count);
	gr_write_u32(&w, set->links_each);
	gr_write_u32(&w, set->taps_each);
	for (int i = 0; i < 3; i++) {
		gr_write_f32(&w, grid->origin[i]);
		gr_write_u32(&w, (uint32_t)grid->size[i]);
		gr_write_f32(&w, probes->origin[i]);
		gr_write_u32(&w, (uint32_t)probes->size[i]);
	}
	gr_write_f32(&w, grid->cell_m);
	gr_write_u32(&w, grid->slots);
	gr_write_u64(&w, grid->member_count);
	gr_write_f32(&w, probes->cell_m);
	gr_write_u32(&w, probes->links_each);
	gr_write_u64(&w, probes->count);
	gr_write_u64(&w, set->rays);
	gr_write_u64(&w, (uint64_t)(set->seconds * 1e6));
	gr_write_u64(&w, (uint64_t)(set->ray_seconds * 1e6));
	gr_write_u32(&w, (uint32_t)set->threads);
	gr_write_f32(&w, set->extinction);
	return w.len;
}

/* Adds to the checksum; false: errno says why. */
static bool put(int fd, crypto_generichash_state *sum, const void *data, size_t size)
{
	const uint8_t *at = data;

	if (sum)
		crypto_generichash_update(sum, data, size);
	while (size > 0) {
		ssize_t n = write(fd, at, size < ((size_t)1 << 30) ? size : (size_t)1 << 30);

		if (n < 0 && errno == EINTR)
			continue;
		if (n <= 0)
			return false;
		at += n;
		size -= (size_t)n;
	}
	return true;
}

static bool write_all(int fd, const struct surfel_set *set, const uint8_t key[SURFEL_KEY_BYTES])
{
	uint8_t head[SURFEL_HEAD_BYTES] = { 0 };
	uint8_t digest[SURFEL_SUM_BYTES];
	struct surfel_part parts[SURFEL_PARTS];
	crypto_generichash_state sum;
	bool ok;

	crypto_generichash_init(&sum, NULL, 0, sizeof digest);
	encode_head(set, key, head);
	surfel_set_parts(set, parts);
	ok = put(fd, &sum, head, sizeof head);
	for (size_t i = 0; i < SURFEL_PARTS && ok; i++)
		ok = put(fd, &sum, parts[i].data, parts[i].bytes);
	crypto_generichash_final(&sum, digest, sizeof digest);
	return ok && put(fd, NULL, digest, sizeof digest) && fsync(fd) == 0;
}

/* So that the name, too, survives a loss of power; where that cannot be, the file is no worse. */
static void sync_folder(const char *path)
{
	const char *slash = strrchr(path, '/');
	char *folder = slash ? strndup(path, (size_t)(slash - path) + 1) : strdup(".");
	int fd = folder ? open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1;

	if (fd >= 0) {
		fsync(fd);
		close(fd);
	}
	free(folder);
}

int surfel_file_write(const struct surfel_set *set, const uint8_t key[SURFEL_KEY_BYTES],
		      const char *path)
{
	char *beside = NULL;
	int result = GR_ERR_IO, fd, why;
	struct stat there;

	/* what is no file (a device, a pipe) is not put out of the way by one */
	if (stat(path, &there) == 0 && !S_ISREG(there.st_mode)) {
		errno = EEXIST;
		return GR_ERR_IO;
	}
	if (asprintf(&beside, "%s.%ld.new", path, (long)getpid()) < 0)
		return GR_ERR_NOMEM;
	unlink(beside); /* of a process of that number which is no more */
	fd = open(beside, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
	if (fd >= 0) {
		bool written = write_all(fd, set, key);

		why = errno;
		if (close(fd) != 0 && written) {
			why = errno;
			written = false;
		}
		if (written && rename(beside, path) == 0) {
			result = GR_OK;
			sync_folder(path);
		} else {
			why = written ? errno : why;
			unlink(beside);
			errno = why;
		}
	}
	why = errno;
	free(beside);
	errno = why;
	return result;
}

/* --- reading --- */

static int refuse(struct gr_diag *diag, const char *name, int result, const char *why)
{
	gr_diag_add(diag, GR_DIAG_WARNING, name, 0, NULL, "%s; it is not used", why);
	return result;
}

static void decode_head(const uint8_t *bytes, struct surfel_set *set)
{
	struct surfel_grid *grid = &set->grid;
	struct surfel_probes *probes = &set->probes;
	struct gr_reader r = gr_reader(bytes, SURFEL_HEAD_BYTES);

	gr_read_bytes(&r, sizeof magic + 8 + SURFEL_KEY_BYTES + 8);
	set->spacing_m = gr_read_f32(&r);
	set->radius_m = gr_read_f32(&r);
	set->count = gr_read_u64(&r);
	set->links_each = gr_read_u32(&r);
	set->taps_each = gr_read_u32(&r);
	for (int i = 0; i < 3; i++) {
		grid->origin[i] = gr_read_f32(&r);
		grid->size[i] = (int32_t)gr_read_u32(&r);
		probes->origin[i] = gr_read_f32(&r);
		probes->size[i] = (int32_t)gr_read_u32(&r);
	}
	grid->cell_m = gr_read_f32(&r);
	grid->slots = gr_read_u32(&r);
	grid->member_count = gr_read_u64(&r);
	probes->cell_m = gr_read_f32(&r);
	probes->links_each = gr_read_u32(&r);
	probes->count = gr_read_u64(&r);
	set->rays = gr_read_u64(&r);
	set->seconds = (double)gr_read_u64(&r) * 1e-6;
	set->ray_seconds = (double)gr_read_u64(&r) * 1e-6;
	set->threads = (int)gr_read_u32(&r);
	set->extinction = gr_read_f32(&r);
}

/* Arrays of the sizes that the head says, in the order of surfel_set_parts. */
static int take_arrays(struct surfel_set *set, const uint8_t *bytes, size_t len)
{
	struct surfel_part parts[SURFEL_PARTS];
	void **const places[SURFEL_PARTS] = {
		(void **)&set->surfels, (void **)&set->area, (void **)&set->albedo,
		(void **)&set->fixed_emissive, (void **)&set->fixed_other, (void **)&set->links,
		(void **)&set->taps, (void **)&set->grid.keys, (void **)&set->grid.first,
		(void **)&set->grid.members, (void **)&set->probes.directions,
		(void **)&set->probes.links, (void **)&set->probes.fixed,
		(void **)&set->probes.distance, (void **)&set->probes.alive,
		(void **)&set->fixed_way, (void **)&set->probes.fixed_way,
	};

	if (surfel_set_parts(set, parts) != len)
		return GR_ERR_FORMAT;
	for (size_t i = 0; i < SURFEL_PARTS; i++) {
		*places[i] = malloc(parts[i].bytes + 1);
		if (!*places[i])
			return GR_ERR_NOMEM;
		memcpy(*places[i], bytes, parts[i].bytes);
		bytes += parts[i].bytes;
	}
	return GR_OK;
}

/* What can be known before the whole is summed. */
static int check_start(const uint8_t *bytes, size_t len, const uint8_t key[SURFEL_KEY_BYTES],
		       const char *name, struct gr_diag *diag)
{
	struct gr_reader r = gr_reader(bytes, len);
	const uint8_t *start = gr_read_bytes(&r, sizeof magic);
	uint32_t form = gr_read_u32(&r), baker = gr_read_u32(&r);
	const uint8_t *its_key = gr_read_bytes(&r, SURFEL_KEY_BYTES);
	uint64_t length = gr_read_u64(&r);

	if (!start || memcmp(start, magic, sizeof magic) != 0)
		return refuse(diag, name, GR_ERR_FORMAT, "not a file of baked surfels");
	if (!r.ok || len < SURFEL_HEAD_BYTES + SURFEL_SUM_BYTES || length > len)
		return refuse(diag, name, GR_ERR_FORMAT, "cut short");
	if (form != SURFEL_FILE_FORM || baker != SURFEL_BAKE_VERSION) {
		gr_diag_add(diag, GR_DIAG_WARNING, name, 0, NULL,
			    "of another version of grotto (form %u, baker %u; this one has %d, %d); "
			    "it is not used", form, baker, SURFEL_FILE_FORM, SURFEL_BAKE_VERSION);
		return GR_ERR_VERSION;
	}
	if (length < len)
		return refuse(diag, name, GR_ERR_FORMAT, "longer than it says");
	if (sodium_memcmp(its_key, key, SURFEL_KEY_BYTES) != 0)
		return refuse(diag, name, GR_ERR_MISMATCH,
			      "made from another scene or with other settings");
	return GR_OK;
}

int surfel_file_decode(struct surfel_set **out, const uint8_t key[SURFEL_KEY_BYTES],
		       const uint8_t *bytes, size_t len, const char *name, struct gr_diag *diag)
{
	uint8_t digest[SURFEL_SUM_BYTES];
	struct surfel_set *set;
	const char *wrong = NULL;
	int result = check_start(bytes, len, key, name, diag);

	*out = NULL;
	if (result != GR_OK)
		return result;
	crypto_generichash(digest, sizeof digest, bytes, len - sizeof digest, NULL, 0);
	if (memcmp(digest, bytes + len - sizeof digest, sizeof digest) != 0)
		return refuse(diag, name, GR_ERR_FORMAT, "damaged: its checksum is another");
	set = calloc(1, sizeof *set);
	if (!set)
		return GR_ERR_NOMEM;
	decode_head(bytes, set);
	wrong = surfel_check_head(set);
	if (!wrong) {
		result = take_arrays(set, bytes + SURFEL_HEAD_BYTES,
				     len - SURFEL_HEAD_BYTES - sizeof digest);
		if (result == GR_ERR_FORMAT)
			wrong = "its arrays are not as long as it says";
		else if (result == GR_OK)
			wrong = surfel_check_arrays(set);
	}
	if (wrong)
		result = refuse(diag, name, GR_ERR_FORMAT, wrong);
	if (result == GR_OK)
		*out = set;
	else
		surfel_set_destroy(&set);
	return result;
}

static uint8_t *read_whole(int fd, size_t len)
{
	uint8_t *bytes = malloc(len + 1);
	size_t at = 0;

	while (bytes && at < len) {
		ssize_t n = read(fd, bytes + at, len - at);

		if (n < 0 && errno == EINTR)
			continue;
		if (n <= 0) {
			/* shorter than it was: as long as before, but not of its checksum */
			errno = n == 0 ? EIO : errno;
			free(bytes);
			return NULL;
		}
		at += (size_t)n;
	}
	return bytes;
}

int surfel_file_read(struct surfel_set **out, const uint8_t key[SURFEL_KEY_BYTES],
		     const char *path, struct gr_diag *diag)
{
	int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
	int result = GR_ERR_IO;
	uint8_t *bytes = NULL;
	struct stat status;

	*out = NULL;
	if (fd < 0 && (errno == ENOENT || errno == ENOTDIR))
		return GR_NOTHING;
	if (fd < 0 || fstat(fd, &status) != 0) {
		gr_diag_add(diag, GR_DIAG_WARNING, path, 0, NULL, "cannot be read: %s",
			    strerror(errno));
	} else if (!S_ISREG(status.st_mode) || (uint64_t)status.st_size > SURFEL_FILE_MOST) {
		result = refuse(diag, path, GR_ERR_FORMAT, "not a file of baked surfels");
	} else {
		bytes = read_whole(fd, (size_t)status.st_size);
		if (bytes)
			result = surfel_file_decode(out, key, bytes, (size_t)status.st_size, path,
						    diag);
		else
			gr_diag_add(diag, GR_DIAG_WARNING, path, 0, NULL, "cannot be read: %s",
				    strerror(errno));
	}
	free(bytes);
	if (fd >= 0)
		close(fd);
	return result;
}
