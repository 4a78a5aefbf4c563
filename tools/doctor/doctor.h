/*
 * What the checks know, and the checks: probing is here, judging in finding.h,
 * link.h, sockets.h, machine.h, firewall.h, room.h and way.h. One thread.
 */
#ifndef GROTTO_TOOLS_DOCTOR_DOCTOR_H
#define GROTTO_TOOLS_DOCTOR_DOCTOR_H

#include "config/layout.h"
#include "daemon/socket.h"
#include "tools/doctor/finding.h"
#include "tools/doctor/link.h"
#include "tools/doctor/machine.h"
#include "tools/doctor/sockets.h"

#include <json-c/json.h>

struct doctor {
	const char *root;         /* of /proc, /sys and /etc: "" */
	const char *scene;        /* file, NULL: none was given and the standard one is not there */
	const char *key;          /* instead of the layout's, or NULL */
	const struct layout *layout;
	int node;                 /* index, -1: the master */
	bool gl;                  /* may a context be made */
	struct findings found;

	/* Found out by the checks for those after them. */
	struct net_address own;   /* of the role, from the layout */
	bool own_here;            /* this machine has it */
	struct link_facts link;   /* of the interface that has it; name "" unknown */
	struct socket_facts port; /* of the role's port */
	struct machine_user user; /* who runs the daemons */
	struct json_object *status; /* of the running master on this machine, or NULL */
};

struct doctor_check {
	const char *name;
	void (*run)(struct doctor *doctor);
	const char *what;
};
extern const struct doctor_check doctor_checks[];
extern const size_t doctor_check_count;

const char *doctor_program(const struct doctor *doctor); /* "grotto-master" or "grotto-node" */
uint16_t doctor_port(const struct doctor *doctor);
/* Which of the layout's masters this machine is: the first, unless it is one that stands by. */
size_t doctor_master(const struct layout *layout);

/* Fills user (from the machine's table, or this process') and status, then runs the checks. */
void doctor_run(struct doctor *doctor);
void doctor_finish(struct doctor *doctor);

/* The checks by theme: files, this machine's net, the ways out, the machine. */
void check_files(struct doctor *doctor);
void check_key(struct doctor *doctor);
void check_address(struct doctor *doctor);
void check_nic(struct doctor *doctor);
void check_port(struct doctor *doctor);
void check_drops(struct doctor *doctor);
void check_buffers(struct doctor *doctor);
void check_firewall(struct doctor *doctor);
void check_ways(struct doctor *doctor);
void check_multicast(struct doctor *doctor);
void check_room(struct doctor *doctor);
void check_clocks(struct doctor *doctor);
void check_limits(struct doctor *doctor);
void check_unit(struct doctor *doctor);
void check_folders(struct doctor *doctor);
void check_cpu(struct doctor *doctor);
void check_gl(struct doctor *doctor);

/*
 * Answers echoes on the role's port and group for so long, so that the doctor of the other
 * side sees what arrives. GR_OK or a negative result with a line in the log.
 */
int doctor_listen(const struct layout *layout, int node, int seconds);
/* Master: asks the group; the nodes whose doctors answered, bit per node. Negative: cannot. */
int doctor_ask_group(const struct layout *layout, uint64_t *out_answered);

#endif
