#include "renderer/image/read_file.h"

#include "base/result.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

int read_file(const char *path, size_t most, uint8_t **out, size_t *out_len, struct gr_diag *diag,
	      const char *what)
{
	FILE *file = fopen(path, "rb");
	struct stat status;
	uint8_t *bytes;
	size_t len;

	*out = NULL;
	if (!file || fstat(fileno(file), &status) != 0) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL, "%s cannot be opened: %s", what,
			    strerror(errno));
		if (file)
			fclose(file);
		return GR_ERR_CONFIG;
	}
	if (!S_ISREG(status.st_mode) || status.st_size < 1 || (uint64_t)status.st_size > most) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL,
			    "%s must be a file of 1 to %zu bytes, this is %s", what, most,
			    !S_ISREG(status.st_mode) ? "no plain file"
			    : status.st_size < 1     ? "empty"
						     : "larger");
		fclose(file);
		return GR_ERR_CONFIG;
	}
	len = (size_t)status.st_size;
	bytes = malloc(len);
	if (bytes && fread(bytes, 1, len, file) != len) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL, "%s cannot be read: %s", what,
			    ferror(file) ? strerror(errno) : "it became shorter");
		free(bytes);
		fclose(file);
		return GR_ERR_CONFIG;
	}
	fclose(file);
	if (!bytes)
		return GR_ERR_NOMEM;
	*out = bytes;
	*out_len = len;
	return GR_OK;
}
