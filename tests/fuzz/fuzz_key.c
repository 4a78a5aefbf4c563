/* A key file with any content. */
#define _GNU_SOURCE /* memfd_create */
#include "protocol/key.h"

#include "base/result.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static const uint8_t zero[FDP_KEY_BYTES];
	struct gr_diag diag = { 0 };
	uint8_t key[FDP_KEY_BYTES];
	char path[64];
	int fd = memfd_create("key", MFD_CLOEXEC), result;

	if (fd < 0 || fchmod(fd, 0600) || write(fd, data, size) != (ssize_t)size)
		abort();
	snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
	result = fdp_key_load(path, key, &diag);
	if (result ? !diag.errors || memcmp(key, zero, sizeof key)
		   : diag.errors || !memcmp(key, zero, sizeof key))
		abort();
	gr_diag_finish(&diag);
	close(fd);
	return 0;
}
