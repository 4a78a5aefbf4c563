/*
 * Command lines of the daemons: one table says what an option is called,
 * what it takes, its range and its help; it drives parsing and --help.
 */
#ifndef GROTTO_DAEMON_OPTIONS_H
#define GROTTO_DAEMON_OPTIONS_H

#include <stddef.h>

enum option_kind {
	OPTION_TEXT,  /* const char *: points into argv */
	OPTION_INT,   /* int, within min..max */
	OPTION_REAL,  /* double, within min..max */
	OPTION_FLAG,  /* bool, true when given */
	OPTION_CHOICE /* int: the index of the word in `choices` */
};

struct option_spec {
	const char *name; /* long form without dashes */
	enum option_kind kind;
	size_t offset;       /* of the value in the caller's struct */
	const char *arg;     /* what --help calls the value, NULL for a flag */
	const char *help;
	int min, max;
	const char *const *choices; /* ends with NULL */
	const char *also;    /* another name of the same option, not in --help, or NULL */
};

enum options_outcome { OPTIONS_RUN, OPTIONS_DONE, OPTIONS_WRONG };

/*
 * Parses argv into `values`, which holds the defaults before. OPTIONS_DONE
 * after --help or --version (printed on stdout), OPTIONS_WRONG with a line in
 * the log that says what would be right.
 */
enum options_outcome command_line_parse(const char *program, const char *summary,
					const struct option_spec *specs, size_t count, void *values,
					int argc, char **argv);

/* What both daemons take. */
struct common_options {
	const char *layout, *scene, *key, *user, *report;
	int log_level; /* enum gr_log_level */
	int deadline_ms; /* 0: the layout's */
	int priority;    /* SCHED_RR, 0: ordinary */
};

struct master_options {
	struct common_options common;
	const char *control; /* path, "none", or NULL: the layout's */
	const char *record;  /* file, or NULL */
	const char *replay;  /* file, or NULL: trackers and settings */
	double speed, from_s; /* of the replay */
	int recording;
	_Bool step, other_layout;
	const char *state;   /* file in which the room's state is left for the next master, or NULL */
	int frames;          /* 0: for ever */
	_Bool frame_clock, wait_all, standby;
	const char *address; /* which of the layout's masters, or NULL: see master_main.c */
	int expect;
};

enum node_target_choice { NODE_TARGET_LAYOUT, NODE_TARGET_HEADLESS, NODE_TARGET_WINDOW, NODE_TARGET_FULLSCREEN };
struct node_options {
	struct common_options common;
	const char *node, *pictures, *display, *swap_log;
	int target; /* enum node_target_choice */
	int gpu;    /* -2: the layout's */
	int every;
	_Bool once, exr;
};

/* Parsed and checked for what must be there. */
enum options_outcome master_options_parse(struct master_options *options, int argc, char **argv);
enum options_outcome node_options_parse(struct node_options *options, int argc, char **argv);

#endif
