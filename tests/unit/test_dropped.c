/* What the log says of datagrams that were dropped: a line a minute, reason and peer. */
#include "tests/unit/unit.h"

#include "base/clock.h"
#include "base/result.h"
#include "daemon/dropped.h"

#include <unistd.h>

#define MINUTE_NS (60 * GR_NS_PER_S)

/* Standard error into a file, and back. */
struct capture {
	FILE *file;
	int before;
	char text[8192];
};

static void capture_start(struct capture *c)
{
	c->file = tmpfile();
	assert_non_null(c->file);
	fflush(stderr);
	c->before = dup(STDERR_FILENO);
	dup2(fileno(c->file), STDERR_FILENO);
}

static unsigned capture_end(struct capture *c)
{
	unsigned lines = 0;
	size_t len;

	dup2(c->before, STDERR_FILENO);
	close(c->before);
	rewind(c->file);
	len = fread(c->text, 1, sizeof c->text - 1, c->file);
	c->text[len] = '\0';
	fclose(c->file);
	for (size_t i = 0; i < len; i++)
		lines += c->text[i] == '\n';
	return lines;
}

static struct dropped dropped; /* large */

static void drop(int result, int peer, const char *name, uint16_t port, int64_t now_ns)
{
	static const uint8_t bytes[] = { 'G', 'F', 'D', 'P', 7 };
	struct net_address from;
	const struct dropped_datagram d = {
		.from = &from, .peer = peer, .name = name, .bytes = bytes, .len = sizeof bytes
	};

	assert_int_equal(net_address_parse("192.0.2.4", port, &from), GR_OK);
	dropped_add(&dropped, result, &d, now_ns);
}

static void one_line_a_minute_and_peer(void **state)
{
	struct capture c;

	(void)state;
	memset(&dropped, 0, sizeof dropped);
	capture_start(&c);
	for (int i = 0; i < 300; i++) {
		drop(GR_ERR_AUTH, 0, "node left", 4000, MINUTE_NS + i * GR_NS_PER_S / 6);
		drop(GR_ERR_AUTH, 1, "node right", 4001, MINUTE_NS + i * GR_NS_PER_S / 6);
		drop(GR_ERR_VERSION, 1, "node right", 4001, MINUTE_NS + i * GR_NS_PER_S / 6);
		/* A thousand strangers fill the log no faster than one. */
		drop(GR_ERR_AUTH, -1, NULL, (uint16_t)(5000 + i), MINUTE_NS + i * GR_NS_PER_S / 6);
	}
	assert_int_equal(capture_end(&c), 4);
	assert_non_null(strstr(c.text, "192.0.2.4:4000 (node left): signed with another key, or forged; "
				       "both sides need the same network.key_file (1 such"));
	assert_non_null(strstr(c.text, "192.0.2.4:4001 (node right): signed with another key"));
	assert_non_null(strstr(c.text, "192.0.2.4:5000 (not of this room): signed with another key (1"));
	assert_non_null(strstr(c.text, "(node right): it speaks protocol version 7, this daemon 4 (1"));
	/* The next minute tells how many there were. */
	capture_start(&c);
	drop(GR_ERR_AUTH, 0, "node left", 4000, 3 * MINUTE_NS);
	drop(GR_ERR_AUTH, 0, "node left", 4000, 3 * MINUTE_NS);
	assert_int_equal(capture_end(&c), 1);
	assert_non_null(strstr(c.text, "(300 such since the last line, 301 in all)"));
	/* And the end what none has told: 1 of left, 299 each of right and the strangers; of the version 299. */
	capture_start(&c);
	dropped_finish(&dropped);
	assert_int_equal(capture_end(&c), 2);
	assert_non_null(strstr(c.text, "dropped 599 more datagrams: signed with another key (902 in all)"));
	assert_non_null(strstr(c.text, "dropped 299 more datagrams: of another protocol version (300 in all)"));
	capture_start(&c);
	dropped_finish(&dropped);
	assert_int_equal(capture_end(&c), 0);
}

static void every_reason_has_words(void **state)
{
	struct capture c;

	(void)state;
	memset(&dropped, 0, sizeof dropped);
	capture_start(&c);
	for (int r = GR_ERR_REPLAY; r < 0; r++)
		drop(r, LAYOUT_MAX_NODES - 1, "the master", 4000, MINUTE_NS);
	drop(-1000, 1000, NULL, 4000, MINUTE_NS);
	assert_int_equal(capture_end(&c), -GR_ERR_REPLAY + 1);
	assert_non_null(strstr(c.text, "said before, or to somebody else"));
	assert_non_null(strstr(c.text, "of another session"));
	assert_non_null(strstr(c.text, "malformed data"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(one_line_a_minute_and_peer),
		cmocka_unit_test(every_reason_has_words),
	};

	gr_log_init("test", GR_LOG_WARNING);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
