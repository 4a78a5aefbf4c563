/*
 * LZO1X-1 packing of messages. Packing is tried for messages that need more
 * than one datagram, and kept when the packed form needs fewer: on a gigabit
 * wire LZO costs more than it saves below some 16 KB (measured for this
 * protocol), what pays at any size is a datagram, and so a system call for
 * each node, less.
 */
#ifndef GROTTO_PROTOCOL_PACK_H
#define GROTTO_PROTOCOL_PACK_H

#include <stddef.h>
#include <stdint.h>

struct fdp_packer;

int fdp_packer_create(struct fdp_packer **out);
void fdp_packer_destroy(struct fdp_packer **packer);
/*
 * Packs up to FDP_MESSAGE_MAX bytes. *out_bytes is valid until the next call.
 * GR_OK; GR_NOTHING when it gets no smaller; GR_ERR_RANGE when too long.
 */
int fdp_pack(struct fdp_packer *packer, const uint8_t *bytes, size_t len,
	     const uint8_t **out_bytes, size_t *out_len);
/*
 * Unpacks bytes from outside: never writes beyond plain_len, and takes only
 * what unpacks to exactly that. GR_OK or GR_ERR_FORMAT.
 */
int fdp_unpack(const uint8_t *bytes, size_t len, uint8_t *plain, size_t plain_len);

#endif
