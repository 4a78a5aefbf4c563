/* What the commands print alike: diagnostics as they are, results as lines. */
#ifndef GROTTO_TOOLS_SAY_H
#define GROTTO_TOOLS_SAY_H

#include "base/diag.h"

/* Errors and warnings to stderr, marked; notes to stdout. */
void say_diag(const struct gr_diag *diag);

#endif
