/* What machines of a room compare, part by part; and which rooms may do without a key. */
#include "base/result.h"
#include "tests/unit/layout_text.h"

/* Without a key all of these are good, and with one any address is. */
static void test_unkeyed(void **state)
{
	static const char *const good[] = {
		"cast = \"multicast\"; interface = \"lo\"; group = \"239.1.1.1\"",
		"cast = \"auto\"; interface = \"lo\"; group = \"239.1.1.1\"",
		"cast = \"broadcast\"; group = \"127.255.255.255\"",
		"cast = \"broadcast\"; key_file = \"k\"; group = \"192.0.2.255\"",
		"cast = \"multicast\"; key_file = \"k\"; group = \"239.1.1.1\"",
	};
	struct gr_diag diag = { 0 };
	struct layout *layout;

	(void)state;
	for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
		char *text = unit_replace(layout_text, "mtu = 1500", good[i]);

		assert_int_equal(layout_text_parse(text, &layout, &diag), GR_OK);
		layout_destroy(&layout);
		free(text);
	}
	gr_diag_finish(&diag);
}

/* Where two files differ a part that has a name does, and it is the first that the file has. */
static void test_items(void **state)
{
	static const struct {
		const char *find, *replace, *first;
	} cases[] = {
		{ "name = \"floor\"", "name = \"ground\"", "walls[1] (floor)" },
		{ "lower_right = [1.5, 0.0, -1.5]", "lower_right = [1.6, 0.0, -1.5]", "walls[0] (front)" },
		{ "port = 5002", "port = 5012", "walls[0].nodes[1] (n2)" },
		{ "port = 5003", "port = 5013", "walls[1].nodes[0] (floor)" },
		{ "frame_hz = 60.0", "frame_hz = 61.0", "rates.frame_hz" },
		{ "frame_hz = 60.0", "evict_frames = 4", "rates.evict_frames" },
		{ "frame_hz = 60.0", "barrier_deadline_ms = 51.0", "rates.barrier_deadline_ms" },
		{ "mtu = 1500", "mtu = 1400", "network.mtu" },
		{ "mtu = 1500", "ttl = 2", "network.ttl" },
		{ "mtu = 1500", "loop = false", "network.loop" },
		{ "master_port = 5000", "master_port = 5009", "network.master_port" },
		{ "[0.0, 1.7, 0.5]", "[0.0, 1.7, 0.6]", "start" },
	};
	struct gr_item items[2][LAYOUT_ITEMS_MAX];
	struct gr_diag diag = { 0 };
	struct layout *layout, *other;
	uint8_t hash[32];
	size_t count, i;

	(void)state;
	assert_int_equal(layout_text_parse(layout_text, &layout, &diag), GR_OK);
	count = layout_items(layout, items[0], LAYOUT_ITEMS_MAX, hash);
	assert_memory_equal(hash, layout->hash, sizeof hash);
	for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
		char *text = unit_replace(layout_text, cases[k].find, cases[k].replace);

		assert_int_equal(layout_text_parse(text, &other, &diag), GR_OK);
		assert_int_equal(layout_items(other, items[1], LAYOUT_ITEMS_MAX, hash), count);
		for (i = 0; i < count && !memcmp(items[0][i].digest, items[1][i].digest, GR_ITEM_DIGEST); i++)
			;
		assert_true(i < count);
		assert_string_equal(items[0][i].name, cases[k].first);
		layout_destroy(&other);
		free(text);
	}
	/* No room: counted all the same, and nothing else written. */
	memset(items[1], 0, sizeof items[1]);
	assert_int_equal(layout_items(layout, items[1], 2, hash), count);
	assert_int_equal(items[1][2].name[0], 0);
	layout_destroy(&layout);
	gr_diag_finish(&diag);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_items), cmocka_unit_test(test_unkeyed),
	};

	return cmocka_run_group_tests_name("layout items", tests, NULL, NULL);
}
