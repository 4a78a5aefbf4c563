/*
 * Writes one JSON document (RFC 8259) into a caller's buffer, with sticky
 * failure: what does not fit is dropped and `ok` stays false. Numbers that
 * JSON cannot say (NaN, infinities) are written as null.
 */
#ifndef GROTTO_DAEMON_JSON_H
#define GROTTO_DAEMON_JSON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct json {
	char *text; /* NUL-terminated while ok */
	size_t size, len;
	bool ok;
	bool comma; /* the next member needs one before it */
};

struct json json_start(char *text, size_t size);
/* key NULL: an element of an array, or the document itself. */
void json_open(struct json *json, const char *key, char bracket); /* '{' or '[' */
void json_close(struct json *json, char bracket);                 /* '}' or ']' */
void json_string(struct json *json, const char *key, const char *value);
void json_bool(struct json *json, const char *key, bool value);
void json_u64(struct json *json, const char *key, uint64_t value);
void json_i64(struct json *json, const char *key, int64_t value);
void json_f64(struct json *json, const char *key, double value);
/* A 64 bit hash as 16 hexadecimal digits in a string: JSON readers lose bits of large numbers. */
void json_hash(struct json *json, const char *key, uint64_t value);

/* Could json_save write there? GR_OK, or a negative result and a line in the log. */
int json_try(const char *path);
/* Writes text to `path` by way of a file beside it, so that a reader sees all or nothing. */
int json_save(const char *path, const char *text, size_t len);

#endif
