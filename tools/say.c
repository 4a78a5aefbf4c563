#include "tools/say.h"

#include <stdio.h>

void say_diag(const struct gr_diag *diag)
{
	/* Notes and faults go to two streams: keep them in order on a terminal. */
	for (size_t i = 0; i < diag->count; i++) {
		const struct gr_diag_item *item = &diag->items[i];

		fflush(stdout);
		if (item->severity == GR_DIAG_NOTE)
			printf("%s\n", item->text);
		else
			fprintf(stderr, "%s: %s\n",
				item->severity == GR_DIAG_ERROR ? "error" : "warning", item->text);
	}
	fflush(stdout);
}
