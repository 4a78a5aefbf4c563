#include "protocol/session_keys.h"

#include "base/cursor.h"

#include <sodium.h>

/* No label begins like a datagram: what is derived here is never the MAC of one. */
#define LABEL_BYTES 24
#define TEXT_MAX (LABEL_BYTES + 8 + 8 + 3 * FDP_NONCE_BYTES)

static struct gr_writer start(uint8_t text[TEXT_MAX], const char label[LABEL_BYTES],
			      uint64_t session)
{
	struct gr_writer w = gr_writer(text, TEXT_MAX);

	gr_write_bytes(&w, label, LABEL_BYTES);
	gr_write_u64(&w, session);
	return w;
}

void fdp_key_to_nodes(const uint8_t cluster[FDP_KEY_BYTES], uint64_t session,
		      const uint8_t master_nonce[FDP_NONCE_BYTES], uint8_t key[FDP_KEY_BYTES])
{
	static const char label[LABEL_BYTES] = "fdp master to nodes";
	uint8_t text[TEXT_MAX];
	struct gr_writer w = start(text, label, session);

	gr_write_bytes(&w, master_nonce, FDP_NONCE_BYTES);
	crypto_generichash(key, FDP_KEY_BYTES, text, w.len, cluster, FDP_KEY_BYTES);
}

void fdp_key_to_master(const uint8_t cluster[FDP_KEY_BYTES], uint64_t session, unsigned node,
		       const uint8_t master_nonce[FDP_NONCE_BYTES],
		       const uint8_t node_nonce[FDP_NONCE_BYTES],
		       const uint8_t challenge[FDP_NONCE_BYTES], uint8_t key[FDP_KEY_BYTES])
{
	static const char label[LABEL_BYTES] = "fdp node to master";
	uint8_t text[TEXT_MAX];
	struct gr_writer w = start(text, label, session);

	gr_write_u64(&w, node);
	gr_write_bytes(&w, master_nonce, FDP_NONCE_BYTES);
	gr_write_bytes(&w, node_nonce, FDP_NONCE_BYTES);
	gr_write_bytes(&w, challenge, FDP_NONCE_BYTES);
	crypto_generichash(key, FDP_KEY_BYTES, text, w.len, cluster, FDP_KEY_BYTES);
}

void fdp_challenge(const uint8_t cluster[FDP_KEY_BYTES], uint64_t session, unsigned node,
		   uint64_t joins, const uint8_t master_nonce[FDP_NONCE_BYTES],
		   const uint8_t node_nonce[FDP_NONCE_BYTES], uint8_t challenge[FDP_NONCE_BYTES])
{
	static const char label[LABEL_BYTES] = "fdp join challenge";
	uint8_t text[TEXT_MAX];
	struct gr_writer w = start(text, label, session);

	gr_write_u64(&w, node);
	gr_write_u64(&w, joins);
	gr_write_bytes(&w, master_nonce, FDP_NONCE_BYTES);
	gr_write_bytes(&w, node_nonce, FDP_NONCE_BYTES);
	crypto_generichash(challenge, FDP_NONCE_BYTES, text, w.len, cluster, FDP_KEY_BYTES);
}
