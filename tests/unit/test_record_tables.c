/* Session records as tables: one line an entry, and as many columns in each as in the first. */
#include "tests/unit/record_files.h"

#include "base/result.h"
#include "record/csv.h"

#include <unistd.h>

static size_t columns(const char *line)
{
	bool quoted = false;
	size_t n = 1;

	for (; *line; line++) {
		quoted = quoted != (*line == '"');
		n += *line == ',' && !quoted;
	}
	return n;
}

static void check_tables(uint64_t table_hash)
{
	static const size_t lines_right[RECORD_TABLES] = { 201, 201, 201, 401, 2 };
	FILE *files[RECORD_TABLES];
	char *texts[RECORD_TABLES];
	size_t sizes[RECORD_TABLES];
	struct gr_diag diag = { 0 };
	struct record_reader *reader;
	struct record_maker m;
	char path[RECORDING_PATH_BYTES];

	record_maker_init(&m, 60, unit_random_start("tables"));
	m.session.table_hash = table_hash;
	recording_make(&m, recording_path("t.rec", path), 200, true);
	for (int i = 0; i < RECORD_TABLES; i++)
		files[i] = open_memstream(&texts[i], &sizes[i]);
	assert_int_equal(record_reader_open(&reader, path, &diag), GR_OK);
	assert_int_equal(record_csv_write(reader, 1, files), GR_OK);
	record_reader_destroy(&reader);
	assert_int_equal(record_reader_open(&reader, path, &diag), GR_OK);
	assert_int_equal(record_csv_write(reader, 2, (FILE *const[RECORD_TABLES]){ NULL }), GR_NOTHING);
	record_reader_destroy(&reader);
	for (int i = 0; i < RECORD_TABLES; i++) {
		size_t lines = 0, right = 0;
		fclose(files[i]);
		for (char *line = strtok(texts[i], "\n"); line; line = strtok(NULL, "\n"), lines++) {
			right = lines ? right : columns(line);
			assert_int_equal(columns(line), right);
		}
		assert_int_equal(lines, lines_right[i]);
		free(texts[i]);
	}
	record_maker_finish(&m);
	unlink(path);
}

static void tables_have_their_columns(void **state)
{
	(void)state;
	check_tables(param_table_hash());
	check_tables(1); /* of another grotto: the states cannot be known */
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(tables_have_their_columns),
	};

	return cmocka_run_group_tests(tests, recording_folder_make, recording_folder_remove);
}
