/*
 * Looking into JSON that somebody else wrote: every fault is named by its place
 * in the file, and what is not known is refused by its name.
 */
#ifndef GROTTO_TESTS_FOLDER_JSON_WALK_H
#define GROTTO_TESTS_FOLDER_JSON_WALK_H

#include "base/diag.h"

#include <json-c/json.h>
#include <stdbool.h>

struct json_walk {
	const char *path; /* of the file */
	struct gr_diag *diag;
	bool failed;
};

/* Adds an error at `where` ("materials.white") and fails the walk. */
void json_fault(struct json_walk *walk, const char *where, const char *format, ...)
	__attribute__((format(printf, 3, 4)));
/* Faults for each key of the object that is not among `known` (ends with NULL). */
void json_only(struct json_walk *walk, const char *where, json_object *object,
	       const char *const *known);
/* A member of that type; NULL with a fault when it is another, or missing and needed. */
json_object *json_member(struct json_walk *walk, const char *where, json_object *object,
			 const char *key, json_type type, bool needed);
/* Finite numbers. A missing one that is not needed stays as it was. */
bool json_number(struct json_walk *walk, const char *where, json_object *object, const char *key,
		 bool needed, double *out);
bool json_numbers(struct json_walk *walk, const char *where, json_object *object, const char *key,
		  bool needed, int count, double *out);
/* Of an array; a fault when it is none of `count` finite numbers. */
bool json_array_numbers(struct json_walk *walk, const char *where, json_object *array, int count,
			double *out);
/* NULL with a fault when it is missing. Lives as long as the object. */
const char *json_text(struct json_walk *walk, const char *where, json_object *object,
		      const char *key);
bool json_flag(struct json_walk *walk, const char *where, json_object *object, const char *key);
/* A whole file of JSON text, or a GLB's JSON part. NULL with a fault. */
json_object *json_load(struct json_walk *walk);

#endif
