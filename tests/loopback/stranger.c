/*
 * stranger ADDRESS PORT: throws bad datagrams at a daemon: noise, datagrams of
 * another key, of another version, cut short, with flipped bits, sent again.
 */
#include "base/clock.h"
#include "protocol/node.h"
#include "tests/unit/unit.h"

#include <arpa/inet.h>
#include <sodium.h>
#include <unistd.h>

struct thrower {
	int fd;
	struct sockaddr_in to;
	struct unit_random random;
	uint8_t last[1500];
	size_t len;
};

static void throw_at(struct thrower *t, const uint8_t *bytes, size_t len)
{
	sendto(t->fd, bytes, len, 0, (const struct sockaddr *)&t->to, sizeof t->to);
}

static void keep(void *ctx, int to, const uint8_t *bytes, size_t len)
{
	struct thrower *t = ctx;

	(void)to;
	t->len = len < sizeof t->last ? len : sizeof t->last;
	memcpy(t->last, bytes, t->len);
}

static void ignore_event(void *ctx, const struct fdp_node_event *event)
{
	(void)ctx;
	(void)event;
}

/* A true JOIN, made with a key of zeros or of ones. */
static int make_join(struct thrower *t, uint8_t key)
{
	struct fdp_node_params params = { .name = "front", .datagram_max = 1472 };
	struct fdp_node_ops ops = { keep, ignore_event, t };
	struct fdp_node *node;
	int64_t now_ns = gr_clock_now(&gr_clock_monotonic);

	memset(params.key, key, sizeof params.key);
	if (fdp_node_create(&node, &params, &ops) < 0)
		return -1;
	t->len = 0;
	fdp_node_tick(node, now_ns);
	fdp_node_tick(node, now_ns + GR_NS_PER_S);
	fdp_node_destroy(&node);
	return t->len > 0 ? 0 : -1;
}

static void throw_noise(struct thrower *t)
{
	uint8_t bytes[1472];

	for (int i = 0; i < 100; i++) {
		size_t len = unit_random_u32(&t->random) % (sizeof bytes + 1);
		for (size_t k = 0; k < len; k++)
			bytes[k] = (uint8_t)unit_random_u32(&t->random);
		throw_at(t, bytes, len);
	}
}

/* Everything wrong that can be made of one good datagram. */
static void throw_variations(struct thrower *t)
{
	uint8_t bytes[1500];

	for (size_t len = 0; len < t->len; len++)
		throw_at(t, t->last, len);
	for (size_t i = 0; i < t->len; i++) {
		memcpy(bytes, t->last, t->len);
		bytes[i] = (uint8_t)(bytes[i] ^ 1u << unit_random_u32(&t->random) % 8);
		throw_at(t, bytes, t->len);
		usleep(200); /* the daemon also has frames to draw */
	}
	/* Another version (byte 4 of the header) in every kind of message (byte 5). */
	for (uint8_t kind = 0; kind < 16; kind++) {
		memcpy(bytes, t->last, t->len);
		bytes[4] = 9;
		bytes[5] = kind;
		throw_at(t, bytes, t->len);
	}
	memcpy(bytes, t->last, t->len);
	memset(bytes + t->len, 0, sizeof bytes - t->len);
	throw_at(t, bytes, t->len + 20 < 1472 ? t->len + 20 : 1472);
}

int main(int argc, char **argv)
{
	struct thrower t = { .fd = socket(AF_INET, SOCK_DGRAM, 0), .random = { 42 } };

	if (argc != 3 || t.fd < 0 || sodium_init() < 0)
		return 2;
	t.to.sin_family = AF_INET;
	t.to.sin_port = htons((uint16_t)atoi(argv[2]));
	if (inet_pton(AF_INET, argv[1], &t.to.sin_addr) != 1)
		return 2;
	throw_noise(&t);
	for (uint8_t key = 0; key < 2; key++) {
		if (make_join(&t, key) < 0)
			return 1;
		throw_variations(&t);
		if (key == 1)
			throw_at(&t, t.last, t.len); /* whole and right, but for the key */
	}
	close(t.fd);
	return 0;
}
