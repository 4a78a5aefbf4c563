/*
 * Numeric addresses as the checks need them. Private to config/.
 */
#ifndef GROTTO_CONFIG_ADDRESS_H
#define GROTTO_CONFIG_ADDRESS_H

#include <stdbool.h>
#include <stdint.h>

struct address {
	uint8_t bytes[16]; /* IPv4 as ::ffff:a.b.c.d, so that equal machines compare equal */
	bool v4;           /* written as IPv4 */
};

/* False for anything that is not a numeric IPv4 or IPv6 address without a zone. */
bool address_parse(const char *text, struct address *out);
bool address_equal(const struct address *a, const struct address *b);
bool address_loopback(const struct address *address);
bool address_multicast(const struct address *address);
/* 0.0.0.0 and ::. */
bool address_unspecified(const struct address *address);
/* A machine's own address: none of multicast, unspecified, 255.255.255.255. */
bool address_of_machine(const struct address *address);

#endif
