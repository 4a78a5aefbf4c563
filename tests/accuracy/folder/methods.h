/* What the reference and the renderer's methods make of a folder's camera. */
#ifndef GROTTO_TESTS_FOLDER_METHODS_H
#define GROTTO_TESTS_FOLDER_METHODS_H

#include "renderer/gl/target.h"
#include "tests/accuracy/folder/folder.h"

#include <stdint.h>

struct made {
	struct image picture, indirect;
	struct image error, indirect_error; /* no data: exact, or not known */
	uint64_t nonfinite;
	double seconds; /* with building what the method needs */
};
void made_finish(struct made *made);

/*
 * Path traced with that many samples a pixel, on as many threads (0: all cores);
 * one pixel for `coarse` x `coarse` of the folder's.
 */
int reference_make(const struct folder *folder, size_t camera, int coarse, int samples, int threads,
		   struct made *out);
/*
 * By a renderer's method, drawn until its light is steady. Sixteen pixels for one
 * (fewer of large pictures): its pictures are points, the folder's are means over
 * pixels.
 */
int method_make(struct folder *folder, size_t camera, enum scene_gi_method method,
		struct target *target, struct made *out);
/* Side that the target must have. */
int method_target_side(const struct folder *folder);

/* The methods, in the order of the table; NULL at the end. */
struct method {
	const char *name;
	enum scene_gi_method method;
};
extern const struct method methods[];
/* Why a method has nothing to say of this folder; NULL: it has. */
const char *method_unsuited(const struct folder *folder, enum scene_gi_method method);

#endif
