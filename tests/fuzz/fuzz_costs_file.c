/* A file of a GPU's costs with any content, as it is and with a sum that fits. */
#include "renderer/gi/costs_file.h"

#include <math.h>
#include <sodium.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define DEVICE "fuzz"
#define SUM_HEX 32

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* What is accepted is valid, and comes back from what is written of it. */
static void decode(const char *text, size_t len)
{
	char again[COSTS_FILE_MAX];
	struct gi_costs costs, same;
	const char *why;
	int result = gi_costs_decode(text, len, DEVICE, &costs, &why);

	if ((result == 0) != (why == NULL))
		abort();
	if (result != 0)
		return;
	if (!gi_costs_valid(&costs))
		abort();
	len = gi_costs_encode(&costs, DEVICE, again);
	if (len > sizeof again || gi_costs_decode(again, len, DEVICE, &same, &why) != 0)
		abort();
}

/* The last line becomes "sum HEX" of what stands before it. */
static void sign(char *text, size_t len)
{
	unsigned char hash[SUM_HEX / 2];
	char hex[SUM_HEX + 1];

	crypto_generichash(hash, sizeof hash, (unsigned char *)text, len, NULL, 0);
	sodium_bin2hex(hex, sizeof hex, hash, sizeof hash);
	memcpy(text + len, "sum ", 4);
	memcpy(text + len + 4, hex, SUM_HEX);
	text[len + 4 + SUM_HEX] = '\n';
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	const size_t line = 4 + SUM_HEX + 1;
	size_t body = size >= line ? size - line : size;
	char *copy;

	/* exact sizes, so that a sanitizer sees one byte read too many */
	copy = malloc(size ? size : 1);
	if (!copy)
		abort();
	if (size)
		memcpy(copy, data, size);
	decode(copy, size);
	free(copy);
	copy = malloc(body + line);
	if (!copy)
		abort();
	if (body)
		memcpy(copy, data, body);
	sign(copy, body);
	decode(copy, body + line);
	free(copy);
	return 0;
}
