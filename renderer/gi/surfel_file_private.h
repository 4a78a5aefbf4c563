/*
 * Inside of surfel files: the checks of what a file holds (surfel_file_check.c).
 * They return NULL, or what is wrong.
 */
#ifndef GROTTO_RENDERER_GI_SURFEL_FILE_PRIVATE_H
#define GROTTO_RENDERER_GI_SURFEL_FILE_PRIVATE_H

#include "renderer/gi/surfel_set.h"

#define SURFEL_HEAD_BYTES 256
#define SURFEL_SUM_BYTES 32

/* Counts and lengths, before there are arrays: that these can be allocated and their sizes added. */
const char *surfel_check_head(const struct surfel_set *set);
const char *surfel_check_arrays(const struct surfel_set *set);

#endif
