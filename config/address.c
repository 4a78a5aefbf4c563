#include "config/address.h"

#include <arpa/inet.h>
#include <string.h>

static const uint8_t v4_prefix[12] = { 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff };

bool address_parse(const char *text, struct address *out)
{
	memset(out, 0, sizeof *out);
	if (inet_pton(AF_INET, text, out->bytes + 12) == 1) {
		memcpy(out->bytes, v4_prefix, sizeof v4_prefix);
		out->v4 = true;
		return true;
	}
	return inet_pton(AF_INET6, text, out->bytes) == 1;
}

static bool mapped(const struct address *address)
{
	return !memcmp(address->bytes, v4_prefix, sizeof v4_prefix);
}

bool address_equal(const struct address *a, const struct address *b)
{
	return !memcmp(a->bytes, b->bytes, sizeof a->bytes);
}

bool address_loopback(const struct address *address)
{
	static const uint8_t one[16] = { [15] = 1 };

	if (mapped(address))
		return address->bytes[12] == 127;
	return !memcmp(address->bytes, one, sizeof one);
}

bool address_multicast(const struct address *address)
{
	return mapped(address) ? address->bytes[12] >> 4 == 0xe : address->bytes[0] == 0xff;
}

bool address_unspecified(const struct address *address)
{
	static const uint8_t zero[16];
	size_t from = mapped(address) ? 12 : 0;

	return !memcmp(address->bytes + from, zero, sizeof zero - from);
}

bool address_of_machine(const struct address *address)
{
	static const uint8_t all[4] = { 255, 255, 255, 255 };

	return !address_multicast(address) && !address_unspecified(address) &&
	       !(mapped(address) && !memcmp(address->bytes + 12, all, sizeof all));
}
