/*
 * The control socket: a real one, with what a client sends cut into pieces as
 * the input says. Every line is answered by one line, or the client is dropped;
 * what it sets is in its range.
 */
#include "config.h" /* _GNU_SOURCE */

#include "daemon/control.h"
#include "daemon/master_settings.h"

#include "base/log.h"
#include "base/result.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

struct room {
	struct loop *loop;
	struct control *control;
	struct sockaddr_un at;
	struct scene_file scene;
	struct scene_lamp lamps[2];
	struct master_settings settings;
	struct param_state *state;
	uint64_t frame;
};

/* As the master's, of what needs no room around it. */
static void answer(void *ctx, char *const *words, int count, char *text, size_t size)
{
	struct room *room = ctx;
	const char *refused = NULL;
	char why[400];

	if (count < 1 || count > CONTROL_WORDS)
		abort();
	for (int i = 0; i < count; i++)
		if (!words[i][0])
			abort();
	if (strcmp(words[0], "set") || count < 2) {
		control_refuse(text, size, "no request '%.40s'", words[0]);
	} else if (master_settings_set(&room->settings, &room->scene, words + 1, count - 1, why,
				       sizeof why) < 0) {
		control_refuse(text, size, "%s", why);
	} else {
		/* What was taken is a value that the nodes take. */
		if (master_settings_apply(&room->settings, room->state, ++room->frame, &refused) < 0)
			abort();
		snprintf(text, size, "{\"ok\":true}");
	}
}

static void start(struct room *room)
{
	const char *folder = getenv("TMPDIR");
	const char *path = room->at.sun_path;

	gr_log_set_level((enum gr_log_level)0);
	snprintf(room->at.sun_path, sizeof room->at.sun_path, "%s/fuzz_control_%ld",
		 folder ? folder : "/tmp", (long)getpid());
	room->at.sun_family = AF_UNIX;
	snprintf(room->lamps[0].name, sizeof room->lamps[0].name, "sun");
	snprintf(room->lamps[1].name, sizeof room->lamps[1].name, "torch");
	room->scene.lamps = room->lamps;
	room->scene.lamp_count = 2;
	room->scene.tone.adaptation = room->scene.tone.luminance_max = 100;
	room->scene.tone.bias = 0.85f;
	room->scene.tone.gamma_display = room->scene.tone.gamma_end_to_end = 1;
	if (param_state_create(&room->state) || loop_create(&room->loop) ||
	    control_create(&room->control, room->loop, path, answer, room))
		abort();
	master_settings_init(&room->settings, &room->scene, 0.063f);
	/* What a scene file holds has been checked; this one is made by hand. */
	room->settings.exposure = room->settings.gamma_encode = 1;
	room->settings.adaptation = room->settings.luminance_max = 100;
	room->settings.tone_bias = 0.85f;
	room->settings.gi_steps = room->settings.gi_gathers = 1;
}

static void run(struct room *room)
{
	for (int i = 0; i < 8 && loop_once(room->loop, 0) == GR_OK; i++)
		;
}

/* Only whole lines of printable JSON; returns how many. */
static size_t take_answers(int fd)
{
	static char text[CONTROL_ANSWER_MAX + 2];
	size_t lines = 0;
	ssize_t n;

	while ((n = recv(fd, text, sizeof text, MSG_DONTWAIT)) > 0)
		for (ssize_t i = 0; i < n; i++) {
			lines += text[i] == '\n';
			if (text[i] != '\n' && (text[i] < 0x20 || text[i] > 0x7e))
				abort();
		}
	return lines;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static struct room room;
	static bool started;
	size_t lines = 0, answers = 0, at = 0;
	int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);

	if (!started)
		start(&room);
	started = true;
	if (fd < 0 || connect(fd, (const struct sockaddr *)&room.at, sizeof room.at) < 0)
		abort();
	run(&room);
	while (at < size) {
		const size_t left = size - at - 1, want = data[at] * 4u;
		const size_t len = want < left ? want : left;
		const ssize_t n = send(fd, data + at + 1, len, MSG_NOSIGNAL | MSG_DONTWAIT);

		for (ssize_t i = 0; i < n; i++)
			lines += data[at + 1 + (size_t)i] == '\n';
		at += 1 + len;
		run(&room);
		answers += take_answers(fd);
	}
	shutdown(fd, SHUT_WR);
	run(&room);
	run(&room);
	answers += take_answers(fd);
	close(fd);
	run(&room);
	if (answers > lines || control_clients(room.control) > 0)
		abort();
	return 0;
}
