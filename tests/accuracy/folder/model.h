/* The model of a foreign scene: where it is, or made from its quads and spheres. */
#ifndef GROTTO_TESTS_FOLDER_MODEL_H
#define GROTTO_TESTS_FOLDER_MODEL_H

#include "tests/accuracy/folder/json_walk.h"

#include <stdio.h>

/*
 * Writes a GLB of the objects (README's `quads` and `sphere`) to `path`, one mesh
 * a material, with the materials' names alone. GR_OK, GR_ERR_CONFIG with faults in
 * walk, GR_ERR_IO, GR_ERR_NOMEM.
 */
int model_write(struct json_walk *walk, json_object *objects, const char *path);
/*
 * Scene file entries that make every material of a GLB Lambert with its base
 * colour, both sides; false with faults.
 */
bool model_lambert(const char *path, struct gr_diag *diag, FILE *out);

/* For scene files: numbers that read as floats, quoted text. */
void write_floats(FILE *out, const char *key, const double *values, int count);
void write_text(FILE *out, const char *key, const char *text);

#endif
