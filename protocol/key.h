/*
 * The cluster key: 32 bytes in a file that nobody but its owner (and group)
 * may read. Written as 64 hexadecimal digits and a newline.
 */
#ifndef GROTTO_PROTOCOL_KEY_H
#define GROTTO_PROTOCOL_KEY_H

#include "base/diag.h"

#include <stdint.h>

#define FDP_KEY_BYTES 32

/*
 * Refuses a file that is not regular, is open to others (any of 0027), or
 * does not hold a key: GR_ERR_CONFIG with a line in diag. path NULL gives the
 * all-zero key of an unkeyed loopback layout.
 */
int fdp_key_load(const char *path, uint8_t key[FDP_KEY_BYTES], struct gr_diag *diag);
/* Creates the file with a random key, mode 0640; fails if it exists. */
int fdp_key_create(const char *path, struct gr_diag *diag);

#endif
