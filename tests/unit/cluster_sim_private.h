/* Between the parts of cluster_sim.h; tests do not include it. */
#ifndef GROTTO_TESTS_CLUSTER_SIM_PRIVATE_H
#define GROTTO_TESTS_CLUSTER_SIM_PRIVATE_H

#include "cluster_sim.h"

/* Of the simulation's dice, in [0, 1). */
double sim_uniform(struct sim *s);

/* cluster_sim_net.c: a datagram goes out; ctx is the sim, or the sim_node. */
void sim_master_send(void *ctx, int to, const uint8_t *bytes, size_t len);
void sim_node_send(void *ctx, int to, const uint8_t *bytes, size_t len);
/* The datagram that arrives first, of packet_count > 0; its bytes are the caller's. */
struct sim_packet sim_packet_pop(struct sim *s);

/* cluster_sim_daemons.c: what the state machines tell; ctx is the sim, or the sim_node. */
void sim_master_event(void *ctx, const struct fdp_master_event *e);
void sim_node_event(void *ctx, const struct fdp_node_event *e);
/* The first time at which a node's clock has come so far. */
int64_t sim_true_time(const struct sim_node *n, int64_t local_ns);
/* When the node, by true time, has something to do next. */
int64_t sim_node_wake(const struct sim_node *n);
void sim_begin_frame(struct sim *s);
/* The node's daemon, after each call into the state machine. */
void sim_tend_node(struct sim *s, struct sim_node *n);
/* And when its time has come: a frame is drawn, a timer is due. */
void sim_step_node(struct sim *s, struct sim_node *n);

#endif
