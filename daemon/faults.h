/*
 * Faults on purpose, for acceptance tests: datagrams that are lost, late, twice
 * or out of order, frames that stall, a daemon that dies. A thin layer between
 * loop and socket; NULL, or with nothing set, it is one branch.
 *
 * Loss on the way out is drawn for each node that a datagram is for (for a group
 * once); all else befalls what arrives. The same seed and the same
 * datagrams give the same faults. Nothing is allocated after faults_create.
 *
 * Allowed by the layout alone (test.faults). Thread: the loop's.
 */
#ifndef GROTTO_DAEMON_FAULTS_H
#define GROTTO_DAEMON_FAULTS_H

#include "daemon/json.h"
#include "daemon/loop.h"
#include "daemon/socket.h"

#define FAULTS_HELD 512 /* datagrams that wait for their time; more are lost and counted */
#define FAULTS_REORDER_NS INT64_C(2000000) /* how long one is held back that others shall overtake */

/* As the control socket says them; 0: none. */
struct faults_settings {
	double loss_in, loss_out, duplicate, reorder; /* percent */
	double delay_ms, jitter_ms; /* of each that arrives: delay, and 0..jitter more */
	double stall_ms;            /* a node sleeps so long in a frame */
	double stall_every;         /* of every so many frames; 0: in the next alone */
};

struct faults_counts {
	uint64_t lost_in, lost_out, delayed, duplicated, reordered, overflowed, stalls;
};

struct faults;
/* salt: daemons with one seed differ by it. GR_OK or a negative result. */
int faults_create(struct faults **out, struct loop *loop, size_t datagram_max, uint64_t salt);
void faults_destroy(struct faults **faults);
/* What receives, by faults_receive, when a datagram's time has come. */
void faults_on_due(struct faults *faults, void (*fn)(void *ctx), void *ctx);

/* As net_send and net_receive; faults may be NULL. peers: how many NET_TO_ALL is. */
void faults_send(struct faults *faults, struct net *net, int to, size_t peers, const uint8_t *bytes,
		 size_t len);
void faults_send_to(struct faults *faults, struct net *net, const struct net_address *to,
		    const uint8_t *bytes, size_t len);
int faults_receive(struct faults *faults, struct net *net, int fd, int most, net_receive_fn fn,
		   void *ctx);
/* Sleeps, where this frame is to stall. */
void faults_frame(struct faults *faults, uint64_t frame);

/*
 * Takes NAME VALUE pairs ("seed" too), all or none: GR_OK, or GR_ERR_RANGE with what would
 * be right in `why`. The log warns each time faults are on.
 */
int faults_set(struct faults *faults, char *const *words, int count, char *why, size_t size);
/* Nothing befalls datagrams any more; what is held still comes. */
void faults_clear(struct faults *faults);
/* SIGKILL for this process, once the answer to who asked may have left. */
void faults_kill(struct faults *faults);
bool faults_on(const struct faults *faults);
/* {"allowed", "on", "seed", settings, counts} under `key`. faults may be NULL. */
void faults_write_json(const struct faults *faults, struct json *json, const char *key);

/* The control socket's request "faults ..."; faults NULL: refused, with what would allow it. */
void faults_answer(struct faults *faults, const char *layout_path, char *const *words, int count,
		   char *answer, size_t size);

#endif
