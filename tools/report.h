/*
 * Reads what the daemons write about themselves: JSON objects of known
 * members, from files that may be missing, cut short or of another version.
 * What is not there reads as 0, NULL or "?" and never fails.
 */
#ifndef GROTTO_TOOLS_REPORT_H
#define GROTTO_TOOLS_REPORT_H

#include <json-c/json.h>
#include <stddef.h>
#include <stdint.h>

/* The object in the file, or NULL: missing, over 1 MiB, no JSON object. Free: json_object_put. */
struct json_object *report_load(const char *path);

/* Members by a dotted path: "wire.bytes_in". */
struct json_object *report_member(struct json_object *object, const char *path);
int64_t report_count(struct json_object *object, const char *path);
double report_number(struct json_object *object, const char *path);
const char *report_text(struct json_object *object, const char *path); /* the object's own */

/* The element of the array at path whose "name" is that, or NULL. */
struct json_object *report_named(struct json_object *object, const char *path, const char *name);

#endif
