/*
 * Results: 0 is success, positive values are special outcomes that are not
 * failures, negative values are errors. Every function that returns `int`
 * and is not documented otherwise returns one of these.
 */
#ifndef GROTTO_BASE_RESULT_H
#define GROTTO_BASE_RESULT_H

enum gr_result {
	GR_OK = 0,
	GR_NOTHING = 1,      /* nothing to do, or nothing there yet */
	GR_ERR_NOMEM = -1,
	GR_ERR_IO = -2,      /* the operating system said no; errno holds why */
	GR_ERR_CONFIG = -3,  /* a layout or scene file is wrong */
	GR_ERR_FORMAT = -4,  /* bytes from outside do not have the right form */
	GR_ERR_AUTH = -5,    /* bytes from outside are not from a key holder */
	GR_ERR_VERSION = -6, /* the peer speaks another version */
	GR_ERR_RANGE = -7,   /* an argument or a value is outside its range */
	GR_ERR_UNSUPPORTED = -8, /* this machine or build cannot do it */
	GR_ERR_GL = -9,      /* GL or EGL failed; the log holds the driver's words */
	GR_ERR_TIMEOUT = -10,
	GR_ERR_STATE = -11,  /* not in this state of the object */
	GR_ERR_MISMATCH = -12, /* two parties hold different content */
	GR_ERR_REPLAY = -13,   /* bytes from outside have been here before, or were for somebody else */
};

/* The name of a result, for logs: "ok", "out of memory", ... Never NULL. */
const char *gr_result_name(int result);

/* Exit status of the daemons and the command. */
enum gr_exit {
	GR_EXIT_OK = 0,
	GR_EXIT_RUNTIME = 1,
	GR_EXIT_CONFIG = 2,
};

#endif
