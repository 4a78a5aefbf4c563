/* The control socket's requests about faults, alike in both daemons. */
#include "daemon/control.h"
#include "daemon/faults.h"

#include "base/result.h"

#include <string.h>

void faults_answer(struct faults *faults, const char *layout_path, char *const *words, int count,
		   char *answer, size_t size)
{
	struct json json = json_start(answer, size);
	char why[256] = "write: faults, faults set NAME VALUE..., faults clear, faults kill";
	int r = GR_ERR_RANGE;

	if (!faults) {
		control_refuse(answer, size, "%.120s does not allow faults; test = { faults = true; } in it, and a "
			       "restart, would", layout_path ? layout_path : "the layout");
		return;
	}
	if (count == 1) {
		r = GR_OK;
	} else if (!strcmp(words[1], "set")) {
		r = faults_set(faults, words + 2, count - 2, why, sizeof why);
	} else if (!strcmp(words[1], "clear") && count == 2) {
		faults_clear(faults);
		r = GR_OK;
	} else if (!strcmp(words[1], "kill") && count == 2) {
		faults_kill(faults);
		r = GR_OK;
	}
	if (r < 0) {
		control_refuse(answer, size, "%s", why);
		return;
	}
	json_open(&json, NULL, '{');
	json_bool(&json, "ok", true);
	faults_write_json(faults, &json, "faults");
	json_close(&json, '}');
}
