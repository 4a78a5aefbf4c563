/* A delta from outside: refused without a trace, or every value in its range. */
#include "protocol/state.h"

#include "base/result.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static const float head[3] = { 1, 2, 3 };
	struct param_state *state, *again;
	uint8_t bytes[PARAM_DELTA_MAX];
	uint64_t before;
	long len;

	if (param_state_create(&state) || param_state_create(&again))
		abort();
	param_set(state, PARAM_HEAD_POSITION, head, 5);
	before = param_state_hash(state, 0);
	if (param_delta_apply(state, data, size)) {
		if (param_state_hash(state, 0) != before)
			abort();
	} else {
		for (int i = 0; i < PARAM_COUNT; i++)
			if (!param_valid((enum param_id)i, param_get(state, (enum param_id)i)))
				abort();
		len = param_delta_encode(state, 0, bytes, sizeof bytes);
		if (len < 0 || param_delta_apply(again, bytes, (size_t)len) ||
		    param_state_hash(again, 0) != param_state_hash(state, 0))
			abort();
	}
	param_state_destroy(&state);
	param_state_destroy(&again);
	return 0;
}
