/* The table of checks, and those of files, folders and the machine. */
#include "tools/doctor/doctor.h"

#include "base/clock.h"
#include "base/result.h"
#include "config/scene_file.h"
#include "protocol/key.h"
#include "renderer/scene/scene.h"
#include "tools/ask.h"
#include "tools/doctor/sysfile.h"

#include <pwd.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define STATUS_PATIENCE_NS GR_NS_PER_S
#define UNIT_PRIORITY 5 /* as systemd/ asks for */
#define STATE_FOLDER "/var/lib/grotto"
#define CACHE_FOLDER "/var/cache/grotto"

const struct doctor_check doctor_checks[] = {
	{ "files", check_files, "layout and scene load" },
	{ "key", check_key, "rights and owner of the cluster's key" },
	{ "address", check_address, "the role's address is on this machine" },
	{ "nic", check_nic, "state, speed, MTU and counters of its interface" },
	{ "port", check_port, "the role's port is free, or its daemon's" },
	{ "drops", check_drops, "datagrams that the kernel dropped" },
	{ "buffers", check_buffers, "net.core.rmem_max and wmem_max" },
	{ "firewall", check_firewall, "rules that drop the port" },
	{ "way", check_ways, "the other side is reached, by whole datagrams" },
	{ "multicast", check_multicast, "membership, querier, the group's way" },
	{ "room", check_room, "what a running master says of its nodes" },
	{ "clock", check_clocks, "where the nodes' clocks stand" },
	{ "limits", check_limits, "real-time priority and locked memory" },
	{ "unit", check_unit, "the systemd unit" },
	{ "folders", check_folders, "state, cache and control socket" },
	{ "cpu", check_cpu, "governor and clock source" },
	{ "gl", check_gl, "the OpenGL context that the node would have" },
};
const size_t doctor_check_count = sizeof doctor_checks / sizeof *doctor_checks;

const char *doctor_program(const struct doctor *d)
{
	return d->node < 0 ? "grotto-master" : "grotto-node";
}

size_t doctor_master(const struct layout *layout)
{
	struct net_address address;

	if (!layout->standby_count || (net_master_address(layout, 0, &address) == GR_OK && net_is_ours(&address)))
		return 0;
	return net_own_standby(layout);
}

uint16_t doctor_port(const struct doctor *d)
{
	const size_t master = d->node < 0 ? doctor_master(d->layout) : 0;

	return d->node >= 0 ? d->layout->nodes[d->node].port
	       : master	    ? d->layout->standby[master - 1].port
			    : d->layout->network.master_port;
}

static void add_diag(struct doctor *d, const struct gr_diag *diag, const char *remedy)
{
	for (size_t i = 0; i < diag->count; i++)
		if (diag->items[i].severity != GR_DIAG_NOTE)
			findings_add(&d->found,
				     finding_do(finding(diag->items[i].severity == GR_DIAG_ERROR ?
								FINDING_FAIL : FINDING_WARN, "%s",
							diag->items[i].text), "%s", remedy));
}

void check_files(struct doctor *d)
{
	struct gr_diag diag = { 0 };
	struct scene_file *file = NULL;
	struct scene *scene = NULL;

	findings_add(&d->found, finding(FINDING_OK, "layout %s: %zu walls, %zu nodes", d->layout->path,
					d->layout->wall_count, d->layout->node_count));
	if (d->layout->test.faults)
		findings_add(&d->found,
			     finding_do(finding(FINDING_WARN, "the layout allows faults to be injected"),
					"take test.faults out before visitors come"));
	if (!d->scene) {
		findings_add(&d->found, finding(FINDING_SKIP, "no scene: --scene FILE names it"));
		return;
	}
	if (scene_file_load(d->scene, &file, &diag) >= 0 && scene_import(file, &scene, &diag) >= 0)
		findings_add(&d->found, finding(FINDING_OK, "scene %s: %zu triangles", d->scene,
						scene->index_count / 3));
	add_diag(d, &diag, "`grotto check` says all of it; every machine needs the same files");
	gr_diag_finish(&diag);
	scene_destroy(&scene);
	scene_file_destroy(&file);
}

void check_key(struct doctor *d)
{
	char *path = d->key ? strdup(d->key) : layout_key_path(d->layout);
	uint8_t key[FDP_KEY_BYTES];
	struct gr_diag diag = { 0 };
	struct stat status;
	struct finding rights;

	if (!path) {
		findings_add(&d->found, finding(FINDING_OK, "no key: the room is on loopback"));
		return;
	}
	rights = machine_judge_key(path, stat(path, &status) == 0 ? &status : NULL, &d->user);
	findings_add(&d->found, rights);
	if (rights.level == FINDING_OK && access(path, R_OK) != 0)
		findings_add(&d->found, finding_do(finding(FINDING_SKIP, "what %s holds cannot be read by this user",
							   path), "ask again as root or a member of its group"));
	else if (rights.level == FINDING_OK && fdp_key_load(path, key, &diag) >= 0)
		findings_add(&d->found, finding(FINDING_OK, "%s holds a key", path));
	add_diag(d, &diag, "make one with grotto key, and copy it to every machine");
	gr_diag_finish(&diag);
	explicit_bzero(key, sizeof key);
	free(path);
}

void check_limits(struct doctor *d)
{
	char limits[4096];
	const char *whose = d->port.pid ? "the daemon's" : "this shell's";
	int r = d->port.pid ? sysfile_read(d->root, limits, sizeof limits, "/proc/%d/limits", (int)d->port.pid) :
			      sysfile_read(d->root, limits, sizeof limits, "/proc/self/limits");

	findings_add(&d->found, machine_judge_realtime(r >= 0 ? limits : "", whose, UNIT_PRIORITY));
	findings_add(&d->found, machine_judge_memlock(r >= 0 ? limits : "", whose));
}

void check_unit(struct doctor *d)
{
	char unit[LAYOUT_NAME_MAX + 32] = "grotto-master.service";

	if (d->node >= 0)
		snprintf(unit, sizeof unit, "grotto-node@%s.service", d->layout->nodes[d->node].name);
	findings_add(&d->found, machine_judge_unit(d->root, unit));
}

static void look_at_folder(struct doctor *d, const char *path, const char *made_by)
{
	struct stat status;
	bool there = stat(path, &status) == 0;

	findings_add(&d->found, machine_judge_folder(path, there ? &status : NULL, &d->user, made_by));
}

void check_folders(struct doctor *d)
{
	char folder[4096];
	char *slash;

	if (d->node >= 0) {
		look_at_folder(d, CACHE_FOLDER, "the node's unit");
		return;
	}
	look_at_folder(d, STATE_FOLDER, "the master's unit");
	if (!d->layout->control_socket)
		return;
	snprintf(folder, sizeof folder, "%s", d->layout->control_socket);
	slash = strrchr(folder, '/');
	if (!slash)
		return;
	slash[slash == folder] = '\0';
	look_at_folder(d, folder, "the master's unit");
}

void check_cpu(struct doctor *d)
{
	findings_add(&d->found, machine_judge_governor(d->root));
	findings_add(&d->found, machine_judge_clocksource(d->root));
}

static void find_user(struct machine_user *user)
{
	const struct passwd *entry = getpwnam("grotto");

	if (!entry)
		entry = getpwuid(geteuid());
	*user = (struct machine_user){ .known = entry != NULL, .uid = geteuid(), .gid = getegid() };
	if (entry) {
		user->uid = entry->pw_uid;
		user->gid = entry->pw_gid;
	}
	snprintf(user->name, sizeof user->name, "%s", entry ? entry->pw_name : "this user");
}

static struct json_object *ask_status(const char *socket)
{
	static char answer[ASK_ANSWER_MAX]; /* too large for a stack, used once */
	struct json_object *status;

	if (!socket || ask_master(socket, "status", STATUS_PATIENCE_NS, answer, sizeof answer) != GR_OK)
		return NULL;
	status = json_tokener_parse(answer);
	if (json_object_is_type(status, json_type_object) &&
	    json_object_get_boolean(json_object_object_get(status, "ok")))
		return status;
	json_object_put(status);
	return NULL;
}

void doctor_run(struct doctor *d)
{
	find_user(&d->user);
	d->status = ask_status(d->layout->control_socket);
	for (size_t i = 0; i < doctor_check_count; i++) {
		d->found.check = doctor_checks[i].name;
		doctor_checks[i].run(d);
	}
}

void doctor_finish(struct doctor *d)
{
	findings_finish(&d->found);
	json_object_put(d->status);
	d->status = NULL;
}
