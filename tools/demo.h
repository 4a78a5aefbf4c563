/*
 * `grotto demo` in its parts: the plan (demo_plan.h), the run, the pictures
 * and the summary. One thread.
 */
#ifndef GROTTO_TOOLS_DEMO_H
#define GROTTO_TOOLS_DEMO_H

#include "config/layout.h"
#include "config/scene_file.h"
#include "tools/children.h"

#include <stdbool.h>
#include <stdint.h>

/* `grotto replay`: the master's frames come from a recording. */
struct demo_replay {
	const char *file;
	int recording;
	float speed, from_s;
	bool fast, step, other_layout;
	bool room; /* the nodes are the layout's own, and run already: none is started */
	uint8_t layout_hash[32]; /* recorded */
};

struct demo_options {
	const char *layout, *scene, *out;
	const char *record; /* the master records into this file; NULL: it does not */
	const struct demo_replay *replay; /* NULL: a simulated visitor, or what the layout tracks */
	int frames, every;
	int deadline_ms; /* of the swap barrier */
	int patience_s;  /* without a new frame for so long: it hangs */
	float pixels_scale, rate_hz;
	bool exr, window, stereo;
};

struct demo {
	const char *command; /* "grotto demo": for messages */
	struct demo_options options;
	struct layout *layout;      /* as planned: what the daemons run */
	struct scene_file *scene;
	char *layout_path;          /* of the planned layout, in the out folder */
	char *scene_path;           /* absolute */
	char socket_folder[64];     /* made for this run; "" while there is none */
	char socket[96];
	struct children children;   /* 0 the master, then a node per layout node */
	bool interrupted, stalled;
	int64_t took_ns;            /* from the first process to the last one's end */
};

/*
 * Plans, runs and judges what the options say, and frees what it took. An exit
 * status.
 */
int demo_main(struct demo *demo);
/* Frames that the master says it replayed; -1 when it left no report. One line about them. */
int demo_replayed(const struct demo *demo);

/* out/NAME.SUFFIX, caller frees; NULL without memory. */
char *demo_path(const struct demo *demo, const char *name, const char *suffix);
/* What the log and the report of a node are called: no node can be named like the master's. */
void demo_node_file(const struct layout_node *node, char name[LAYOUT_NAME_MAX + 8]);

/*
 * Starts the daemons, waits for their end, shows how far they are. GR_OK
 * when all ended (well or not: see children), GR_ERR_IO or GR_ERR_NOMEM when
 * they could not be started. None of them runs when it returns.
 */
int demo_run(struct demo *demo);

/* Removes the nodes' pictures of an earlier run from the out folder. */
void demo_clear_pictures(const struct demo *demo);
/*
 * Puts the last pictures of the nodes together: OUT/wall-NAME.png for each
 * wall (the left eye's), and OUT/room.png. GR_OK, or an error with its line on
 * stderr.
 */
int demo_room(const struct demo *demo);

/*
 * Reads the reports, writes OUT/summary.json, prints the table. Returns how
 * many faults there were (each with a line on stderr): nodes that missed
 * frames, differed or died; -1 when the summary could not be written.
 */
int demo_summary(const struct demo *demo);

#endif
