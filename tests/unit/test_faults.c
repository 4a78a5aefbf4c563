/* Faults on purpose: what is set befalls datagrams, in the shares asked for, and no more. */
#include "tests/unit/unit.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"
#include "daemon/faults.h"

#include <poll.h>
#include <unistd.h>

#define SENT 4000

struct pair {
	struct layout layout;
	struct layout_node nodes[2];
	struct net *master, *node;
	struct loop *loop;
	struct faults *faults;
	unsigned got, disorder; /* disorder: times that a number was below the one before */
	uint32_t last;
	uint32_t first[8]; /* numbers of the first that came */
	int64_t waited_ns; /* the least, from sending */
};

static void open_pair(struct pair *p, uint64_t salt)
{
	static uint16_t port;

	memset(p, 0, sizeof *p);
	port = (uint16_t)(port ? port + 3 : 21000 + getpid() % 1000 * 40);
	p->layout.nodes = p->nodes;
	p->layout.node_count = 2;
	p->layout.network.master_address = p->nodes[0].address = p->nodes[1].address = (char *)"127.0.0.1";
	p->layout.network.master_port = port;
	p->nodes[0].port = (uint16_t)(port + 1);
	p->nodes[1].port = (uint16_t)(port + 2);
	p->layout.network.mtu = 1500;
	assert_int_equal(net_open_master(&p->master, &p->layout, 0), GR_OK);
	assert_int_equal(net_open_node(&p->node, &p->layout, 0), GR_OK);
	assert_int_equal(loop_create(&p->loop), GR_OK);
	assert_int_equal(faults_create(&p->faults, p->loop, net_datagram_max(&p->layout.network), salt), GR_OK);
	p->waited_ns = INT64_MAX;
}

static void close_pair(struct pair *p)
{
	faults_destroy(&p->faults);
	loop_destroy(&p->loop);
	net_close(&p->master);
	net_close(&p->node);
}

static void hear(void *ctx, const uint8_t *bytes, size_t len, const struct net_address *from,
		 int64_t arrived_ns)
{
	struct pair *p = ctx;
	uint32_t number;
	int64_t sent_ns;

	assert_int_equal(len, sizeof number + sizeof sent_ns);
	assert_int_equal(net_peer(p->master, from), 0);
	memcpy(&number, bytes, sizeof number);
	memcpy(&sent_ns, bytes + sizeof number, sizeof sent_ns);
	p->disorder += p->got > 0 && number < p->last;
	p->last = number;
	if (p->got < sizeof p->first / sizeof *p->first)
		p->first[p->got] = number;
	p->got++;
	p->waited_ns = arrived_ns - sent_ns < p->waited_ns ? arrived_ns - sent_ns : p->waited_ns;
}

static void take(void *ctx)
{
	struct pair *p = ctx;
	int fds[2];

	net_fds(p->master, fds);
	faults_receive(p->faults, p->master, fds[0], 1000, hear, p);
}

/* From the node to the master, whose side is disturbed; then until nothing is held. */
static void send_all(struct pair *p, unsigned count)
{
	faults_on_due(p->faults, take, p);
	for (uint32_t i = 0; i < count; i++) {
		int64_t now_ns = gr_clock_now(&gr_clock_monotonic);
		uint8_t bytes[sizeof i + sizeof now_ns];

		memcpy(bytes, &i, sizeof i);
		memcpy(bytes + sizeof i, &now_ns, sizeof now_ns);
		net_send(p->node, 0, bytes, sizeof bytes);
		net_flush(p->node);
		take(p);
	}
	for (int i = 0; i < 20; i++) {
		while (loop_once(p->loop, 5) == GR_OK)
			;
		take(p);
	}
}

static int set(struct pair *p, const char *line)
{
	char copy[256], why[256] = "", *words[16];
	int count = 0;

	snprintf(copy, sizeof copy, "%s", line);
	for (char *word = strtok(copy, " "); word; word = strtok(NULL, " "))
		words[count++] = word;
	if (faults_set(p->faults, words, count, why, sizeof why) < 0) {
		assert_true(why[0]);
		return -1;
	}
	return 0;
}

static void test_none(void **state)
{
	struct pair p;

	(void)state;
	open_pair(&p, 0);
	assert_false(faults_on(p.faults));
	assert_false(faults_on(NULL));
	faults_frame(NULL, 1);
	send_all(&p, 100);
	assert_int_equal(p.got, 100);
	assert_int_equal(p.disorder, 0);
	close_pair(&p);
}

static void test_shares(void **state)
{
	static const struct { const char *line; double got; } cases[] = {
		{ "loss_in 5 seed 7", 0.95 }, { "duplicate 10 seed 7", 1.10 }, { "loss_in 100", 0 },
		{ "loss_in 20 duplicate 50 seed 7", 1.20 },
	};

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct pair p;
		double share;

		open_pair(&p, 1);
		assert_int_equal(set(&p, cases[i].line), 0);
		send_all(&p, SENT);
		share = (double)p.got / SENT;
		printf("# %s: %.4f arrived, %.2f expected\n", cases[i].line, share, cases[i].got);
		/* Four standard deviations of 4000 draws at a half are 0.032. */
		assert_true(fabs(share - cases[i].got) < 0.032);
		assert_int_equal(p.disorder, 0);
		close_pair(&p);
	}
}

static void test_seed(void **state)
{
	struct pair p[3];

	(void)state;
	for (int i = 0; i < 3; i++) {
		open_pair(&p[i], i == 2 ? 5 : 1);
		assert_int_equal(set(&p[i], "loss_in 50 seed 99"), 0);
		send_all(&p[i], 200);
		close_pair(&p[i]);
	}
	assert_int_equal(p[0].got, p[1].got);
	assert_memory_equal(p[0].first, p[1].first, sizeof p[0].first);
	assert_memory_not_equal(p[0].first, p[2].first, sizeof p[0].first); /* another daemon */
}

static unsigned overflowed(const struct pair *p)
{
	char text[2048];
	struct json json = json_start(text, sizeof text);
	const char *at;
	unsigned count = 0;

	faults_write_json(p->faults, &json, NULL);
	at = strstr(text, "\"overflowed\":");
	assert_non_null(at);
	assert_int_equal(sscanf(at, "\"overflowed\":%u", &count), 1);
	return count;
}

static void test_late(void **state)
{
	struct pair p;

	(void)state;
	open_pair(&p, 0);
	assert_int_equal(set(&p, "delay_ms 3"), 0);
	send_all(&p, 300);
	assert_int_equal(p.got, 300);
	assert_int_equal(p.disorder, 0); /* delay alone keeps the order */
	assert_true(p.waited_ns >= 3 * GR_NS_PER_MS - 50000);
	faults_clear(p.faults);
	p.got = 0;
	assert_int_equal(set(&p, "jitter_ms 5 seed 3"), 0);
	send_all(&p, 300);
	assert_int_equal(p.got, 300);
	assert_true(p.disorder > 0);
	faults_clear(p.faults);
	p.got = p.disorder = 0;
	assert_int_equal(set(&p, "reorder 5 seed 3"), 0);
	send_all(&p, 300);
	assert_int_equal(p.got, 300);
	assert_true(p.disorder > 0);
	/* More than can be held is lost and counted. */
	faults_clear(p.faults);
	p.got = 0;
	assert_int_equal(set(&p, "delay_ms 50"), 0);
	send_all(&p, FAULTS_HELD + 100);
	assert_int_equal(p.got + overflowed(&p), FAULTS_HELD + 100);
	assert_true(p.got >= FAULTS_HELD);
	close_pair(&p);
}

static void test_out(void **state)
{
	struct pair p;
	struct net_stats stats;

	(void)state;
	open_pair(&p, 0);
	faults_send(NULL, p.master, NET_TO_ALL, 2, (const uint8_t *)"x", 1);
	net_flush(p.master);
	net_stats(p.master, &stats);
	assert_int_equal(stats.sent + stats.send_failed, 2);
	assert_int_equal(set(&p, "loss_out 50 seed 1"), 0);
	for (int i = 0; i < 500; i++)
		faults_send(p.faults, p.master, NET_TO_ALL, 2, (const uint8_t *)"x", 1);
	net_flush(p.master);
	net_stats(p.master, &stats);
	printf("# loss_out 50: %u of 1000 left\n", (unsigned)(stats.sent + stats.send_failed - 2));
	assert_true(stats.sent + stats.send_failed > 430 && stats.sent + stats.send_failed < 570);
	close_pair(&p);
}

static void test_stall(void **state)
{
	struct pair p;
	int64_t before_ns, took_ns;

	(void)state;
	open_pair(&p, 0);
	assert_int_equal(set(&p, "stall_ms 20"), 0);
	before_ns = gr_clock_now(&gr_clock_monotonic);
	faults_frame(p.faults, 11);
	took_ns = gr_clock_now(&gr_clock_monotonic) - before_ns;
	assert_true(took_ns >= 20 * GR_NS_PER_MS);
	assert_false(faults_on(p.faults)); /* once */
	assert_int_equal(set(&p, "stall_ms 20 stall_every 5"), 0);
	before_ns = gr_clock_now(&gr_clock_monotonic);
	faults_frame(p.faults, 11);
	assert_true(gr_clock_now(&gr_clock_monotonic) - before_ns < 15 * GR_NS_PER_MS);
	faults_frame(p.faults, 15);
	assert_true(gr_clock_now(&gr_clock_monotonic) - before_ns >= 20 * GR_NS_PER_MS);
	assert_true(faults_on(p.faults));
	close_pair(&p);
}

static void test_words(void **state)
{
	static const char *const bad[] = { "", "loss_in", "loss_in x", "loss_in -1", "loss_in 100.1", "loss_in nan",
					   "loss_in inf", "loss_in 5x", "no_such 5", "seed -1", "seed 1.5",
					   "seed 99999999999999999999", "loss_in 5 delay_ms 1001", "loss_in 5 seed" };
	struct pair p;
	char text[2048];
	struct json json = json_start(text, sizeof text);
	char *const unknown[] = { (char *)"faults", (char *)"what" };

	(void)state;
	open_pair(&p, 0);
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		assert_int_equal(set(&p, bad[i]), -1);
		assert_false(faults_on(p.faults)); /* all or none */
	}
	assert_int_equal(set(&p, "loss_in 1e1 seed 18446744073709551615"), 0);
	faults_write_json(p.faults, &json, NULL);
	assert_true(json.ok);
	assert_non_null(strstr(text, "\"loss_in\":10,"));
	faults_answer(NULL, "/etc/room.cave", unknown, 1, text, sizeof text);
	assert_non_null(strstr(text, "/etc/room.cave does not allow faults"));
	faults_answer(p.faults, "/etc/room.cave", unknown, 2, text, sizeof text);
	assert_non_null(strstr(text, "\"ok\":false"));
	close_pair(&p);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_none), cmocka_unit_test(test_shares), cmocka_unit_test(test_seed),
		cmocka_unit_test(test_late), cmocka_unit_test(test_out), cmocka_unit_test(test_stall),
		cmocka_unit_test(test_words),
	};

	gr_log_init("test_faults", GR_LOG_ERROR);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
