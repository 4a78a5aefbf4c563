/*
 * What each unit of work of the methods costs on this GPU (struct gi_costs):
 * the methods themselves, in a small room of our own, with a lamp that moves,
 * timed by queries. Some tenths of a second on a GPU; never begins another
 * part after CALIBRATE_SECONDS: what is left then is taken from gi_costs_usual,
 * at the pace of what was measured.
 *
 * GL thread only; a target must be current.
 */
#ifndef GROTTO_RENDERER_CALIBRATE_H
#define GROTTO_RENDERER_CALIBRATE_H

#include "renderer/gi/plan.h"
#include "renderer/gl/target.h"

#define CALIBRATE_SECONDS 2.0

/* GR_OK; GR_ERR_UNSUPPORTED without time stamps, GR_ERR_TIMEOUT for a GPU that hangs,
 * GR_ERR_NOMEM, GR_ERR_GL. */
int calibrate(struct gi_costs *out, struct target *target);
/*
 * The same, kept between runs (renderer/gi/costs_file.h): read where it can be,
 * else measured and written. Processes that start together measure one after
 * the other. Never fails: where nothing can be measured they are
 * gi_costs_usual, and the log says so. *out_from: for the log.
 */
void calibrate_kept(struct gi_costs *out, struct target *target, const char **out_from);

#endif
