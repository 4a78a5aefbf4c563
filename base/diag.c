#include "base/diag.h"

#include "base/log.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void gr_diag_add(struct gr_diag *diag, enum gr_severity severity, const char *file, int line,
		 const char *key, const char *format, ...)
{
	struct gr_diag_item *items;
	char where[1100] = "";
	char what[1024];
	char *text;
	va_list args;
	size_t size;

	if (severity == GR_DIAG_ERROR)
		diag->errors++;
	else if (severity == GR_DIAG_WARNING)
		diag->warnings++;
	if (file && line > 0)
		snprintf(where, sizeof where, "%s:%d: ", file, line);
	else if (file)
		snprintf(where, sizeof where, "%s: ", file);
	va_start(args, format);
	vsnprintf(what, sizeof what, format, args);
	va_end(args);
	size = strlen(where) + (key ? strlen(key) + 2 : 0) + strlen(what) + 1;
	text = malloc(size);
	items = realloc(diag->items, (diag->count + 1) * sizeof *items);
	if (items)
		diag->items = items;
	if (!text || !items) {
		/* The counts above still refuse the file. */
		gr_error("%s%s", where, what);
		free(text);
		return;
	}
	snprintf(text, size, "%s%s%s%s", where, key ? key : "", key ? ": " : "", what);
	diag->items[diag->count++] = (struct gr_diag_item){ severity, text };
}

void gr_diag_log(const struct gr_diag *diag)
{
	static const enum gr_log_level level[] = { GR_LOG_NOTICE, GR_LOG_WARNING, GR_LOG_ERROR };

	for (size_t i = 0; i < diag->count; i++)
		gr_log(level[diag->items[i].severity], "%s", diag->items[i].text);
}

void gr_diag_finish(struct gr_diag *diag)
{
	for (size_t i = 0; i < diag->count; i++)
		free(diag->items[i].text);
	free(diag->items);
	*diag = (struct gr_diag){ 0 };
}
