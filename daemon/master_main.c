/*
 * grotto-master: reads and checks everything, opens ports, gives up
 * privileges, starts trackers, says READY, and runs the room until it is told to end.
 */
#include "config.h" /* asprintf */

#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"
#include "daemon/control.h"
#include "daemon/json.h"
#include "daemon/master.h"
#include "daemon/options.h"
#include "daemon/priority.h"
#include "daemon/privileges.h"
#include "daemon/room_files.h"
#include "daemon/saved_state.h"
#include "daemon/state_keeper.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct opened {
	struct room_files files;
	char *layout_path, *scene_path, *record_path; /* absolute */
	struct recorder *recorder;
	struct live_source live;
	struct replay_source *replay; /* NULL: live */
	struct trackers trackers;
	struct loop *loop;
	struct net *net;
	struct master *master;
	struct faults *faults;
	struct control *control;
	struct state_keeper *keeper;
};

/* Of a file that need not be there yet. Caller frees; NULL without memory. */
static char *absolute(const char *path)
{
	char *folder = path[0] == '/' ? NULL : realpath(".", NULL);
	char *whole = NULL;

	if (asprintf(&whole, "%s%s%s", folder ? folder : "", folder ? "/" : "", path) < 0)
		whole = NULL;
	free(folder);
	return whole;
}

static int open_live(struct opened *o, const struct master_options *options, struct gr_diag *diag)
{
	int r = trackers_open(&o->trackers, o->files.layout, diag);

	live_source_init(&o->live, o->files.layout, o->files.scene_file, &o->trackers,
			 options->frame_clock);
	return r;
}

static int open_replay(struct opened *o, const struct master_options *options, struct gr_diag *diag)
{
	const struct fdp_contents contents = room_files_contents(&o->files);
	const struct replay_params params = {
		.path = options->replay,
		.recording = options->recording,
		.from_ns = llrint(options->from_s * 1e9),
		.speed = options->speed,
		.as_fast = options->frame_clock,
		.step = options->step,
		.frames = (uint64_t)options->frames,
	};
	const struct replay_room room = {
		options->other_layout ? NULL : contents.layout_hash, contents.scene_hash,
	};

	return replay_source_create(&o->replay, &params, &room, diag);
}

static int load(struct opened *o, const struct master_options *options)
{
	struct gr_diag diag = { 0 };
	int r = room_files_load(&o->files, &options->common);

	if (r < 0)
		return r;
	/* Only the hash of the model is needed from here on. */
	scene_destroy(&o->files.scene);
	if ((size_t)options->expect > o->files.layout->node_count) {
		gr_error("--expect %d: the layout has %zu node%s", options->expect,
			 o->files.layout->node_count,
			 o->files.layout->node_count == 1 ? "" : "s");
		return GR_ERR_CONFIG;
	}
	o->layout_path = realpath(options->common.layout, NULL);
	o->scene_path = realpath(options->common.scene, NULL);
	if (options->record) {
		o->record_path = absolute(options->record);
		if (!o->record_path)
			return GR_ERR_NOMEM;
	}
	r = options->replay ? open_replay(o, options, &diag) : open_live(o, options, &diag);
	gr_diag_log(&diag);
	gr_diag_finish(&diag);
	return r;
}

/* Which of the layout's masters is meant, by address, or address and port. */
static int find_master(const struct layout *layout, const char *wanted)
{
	char text[NET_ADDRESS_TEXT];
	struct net_address address;

	for (size_t i = 0; i < net_masters(layout); i++) {
		const char *plain = i ? layout->standby[i - 1].address : layout->network.master_address;

		if (net_master_address(layout, i, &address) < 0)
			continue;
		net_address_text(&address, text);
		if (!strcmp(wanted, text) || !strcmp(wanted, plain))
			return (int)i;
	}
	return -1;
}

static int choose_master(const struct opened *o, const struct master_options *options, unsigned *out)
{
	const struct layout *layout = o->files.layout;
	int index;

	if (options->standby && !layout->standby_count) {
		gr_error("--standby: %s has no standby; add standby = ( { address = \"...\"; } )", layout->path);
		return GR_ERR_CONFIG;
	}
	/* A standby is the first one of this machine, or else the first master that comes back as one. */
	index = options->address ? find_master(layout, options->address) :
		options->standby ? (int)net_own_standby(layout) : 0;
	if (index < 0) {
		gr_error("--address %s: neither network.master_address nor a standby of %s", options->address,
			 layout->path);
		return GR_ERR_CONFIG;
	}
	*out = (unsigned)index;
	return GR_OK;
}

static void fill_params(struct master_params *params, struct opened *o,
			const struct master_options *options)
{
	*params = (struct master_params){
		.layout = o->files.layout,
		.scene = o->files.scene_file,
		.layout_path = o->layout_path,
		.scene_path = o->scene_path,
		.frames = (uint64_t)options->frames,
		.expect = options->wait_all ? (unsigned)o->files.layout->node_count :
					      (unsigned)options->expect,
		.frame_clock = options->frame_clock,
		.standby = options->standby,
		.live = o->replay ? NULL : &o->live,
		.replay = o->replay,
	};
	params->contents = room_files_contents(&o->files);
	memcpy(params->key, o->files.key, sizeof params->key);
}

static const char *control_path(const struct opened *o, const struct master_options *options)
{
	const char *path = options->control ? options->control : o->files.layout->control_socket;

	return path && strcmp(path, "none") ? path : NULL;
}

/* Starts a thread, so once privileges are given up. */
static int open_recorder(struct opened *o)
{
	char why[256];
	int r = recorder_create(&o->recorder);

	if (r < 0) {
		gr_error("cannot record: %s", gr_result_name(r));
		return r;
	}
	master_use_recorder(o->master, o->recorder);
	if (!o->record_path)
		return GR_OK;
	if (master_record(o->master, o->record_path, why, sizeof why) < 0) {
		gr_error("--record: %s", why);
		return GR_ERR_CONFIG;
	}
	return recorder_await(o->recorder) < 0 ? GR_ERR_CONFIG : GR_OK;
}

/* Starts a thread, likewise. */
static int open_keeper(struct opened *o, const char *path)
{
	int r;

	if (path && o->replay) {
		gr_info("--state: a replay goes on from its recording alone");
		return GR_OK;
	}
	r = path ? state_keeper_create(&o->keeper, path, SAVED_STATE_BYTES) : GR_OK;
	if (r < 0)
		gr_error("--state %s: %s", path, gr_result_name(r));
	if (r < 0 || !path)
		return r;
	master_resume(o->master, path);
	master_use_keeper(o->master, o->keeper);
	return GR_OK;
}

static int open_all(struct opened *o, const struct master_options *options)
{
	struct master_params params;
	const char *path = control_path(o, options);
	unsigned index = 0;
	int r = choose_master(o, options, &index);

	if (r >= 0)
		r = net_open_master(&o->net, o->files.layout, index);
	if (r < 0)
		return r;
	fill_params(&params, o, options);
	params.index = index;
	r = master_create(&o->master, o->loop, o->net, &params);
	if (r >= 0 && o->files.layout->test.faults)
		r = faults_create(&o->faults, o->loop, net_datagram_max(&o->files.layout->network), 0);
	if (r >= 0 && o->faults)
		master_use_faults(o->master, o->faults);
	if (r >= 0 && path)
		r = control_create(&o->control, o->loop, path, master_answer, o->master);
	if (r >= 0)
		priority_take(options->common.priority);
	if (r >= 0)
		r = privileges_drop(options->common.user, path);
	if (r >= 0)
		r = trackers_start(&o->trackers);
	/* Root could write it; can who is left? */
	if (r >= 0 && options->common.report && json_try(options->common.report) < 0)
		r = GR_ERR_CONFIG;
	if (r >= 0)
		r = open_keeper(o, options->state);
	return r < 0 ? r : open_recorder(o);
}

static int run(struct opened *o)
{
	const struct layout *layout = o->files.layout;

	notify_ready("waiting for %zu node%s", layout->node_count,
		     layout->node_count == 1 ? "" : "s");
	gr_notice("room '%s', scene '%s': %zu node%s, port %u, %g frames a second", layout->name,
		  o->files.scene_file->name, layout->node_count,
		  layout->node_count == 1 ? "" : "s", layout->network.master_port,
		  (double)layout->rates.frame_hz);
	while (!loop_stopped(o->loop)) {
		if (loop_once(o->loop, -1) < 0) {
			gr_error("the event loop failed");
			return GR_EXIT_RUNTIME;
		}
	}
	if (loop_signal(o->loop))
		gr_notice("ends: %s", strsignal(loop_signal(o->loop)));
	return o->master->status;
}

static int report(const struct master *master, const char *path)
{
	char *text = malloc(CONTROL_ANSWER_MAX);
	size_t len;
	int r = text ? master_write_json(master, gr_clock_now(&gr_clock_monotonic), text,
					 CONTROL_ANSWER_MAX, &len) : GR_ERR_NOMEM;

	if (r >= 0)
		r = json_save(path, text, len);
	free(text);
	return r < 0 ? GR_EXIT_RUNTIME : GR_EXIT_OK;
}

static void close_all(struct opened *o)
{
	control_destroy(&o->control);
	master_destroy(&o->master);
	recorder_destroy(&o->recorder); /* waits for the disk */
	state_keeper_destroy(&o->keeper);
	faults_destroy(&o->faults);
	net_close(&o->net);
	trackers_close(&o->trackers);
	replay_source_destroy(&o->replay);
	room_files_finish(&o->files);
	loop_destroy(&o->loop);
	free(o->layout_path);
	free(o->scene_path);
	free(o->record_path);
}

int main(int argc, char **argv)
{
	struct master_options options;
	struct opened o = { 0 };
	int r, status = GR_EXIT_CONFIG;

	gr_log_init("grotto-master", GR_LOG_INFO);
	switch (master_options_parse(&options, argc, argv)) {
	case OPTIONS_RUN: break;
	case OPTIONS_DONE: return GR_EXIT_OK;
	case OPTIONS_WRONG: return GR_EXIT_CONFIG;
	}
	gr_log_set_level((enum gr_log_level)options.common.log_level);
	/* Now, and not at the end of a long run. */
	r = options.common.report ? json_try(options.common.report) : GR_OK;
	if (r >= 0)
		r = load(&o, &options);
	if (r < 0) {
		status = room_files_exit(r);
		goto out;
	}
	status = GR_EXIT_RUNTIME;
	/* From here on a signal ends the room in order; before, it just ends the process. */
	if (loop_create(&o.loop) < 0 || loop_catch_signals(o.loop) < 0) {
		gr_error("no event loop");
		goto out;
	}
	r = open_all(&o, &options);
	if (r < 0) {
		status = r == GR_ERR_CONFIG ? GR_EXIT_CONFIG : GR_EXIT_RUNTIME;
		goto out;
	}
	status = run(&o);
	notify_stopping();
	master_leave(o.master);
	if (o.replay && !replay_source_end(o.replay))
		status = GR_EXIT_RUNTIME;
	if (options.common.report && report(o.master, options.common.report) != GR_EXIT_OK)
		status = GR_EXIT_RUNTIME;
out:
	close_all(&o);
	return status;
}
