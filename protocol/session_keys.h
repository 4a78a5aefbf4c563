/*
 * Keys of a session, derived from the cluster's: what was signed in one session,
 * or by one incarnation of a node, is no good in another, whatever its numbers say.
 *
 *   to nodes   one for all, for a multicast datagram has one MAC: from the
 *              session and the nonce that the master drew when it started
 *   to master  of one incarnation of one node: from both sides' nonces and the
 *              challenge that let it in
 *
 * Each is keyed BLAKE2b (RFC 7693) of a label and these, 32 bytes.
 */
#ifndef GROTTO_PROTOCOL_SESSION_KEYS_H
#define GROTTO_PROTOCOL_SESSION_KEYS_H

#include "protocol/message.h"

void fdp_key_to_nodes(const uint8_t cluster[FDP_KEY_BYTES], uint64_t session,
		      const uint8_t master_nonce[FDP_NONCE_BYTES], uint8_t key[FDP_KEY_BYTES]);
void fdp_key_to_master(const uint8_t cluster[FDP_KEY_BYTES], uint64_t session, unsigned node,
		       const uint8_t master_nonce[FDP_NONCE_BYTES],
		       const uint8_t node_nonce[FDP_NONCE_BYTES],
		       const uint8_t challenge[FDP_NONCE_BYTES], uint8_t key[FDP_KEY_BYTES]);
/* What a node must echo to come in as its incarnation after so many `joins`. */
void fdp_challenge(const uint8_t cluster[FDP_KEY_BYTES], uint64_t session, unsigned node,
		   uint64_t joins, const uint8_t master_nonce[FDP_NONCE_BYTES],
		   const uint8_t node_nonce[FDP_NONCE_BYTES], uint8_t challenge[FDP_NONCE_BYTES]);

#endif
