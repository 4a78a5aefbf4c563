/* A film's file with any content, as it is and with a checksum that fits. */
#include "renderer/trace/reference.h"

#include <math.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void parse(const uint8_t *bytes, size_t len)
{
	struct reference_film film = { 0 };
	struct gr_diag diag = { 0 };
	int result = reference_film_parse(&film, bytes, len, "fuzz.film", &diag);

	if ((result == 0) != (film.radiance != NULL) || (result == 0) != (diag.errors == 0))
		abort();
	/* what is accepted can be used */
	if (result == 0) {
		struct image images[3];

		if (reference_film_images(&film, &images[0], &images[1], &images[2]) == 0 &&
		    isnan(reference_film_error(&film)))
			abort();
		for (int i = 0; i < 3; i++)
			image_finish(&images[i]);
	}
	reference_film_finish(&film);
	gr_diag_finish(&diag);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	uint8_t *copy;

	parse(data, size);
	if (size < 32)
		return 0;
	copy = malloc(size);
	if (!copy)
		abort();
	memcpy(copy, data, size);
	crypto_generichash(copy + size - 32, 32, copy, size - 32, NULL, 0);
	parse(copy, size);
	free(copy);
	return 0;
}
