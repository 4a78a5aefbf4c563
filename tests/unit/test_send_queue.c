/* Datagrams that leave together: each arrives as it is, and those to one address in order. */
#include "tests/unit/unit.h"

#include "base/log.h"
#include "base/result.h"
#include "daemon/socket.h"

#include <poll.h>
#include <unistd.h>

#define WAYS 3
#define LONGEST 1400

struct ends {
	int out, in[WAYS];
	struct net_address to[WAYS];
	unsigned sent[WAYS], got[WAYS]; /* numbers the datagrams of a way */
};

static void open_ends(struct ends *e)
{
	memset(e, 0, sizeof *e);
	e->out = socket(AF_INET, SOCK_DGRAM, 0);
	assert_true(e->out >= 0);
	for (int i = 0; i < WAYS; i++) {
		struct net_address *a = &e->to[i];
		int size = 8 << 20;

		assert_int_equal(net_address_parse("127.0.0.1", 0, a), GR_OK);
		e->in[i] = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0);
		assert_int_equal(bind(e->in[i], (const struct sockaddr *)&a->sa, a->len), 0);
		a->len = sizeof a->sa;
		assert_int_equal(getsockname(e->in[i], (struct sockaddr *)&a->sa, &a->len), 0);
		setsockopt(e->in[i], SOL_SOCKET, SO_RCVBUF, &size, sizeof size);
	}
}

static void close_ends(struct ends *e)
{
	close(e->out);
	for (int i = 0; i < WAYS; i++)
		close(e->in[i]);
}

/* What it holds follows from way, number and length. */
static void fill(uint8_t *bytes, size_t len, int way, unsigned number)
{
	for (size_t i = 0; i < len; i++)
		bytes[i] = (uint8_t)(number * 7 + (unsigned)way * 31 + i + len);
}

static void add(struct send_queue *q, struct ends *e, int way, size_t len)
{
	uint8_t bytes[LONGEST];

	fill(bytes, len, way, e->sent[way]++);
	send_queue_add(q, way, &e->to[way], bytes, len);
}

static void take_all(struct ends *e)
{
	for (int i = 0; i < WAYS; i++)
		while (e->got[i] < e->sent[i]) {
			struct pollfd wait = { e->in[i], POLLIN, 0 };
			uint8_t bytes[65536], right[LONGEST];
			ssize_t n;

			assert_int_equal(poll(&wait, 1, 1000), 1);
			n = recv(e->in[i], bytes, sizeof bytes, 0);
			assert_true(n >= 0 && n <= LONGEST);
			fill(right, (size_t)n, i, e->got[i]++);
			assert_memory_equal(bytes, right, (size_t)n);
		}
}

/* Full buffers and a shorter last one, to several in turn. */
static void fragments(void **state)
{
	struct send_stats before, after;
	struct send_queue *q;
	struct ends e;

	(void)state;
	open_ends(&e);
	assert_int_equal(send_queue_create(&q, LONGEST), GR_OK);
	for (int gso = 0; gso < 2; gso++) {
		send_queue_set_gso(q, gso);
		send_queue_stats(q, &before);
		for (int i = 0; i < 20; i++)
			for (int way = 0; way < WAYS; way++)
				add(q, &e, way, i == 19 ? 100 : LONGEST);
		assert_int_equal(send_queue_count(q), 60);
		send_queue_flush(q, e.out);
		assert_int_equal(send_queue_count(q), 0);
		take_all(&e);
		send_queue_stats(q, &after);
		assert_int_equal(after.sent - before.sent, 60);
		assert_int_equal(after.failed, 0);
		printf("# 60 datagrams to %d, GSO %s: %llu calls, %llu joined\n", WAYS, gso ? "on" : "off",
		       (unsigned long long)(after.calls - before.calls),
		       (unsigned long long)(after.joined - before.joined));
		if (!gso)
			assert_int_equal(after.joined, 0);
	}
	send_queue_destroy(&q);
	assert_null(q);
	close_ends(&e);
}

static void any_sequence(void **state)
{
	struct unit_random r = unit_random_start("any sequence");
	struct send_stats stats;
	struct send_queue *q;
	struct ends e;
	uint64_t sent = 0;

	(void)state;
	open_ends(&e);
	assert_int_equal(send_queue_create(&q, LONGEST), GR_OK);
	for (int round = 0; round < 300; round++) {
		const unsigned count = unit_random_u32(&r) % (SEND_QUEUE + 1);
		const unsigned usual = round & 1 ? LONGEST : unit_random_u32(&r) % LONGEST;

		for (unsigned i = 0; i < count; i++) {
			const uint32_t what = unit_random_u32(&r);

			add(q, &e, (int)(what % WAYS),
			    what >> 8 & 3 ? usual : what >> 10 & 3 ? (what >> 12) % LONGEST : 0);
		}
		sent += count;
		send_queue_flush(q, e.out);
		take_all(&e);
	}
	send_queue_stats(q, &stats);
	assert_int_equal(stats.sent, sent);
	assert_int_equal(stats.failed, 0);
	printf("# %llu datagrams, %llu joined, %llu calls\n", (unsigned long long)stats.sent,
	       (unsigned long long)stats.joined, (unsigned long long)stats.calls);
	send_queue_destroy(&q);
	close_ends(&e);
}

/* One datagram sent twice against loss is two on the way. */
static void twice_is_two(void **state)
{
	struct send_stats stats;
	struct send_queue *q;
	struct ends e;

	(void)state;
	open_ends(&e);
	assert_int_equal(send_queue_create(&q, LONGEST), GR_OK);
	add(q, &e, 0, 200);
	add(q, &e, 0, 200);
	add(q, &e, 1, LONGEST);
	add(q, &e, 1, 300);
	add(q, &e, 1, 300);
	send_queue_flush(q, e.out);
	take_all(&e);
	send_queue_stats(q, &stats);
	assert_int_equal(stats.sent, 5);
	assert_true(stats.joined <= 2);
	send_queue_destroy(&q);
	close_ends(&e);
}

/* A socket without checksums cannot cut, as a card without them: each goes by itself, none is lost. */
static void without_gso(void **state)
{
	struct send_stats stats;
	struct send_queue *q;
	struct ends e;
	int one = 1;

	(void)state;
	open_ends(&e);
	assert_int_equal(setsockopt(e.out, SOL_SOCKET, SO_NO_CHECK, &one, sizeof one), 0);
	assert_int_equal(send_queue_create(&q, LONGEST), GR_OK);
	for (int round = 0; round < 2; round++) {
		for (int i = 0; i < 20; i++)
			add(q, &e, i % WAYS, LONGEST);
		send_queue_flush(q, e.out);
		take_all(&e);
	}
	send_queue_stats(q, &stats);
	assert_int_equal(stats.sent, 40);
	assert_int_equal(stats.failed, 0);
	assert_int_equal(stats.joined, 0);
	/* The first three were tried together, one by one after that, and from then on as ever. */
	assert_true(stats.calls <= 3 + 20 + 2);
	send_queue_destroy(&q);
	close_ends(&e);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(fragments),
		cmocka_unit_test(any_sequence),
		cmocka_unit_test(twice_is_two),
		cmocka_unit_test(without_gso),
	};

	gr_log_init("test", GR_LOG_ERROR);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
