#include "daemon/json.h"

#include "base/log.h"
#include "base/result.h"

#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void put(struct json *json, const char *bytes, size_t n)
{
	if (!json->ok || json->size - json->len <= n) {
		json->ok = false;
		return;
	}
	memcpy(json->text + json->len, bytes, n);
	json->len += n;
	json->text[json->len] = '\0';
}

static void put_format(struct json *json, const char *format, ...)
	__attribute__((format(printf, 2, 3)));
static void put_format(struct json *json, const char *format, ...)
{
	char text[64];
	va_list args;
	int n;

	va_start(args, format);
	n = vsnprintf(text, sizeof text, format, args);
	va_end(args);
	put(json, text, (size_t)n);
}

static void put_quoted(struct json *json, const char *value)
{
	put(json, "\"", 1);
	for (const char *p = value; *p; p++) {
		unsigned char c = (unsigned char)*p;
		/* DEL and bytes beyond ASCII may not be UTF-8: written as code points. */
		if (c == '"' || c == '\\')
			put_format(json, "\\%c", c);
		else if (c < 0x20 || c >= 0x7f)
			put_format(json, "\\u%04x", c);
		else
			put(json, p, 1);
	}
	put(json, "\"", 1);
}

static void put_key(struct json *json, const char *key)
{
	if (json->comma)
		put(json, ",", 1);
	if (key) {
		put_quoted(json, key);
		put(json, ":", 1);
	}
	json->comma = true;
}

struct json json_start(char *text, size_t size)
{
	if (size > 0)
		text[0] = '\0';
	return (struct json){ text, size, 0, size > 0, false };
}

void json_open(struct json *json, const char *key, char bracket)
{
	put_key(json, key);
	put(json, &bracket, 1);
	json->comma = false;
}

void json_close(struct json *json, char bracket)
{
	put(json, &bracket, 1);
	json->comma = true;
}

void json_string(struct json *json, const char *key, const char *value)
{
	put_key(json, key);
	if (value)
		put_quoted(json, value);
	else
		put(json, "null", 4);
}

void json_bool(struct json *json, const char *key, bool value)
{
	put_key(json, key);
	put_format(json, "%s", value ? "true" : "false");
}

void json_u64(struct json *json, const char *key, uint64_t value)
{
	put_key(json, key);
	put_format(json, "%" PRIu64, value);
}

void json_i64(struct json *json, const char *key, int64_t value)
{
	put_key(json, key);
	put_format(json, "%" PRId64, value);
}

void json_f64(struct json *json, const char *key, double value)
{
	put_key(json, key);
	if (isfinite(value))
		put_format(json, "%.9g", value);
	else
		put(json, "null", 4);
}

void json_hash(struct json *json, const char *key, uint64_t value)
{
	put_key(json, key);
	put_format(json, "\"%016" PRIx64 "\"", value);
}

/* The file beside `path` that becomes it. */
static int name_beside(const char *path, char beside[PATH_MAX])
{
	int n = snprintf(beside, PATH_MAX, "%s.%ld.tmp", path, (long)getpid());

	if (n >= 0 && n < PATH_MAX)
		return GR_OK;
	gr_error("%s: the path is too long", path);
	return GR_ERR_RANGE;
}

int json_try(const char *path)
{
	char beside[PATH_MAX];
	struct stat status;
	int r = name_beside(path, beside);
	FILE *file;

	if (r < 0)
		return r;
	if (stat(path, &status) == 0 && S_ISDIR(status.st_mode)) {
		gr_error("%s: cannot be written: %s", path, strerror(EISDIR));
		return GR_ERR_IO;
	}
	file = fopen(beside, "we");
	if (!file) {
		gr_error("%s: cannot be written: %s", path, strerror(errno));
		return GR_ERR_IO;
	}
	fclose(file);
	unlink(beside);
	return GR_OK;
}

int json_save(const char *path, const char *text, size_t len)
{
	char beside[PATH_MAX];
	FILE *file;
	int r = name_beside(path, beside);

	if (r < 0)
		return r;
	r = GR_ERR_IO;
	file = fopen(beside, "we");
	if (!file)
		goto out;
	if (fwrite(text, 1, len, file) == len && fputc('\n', file) != EOF)
		r = GR_OK;
	if (fclose(file) != 0)
		r = GR_ERR_IO;
	if (r == GR_OK && rename(beside, path) < 0)
		r = GR_ERR_IO;
out:
	if (r < 0) {
		gr_error("%s: cannot be written: %s", path, strerror(errno));
		unlink(beside);
	}
	return r;
}
