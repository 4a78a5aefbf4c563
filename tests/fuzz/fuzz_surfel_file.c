/* Bake files: once as they are, and once with the checksum and key that they should have. */
#include "renderer/gi/surfel_file.h"

#include <sodium.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void decode(const uint8_t key[SURFEL_KEY_BYTES], const uint8_t *bytes, size_t size)
{
	struct gr_diag diag = { 0 };
	struct surfel_set *set;

	if (surfel_file_decode(&set, key, bytes, size, "fuzz", &diag) == 0) {
		const float at[3] = { 1, 1, 1 };
		const uint32_t *members;
		size_t n = surfel_set_cell(set, at, &members);
		volatile float sum = 0;

		/* what was taken can be used */
		for (size_t k = 0; k < n; k++)
			sum = sum + surfel_weight(set, members[k], at, (const float[3]){ 0, 1, 0 });
		surfel_set_destroy(&set);
	}
	gr_diag_finish(&diag);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	uint8_t key[SURFEL_KEY_BYTES] = { 0 };
	uint8_t *copy;

	decode(key, data, size);
	if (size < 256 + 32)
		return 0;
	copy = malloc(size);
	if (!copy)
		return 0;
	memcpy(copy, data, size);
	memcpy(key, copy + 16, sizeof key);
	crypto_generichash(copy + size - 32, 32, copy, size - 32, NULL, 0);
	decode(key, copy, size);
	free(copy);
	return 0;
}
