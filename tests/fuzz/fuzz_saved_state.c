/* What a master left: with a checksum put right, so that the values behind it are looked at. */
#include "base/result.h"
#include "daemon/saved_state.h"

#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#define SUM_BYTES 32

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len)
{
	uint8_t again[SAVED_STATE_BYTES], *copy = malloc(len ? len : 1);
	char why[SAVED_STATE_REASON];
	struct saved_state state;

	if (!copy)
		abort();
	if (len)
		memcpy(copy, bytes, len);
	if (len == SAVED_STATE_BYTES)
		crypto_generichash(copy + len - SUM_BYTES, SUM_BYTES, copy, len - SUM_BYTES, NULL, 0);
	if (saved_state_decode(copy, len, &state, why) == GR_OK) {
		saved_state_encode(&state, again);
		if (memcmp(copy, again, sizeof again))
			abort();
		saved_state_fits(&state, state.layout_hash, state.scene_hash, state.saved_ns, why);
	}
	free(copy);
	return 0;
}
