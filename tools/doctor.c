/* grotto doctor: is this machine fit for its part in the room, and if not, what to do. */
#include "base/result.h"
#include "tools/cli.h"
#include "tools/command.h"
#include "tools/doctor/doctor.h"
#include "tools/say.h"

#include <stdio.h>
#include <unistd.h>

#define STANDARD_LAYOUT GROTTO_SYSCONFDIR "/cave.cave"
#define STANDARD_SCENE GROTTO_SYSCONFDIR "/scene.scene"

struct doctor_options {
	const char *layout, *scene, *key, *node;
	bool master, json, strict, no_gl;
	int listen;
};

/* The role's index, -1 the master, -2 after a line on stderr. */
static int role(const struct doctor_options *o, const struct layout *layout)
{
	int node;

	if (o->master == (o->node != NULL)) {
		fprintf(stderr, "grotto doctor: say --master or --node NAME: which part this machine has in the room\n");
		return -2;
	}
	if (o->master)
		return -1;
	node = layout_find_node(layout, o->node);
	if (node >= 0)
		return node;
	fprintf(stderr, "grotto doctor: %s has no node '%s'; it has", layout->path, o->node);
	for (size_t i = 0; i < layout->node_count; i++)
		fprintf(stderr, "%s %s", i ? "," : "", layout->nodes[i].name);
	fprintf(stderr, "\n");
	return -2;
}

static int examine(const struct doctor_options *o, const struct layout *layout, int node)
{
	struct doctor doctor = {
		.root = "", .key = o->key, .layout = layout, .node = node, .gl = !o->no_gl,
		.scene = o->scene ? o->scene : access(STANDARD_SCENE, R_OK) == 0 ? STANDARD_SCENE : NULL,
	};
	int status = GR_EXIT_OK;

	doctor_run(&doctor);
	if (!o->json)
		findings_print(&doctor.found, stdout);
	else if (findings_print_json(&doctor.found, stdout) < 0)
		doctor.found.nomem = true;
	if (doctor.found.nomem)
		fprintf(stderr, "grotto doctor: out of memory\n");
	if (doctor.found.nomem || doctor.found.of[FINDING_FAIL] || (o->strict && doctor.found.of[FINDING_WARN]))
		status = GR_EXIT_RUNTIME;
	doctor_finish(&doctor);
	return status;
}

static int with_layout(const struct doctor_options *o)
{
	struct layout *layout = NULL;
	struct gr_diag diag = { 0 };
	int status = GR_EXIT_CONFIG, node = -2;

	if (layout_load(o->layout, &layout, &diag) == GR_OK)
		node = role(o, layout);
	say_diag(&diag);
	gr_diag_finish(&diag);
	if (node >= -1 && o->listen > 0)
		status = doctor_listen(layout, node, o->listen) < 0 ? GR_EXIT_RUNTIME : GR_EXIT_OK;
	else if (node >= -1)
		status = examine(o, layout, node);
	layout_destroy(&layout);
	return status;
}

int command_doctor(int argc, char **argv)
{
	struct doctor_options o = { .layout = STANDARD_LAYOUT };
	const struct cli_option options[] = {
		{ "layout", 'l', CLI_TEXT, &o.layout, 0, 0, "FILE", "the cave layout (" STANDARD_LAYOUT ")" },
		{ "scene", 's', CLI_TEXT, &o.scene, 0, 0, "FILE", "the scene file (" STANDARD_SCENE ")" },
		{ "node", 'n', CLI_TEXT, &o.node, 0, 0, "NAME", "this machine is that node of the layout" },
		{ "master", 'm', CLI_FLAG, &o.master, 0, 0, NULL, "this machine is the master" },
		{ "key", 'k', CLI_TEXT, &o.key, 0, 0, "FILE", "the cluster key, instead of the layout's" },
		{ "listen", 0, CLI_INT, &o.listen, 1, 86400, "SECONDS",
		  "no checks: answer the doctors of other machines on this role's port and group" },
		{ "no-gl", 0, CLI_FLAG, &o.no_gl, 0, 0, NULL, "make no OpenGL context" },
		{ "strict", 0, CLI_FLAG, &o.strict, 0, 0, NULL, "exit status 1 for warnings too" },
		{ "json", 'j', CLI_FLAG, &o.json, 0, 0, NULL, "findings as JSON" },
	};
	const struct cli_table table = {
		"grotto doctor (--master | --node NAME) [--layout FILE] [OPTION...]",
		"Looks whether this machine is fit for its part in the room: files, key, address, port,\n"
		"network interface, buffers, firewall, the way to the other side, multicast, clocks,\n"
		"limits, systemd unit, OpenGL. Each finding is OK, warn, FAIL, or -- where it cannot be\n"
		"told, with what to do. Beside a running daemon too; as root it sees most.\n"
		"Exit status: 0 nothing is wrong, 1 something is, 2 what was given cannot be used.",
		options, sizeof options / sizeof options[0]
	};
	int words;

	switch (cli_parse(&table, argc, argv, &words)) {
	case CLI_HELP: return GR_EXIT_OK;
	case CLI_WRONG: return GR_EXIT_CONFIG;
	case CLI_RUN: break;
	}
	if (words != 0) {
		fprintf(stderr, "grotto doctor: takes options only, not '%s'\n", argv[1]);
		return GR_EXIT_CONFIG;
	}
	return with_layout(&o);
}
