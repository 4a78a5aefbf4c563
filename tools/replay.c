/* grotto replay: shows a recording again, on nodes of this machine or on the room's. */
#include "base/result.h"
#include "record/player.h"
#include "tools/cli.h"
#include "tools/command.h"
#include "tools/demo.h"
#include "tools/say.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Files of the recording that a person did not name. */
struct recorded {
	struct record_session session;
	uint64_t frames;
};

/* What is to be replayed, frame by frame: so that the run's length is known, and its faults beforehand. */
static int look(const struct demo_replay *replay, struct recorded *out)
{
	const struct record_player_params params = { replay->recording,
						     llrint((double)replay->from_s * 1e9) };
	struct record_player *player = NULL;
	struct param_state *state = NULL;
	struct gr_diag diag = { 0 };
	struct record_play play;
	int r = record_player_open(&player, replay->file, &params, &diag);

	if (r == GR_OK)
		r = param_state_create(&state);
	if (r == GR_OK)
		out->session = *record_player_session(player);
	while (r == GR_OK && (r = record_player_next(player, state, &play)) == GR_OK)
		out->frames++;
	if (r == GR_NOTHING && out->frames == 0)
		gr_diag_add(&diag, GR_DIAG_ERROR, replay->file, 0, NULL, "holds no frame%s",
			    replay->from_s > 0 ? " after that time" : "");
	say_diag(&diag);
	gr_diag_finish(&diag);
	record_player_destroy(&player);
	param_state_destroy(&state);
	return r == GR_NOTHING && out->frames > 0 ? GR_OK : GR_ERR_CONFIG;
}

static int replay(struct demo *demo, struct demo_replay *what, struct recorded *recorded)
{
	struct demo_options *o = &demo->options;

	if (look(what, recorded) != GR_OK)
		return GR_EXIT_CONFIG;
	memcpy(what->layout_hash, recorded->session.layout_hash, sizeof what->layout_hash);
	if (!o->layout && recorded->session.layout_path[0])
		o->layout = recorded->session.layout_path;
	if (!o->scene && recorded->session.scene_path[0])
		o->scene = recorded->session.scene_path;
	if (!o->layout || !o->scene) {
		fprintf(stderr, "grotto replay: the recording does not say where its %s was: give --%s FILE\n",
			o->layout ? "scene" : "layout", o->layout ? "scene" : "layout");
		return GR_EXIT_CONFIG;
	}
	if (o->frames == 0 || (uint64_t)o->frames > recorded->frames)
		o->frames = recorded->frames > 10000000 ? 10000000 : (int)recorded->frames;
	/* Whether it runs in real time: for the summary. */
	o->rate_hz = what->fast ? 0 : recorded->session.frame_hz;
	o->replay = what;
	if (o->deadline_ms == 0 && !what->room)
		o->deadline_ms = 600000;
	return demo_main(demo);
}

static const char *wrong(const struct demo_replay *r, const struct demo_options *o, int words)
{
	if (words != 1)
		return "give the FILE of a recording";
	if (r->fast + r->step > 1)
		return "give one of --fast and --step";
	if (r->room && (o->window || o->every || o->exr || o->pixels_scale != 1))
		return "--room shows it on the room's own nodes: --window, --pixels-scale, --every and --exr are "
		       "of nodes of this machine";
	return NULL;
}

int command_replay(int argc, char **argv)
{
	struct demo_replay r = { .recording = 1, .speed = 1 };
	struct demo d = { .command = "grotto replay",
			  .options = { .out = "grotto-replay", .patience_s = 600, .pixels_scale = 1 } };
	struct demo_options *o = &d.options;
	struct recorded recorded = { 0 };
	const struct cli_option options[] = {
		{ "layout", 0, CLI_TEXT, &o->layout, 0, 0, "FILE", "the cave (where the recording had it)" },
		{ "scene", 0, CLI_TEXT, &o->scene, 0, 0, "FILE", "what is in it (where the recording had it)" },
		{ "speed", 0, CLI_REAL, &r.speed, 0.001, 1000, "X", "times the recorded one (1)" },
		{ "fast", 0, CLI_FLAG, &r.fast, 0, 0, NULL, "as fast as all walls can" },
		{ "step", 0, CLI_FLAG, &r.step, 0, 0, NULL,
		  "a frame for each line of the standard input, until its end" },
		{ "from", 0, CLI_REAL, &r.from_s, 0, 10000000, "S",
		  "begin so many seconds after the recording did" },
		{ "frames", 0, CLI_INT, &o->frames, 1, 10000000, "N", "no more than so many" },
		{ "recording", 'n', CLI_INT, &r.recording, 1, 1000000, "N", "which of the file's (1)" },
		{ "other-layout", 0, CLI_FLAG, &r.other_layout, 0, 0, NULL,
		  "the layout need not be the recorded one" },
		{ "room", 0, CLI_FLAG, &r.room, 0, 0, NULL,
		  "on the layout's own nodes, which wait for this machine's master" },
		{ "out", 'o', CLI_TEXT, &o->out, 0, 0, "DIR", "where results go (grotto-replay)" },
		{ "every", 0, CLI_INT, &o->every, 1, 10000000, "K",
		  "save pictures of every Kth frame; the last always" },
		{ "exr", 0, CLI_FLAG, &o->exr, 0, 0, NULL, "save scene-linear radiance too" },
		{ "window", 0, CLI_FLAG, &o->window, 0, 0, NULL, "show the walls in windows" },
		{ "pixels-scale", 0, CLI_REAL, &o->pixels_scale, 0.001, 16, "S",
		  "walls of S times the layout's pixels (1)" },
		{ "deadline-ms", 0, CLI_INT, &o->deadline_ms, 1, 600000, "MS",
		  "of the swap barrier: later nodes miss the frame (600000; with --room the layout's)" },
		{ "patience", 0, CLI_INT, &o->patience_s, 1, 86400, "S",
		  "give up after so long without a new frame (600)" },
	};
	const struct cli_table table = {
		"grotto replay FILE [--speed X | --fast | --step] [--room] [OPTION...]",
		"Shows a recording again: each frame has the state that it had. Starts a master and a\n"
		"node per node of the layout on this machine, as grotto demo does; with --room only the\n"
		"master, for the nodes of the room. Fails when the master or a node held another state\n"
		"than the recorded one in any frame, and says in which first.",
		options, sizeof options / sizeof options[0]
	};
	const char *fault;
	int words;

	switch (cli_parse(&table, argc, argv, &words)) {
	case CLI_HELP: return GR_EXIT_OK;
	case CLI_WRONG: return GR_EXIT_CONFIG;
	case CLI_RUN: break;
	}
	fault = wrong(&r, o, words);
	if (fault) {
		fprintf(stderr, "grotto replay: %s\n", fault);
		return GR_EXIT_CONFIG;
	}
	r.file = argv[1];
	return replay(&d, &r, &recorded);
}
