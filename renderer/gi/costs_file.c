#include "config.h" /* asprintf */

#include "renderer/gi/costs_file.h"

#include "base/result.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <sodium.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/*
 *	grotto-costs 2
 *	device llvmpipe (LLVM 15.0.6, 256 bits)
 *	lattice_frame 2000000
 *	...
 *	sum 0123456789abcdef0123456789abcdef    BLAKE2b-128 of all lines before
 *
 * Numbers are whole picoseconds: no locale, no rounding to argue about.
 */
#define HEAD "grotto-costs 2\n"
#define SUM_BYTES 16
#define PICO 1e3
#define NUMBER_MAX UINT64_C(1000000000000000) /* 1000 s */

static const struct {
	const char *name;
	size_t offset;
} keys[] = {
	{ "lattice_frame", offsetof(struct gi_costs, lattice_frame) },
	{ "lattice_cell_step", offsetof(struct gi_costs, lattice_cell_step) },
	{ "surfel_frame", offsetof(struct gi_costs, surfel_frame) },
	{ "surfel_tap", offsetof(struct gi_costs, surfel_tap) },
	{ "surfel_link", offsetof(struct gi_costs, surfel_link) },
};
#define KEYS (sizeof keys / sizeof *keys)

char *gi_costs_folder(void)
{
	const char *system = getenv("CACHE_DIRECTORY"), *user = getenv("XDG_CACHE_HOME");
	const char *home = getenv("HOME");
	char *path = NULL;
	int made = -1;

	if (system && system[0] == '/')
		made = asprintf(&path, "%.*s", (int)strcspn(system, ":"), system);
	else if (user && user[0] == '/')
		made = asprintf(&path, "%s/grotto", user);
	else if (home && home[0] == '/')
		made = asprintf(&path, "%s/.cache/grotto", home);
	return made < 0 ? NULL : path;
}

/* As it stands in the file: one line, whatever a driver calls itself. */
static void clean(const char *device, char out[COSTS_DEVICE_MAX])
{
	size_t n = 0;

	for (; n < COSTS_DEVICE_MAX - 1 && device[n]; n++)
		out[n] = device[n] >= 0x20 && device[n] < 0x7f ? device[n] : '?';
	out[n] = '\0';
}

char *gi_costs_path(const char *folder, const char *device)
{
	unsigned char hash[crypto_generichash_BYTES_MIN];
	char name[COSTS_DEVICE_MAX], hex[17], *path;

	clean(device, name);
	crypto_generichash(hash, sizeof hash, (const unsigned char *)name, strlen(name), NULL, 0);
	sodium_bin2hex(hex, sizeof hex, hash, 8);
	return asprintf(&path, "%s/costs-%s.txt", folder, hex) < 0 ? NULL : path;
}

static void sum_of(const char *text, size_t len, char hex[2 * SUM_BYTES + 1])
{
	unsigned char hash[SUM_BYTES];

	crypto_generichash(hash, sizeof hash, (const unsigned char *)text, len, NULL, 0);
	sodium_bin2hex(hex, 2 * SUM_BYTES + 1, hash, sizeof hash);
}

static double *value_of(struct gi_costs *costs, size_t key)
{
	return (double *)(void *)((char *)costs + keys[key].offset);
}

size_t gi_costs_encode(const struct gi_costs *costs, const char *device, char text[COSTS_FILE_MAX])
{
	struct gi_costs copy = *costs;
	char name[COSTS_DEVICE_MAX], sum[2 * SUM_BYTES + 1];
	size_t len;

	clean(device, name);
	len = (size_t)snprintf(text, COSTS_FILE_MAX, HEAD "device %s\n", name);
	for (size_t i = 0; i < KEYS; i++)
		len += (size_t)snprintf(text + len, COSTS_FILE_MAX - len, "%s %llu\n", keys[i].name,
					(unsigned long long)llround(fmax(1, *value_of(&copy, i) * PICO)));
	sum_of(text, len, sum);
	len += (size_t)snprintf(text + len, COSTS_FILE_MAX - len, "sum %s\n", sum);
	return len;
}

/* Takes `word` from the front of what is left. */
static bool take(const char **at, const char *end, const char *word)
{
	size_t n = strlen(word);

	if ((size_t)(end - *at) < n || memcmp(*at, word, n) != 0)
		return false;
	*at += n;
	return true;
}

/* Digits and the end of the line. */
static bool take_number(const char **at, const char *end, uint64_t *out)
{
	const char *first = *at;

	*out = 0;
	for (; *at < end && **at >= '0' && **at <= '9'; ++*at) {
		*out = *out * 10 + (uint64_t)(**at - '0');
		if (*out > NUMBER_MAX)
			return false;
	}
	return *at > first && take(at, end, "\n");
}

int gi_costs_decode(const char *text, size_t len, const char *device, struct gi_costs *out,
		    const char **out_why)
{
	const char *at = text, *end = text + len;
	char name[COSTS_DEVICE_MAX], sum[2 * SUM_BYTES + 1];
	struct gi_costs costs;

	*out_why = "it is no file of costs, or of another version";
	if (!take(&at, end, HEAD))
		return GR_ERR_FORMAT;
	clean(device, name);
	*out_why = "it is of another GPU or driver";
	if (!take(&at, end, "device ") || !take(&at, end, name) || !take(&at, end, "\n"))
		return GR_ERR_MISMATCH;
	*out_why = "a line is missing, too many or no number";
	for (size_t i = 0; i < KEYS; i++) {
		uint64_t picoseconds;

		if (!take(&at, end, keys[i].name) || !take(&at, end, " ") ||
		    !take_number(&at, end, &picoseconds))
			return GR_ERR_FORMAT;
		*value_of(&costs, i) = (double)picoseconds / PICO;
	}
	sum_of(text, (size_t)(at - text), sum);
	*out_why = "its checksum is wrong";
	if (!take(&at, end, "sum ") || !take(&at, end, sum) || !take(&at, end, "\n") || at != end)
		return GR_ERR_FORMAT;
	*out_why = "a number in it cannot be";
	if (!gi_costs_valid(&costs))
		return GR_ERR_FORMAT;
	*out = costs;
	*out_why = NULL;
	return GR_OK;
}

int gi_costs_load(const char *path, const char *device, struct gi_costs *out, const char **out_why)
{
	char text[COSTS_FILE_MAX + 1];
	struct stat status;
	size_t len = 0;
	ssize_t n;
	/* a pipe in its place must not hold us */
	int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);

	*out_why = "it cannot be read";
	if (fd < 0)
		return errno == ENOENT || errno == ENOTDIR ? GR_NOTHING : GR_ERR_IO;
	if (fstat(fd, &status) != 0 || !S_ISREG(status.st_mode)) {
		close(fd);
		return GR_ERR_FORMAT;
	}
	while (len < sizeof text && (n = read(fd, text + len, sizeof text - len)) > 0)
		len += (size_t)n;
	close(fd);
	return gi_costs_decode(text, len, device, out, out_why);
}

/* The folder and the one around it; what is there already is fine. */
static void make_folder(const char *path)
{
	char folder[4096];

	for (int up = 2; up >= 1; up--) {
		char *slash;

		if (snprintf(folder, sizeof folder, "%s", path) >= (int)sizeof folder)
			return;
		for (int i = 0; i < up; i++) {
			slash = strrchr(folder, '/');
			if (!slash || slash == folder)
				return;
			*slash = '\0';
		}
		mkdir(folder, 0700);
	}
}

int gi_costs_save(const char *path, const char *device, const struct gi_costs *costs)
{
	char text[COSTS_FILE_MAX], beside[4200];
	size_t len = gi_costs_encode(costs, device, text);
	int fd, failed;

	make_folder(path);
	if (snprintf(beside, sizeof beside, "%s.%ld", path, (long)getpid()) >= (int)sizeof beside) {
		errno = ENAMETOOLONG;
		return GR_ERR_IO;
	}
	fd = open(beside, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0644);
	if (fd < 0)
		return GR_ERR_IO;
	failed = write(fd, text, len) != (ssize_t)len;
	failed |= close(fd) != 0;
	if (!failed && rename(beside, path) == 0)
		return GR_OK;
	failed = errno;
	unlink(beside);
	errno = failed;
	return GR_ERR_IO;
}

int gi_costs_lock(const char *path, int wait_ms)
{
	const struct timespec pause = { 0, 50 * 1000 * 1000 };
	char beside[4200];
	int fd;

	make_folder(path);
	if (snprintf(beside, sizeof beside, "%s.lock", path) >= (int)sizeof beside)
		return -1;
	fd = open(beside, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
	if (fd < 0)
		return -1;
	while (flock(fd, LOCK_EX | LOCK_NB) != 0) {
		if (wait_ms <= 0 || (errno != EWOULDBLOCK && errno != EINTR)) {
			close(fd);
			return -1;
		}
		nanosleep(&pause, NULL);
		wait_ms -= 50;
	}
	return fd;
}

void gi_costs_unlock(int lock)
{
	if (lock >= 0)
		close(lock);
}
