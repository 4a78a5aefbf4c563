/* The parser of tracker logs: what it takes, it must write and take again. */
#include "base/result.h"
#include "tracking/replay.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t len)
{
	struct track_sample *samples = NULL, *again = NULL;
	struct gr_diag diag = { 0 };
	size_t count = 0, count_again = 0, text_len = 0;
	char *copy = malloc(len ? len : 1), *text = NULL;
	FILE *file;

	if (!copy)
		abort();
	if (len)
		memcpy(copy, bytes, len);
	if (track_replay_parse(copy, len, "fuzz", &samples, &count, &diag) == GR_OK) {
		file = open_memstream(&text, &text_len);
		if (!file || diag.errors || count == 0)
			abort();
		for (size_t i = 0; i < count; i++)
			track_replay_write(file, &samples[i]);
		fclose(file);
		if (track_replay_parse(text, text_len, "again", &again, &count_again, &diag) != GR_OK ||
		    count_again != count)
			abort();
		for (size_t i = 0; i < count; i++)
			if (again[i].time_ns != samples[i].time_ns ||
			    (samples[i].valid && memcmp(&again[i].T_room_body, &samples[i].T_room_body,
							sizeof samples[i].T_room_body) != 0))
				abort();
	} else if (diag.errors == 0) {
		abort();
	}
	free(again);
	free(samples);
	free(text);
	free(copy);
	gr_diag_finish(&diag);
	return 0;
}
