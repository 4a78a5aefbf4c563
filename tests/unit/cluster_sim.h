/*
 * A whole cluster on a fake clock: the real master and node state machines,
 * a made-up network between them, and what the daemons would do around them.
 */
#ifndef GROTTO_TESTS_CLUSTER_SIM_H
#define GROTTO_TESTS_CLUSTER_SIM_H

#include "protocol/master_private.h"
#include "protocol/node_private.h"

#include "unit.h"

#define SIM_MS INT64_C(1000000)
#define SIM_PERIOD_NS INT64_C(16666667)
#define SIM_LEAD_MOST_NS (SIM_PERIOD_NS / 4)
#define SIM_DEADLINE_NS (33 * SIM_MS)
#define SIM_EPOCH_NS INT64_C(1000000000000)
#define SIM_STATES 256 /* frames whose state is remembered for comparison */

/*
 * Loss in bursts: each way of each node is good or bad, as the dice fall at each
 * of its datagrams, and a bad way loses each with `lost`. Of all the share
 * lost * to_bad / (to_bad + to_good) is, in a row 1 / to_good when lost is 1.
 * (Gilbert, Bell System Technical Journal 39, 1960; Elliott, same, 42, 1963.)
 */
struct sim_bursts {
	double to_bad, to_good, lost; /* probabilities; to_bad 0: none */
	uint64_t bad_to, bad_from;    /* nodes to which, from which the way is bad now */
	uint64_t datagrams, losses, runs; /* runs: losses whose way's datagram before was not one */
	uint64_t last_to, last_from;      /* ways that lost their last datagram */
};

struct sim_packet {
	int64_t at_ns;
	uint64_t order; /* equal times keep their order */
	int to;         /* -1: the master */
	size_t len;
	uint8_t *bytes;
};

struct sim_node {
	struct sim *sim;
	int index;
	struct fdp_node *node; /* NULL: dead */
	bool cut;              /* no datagram passes */
	bool asleep;           /* its machine is suspended */
	bool deaf;             /* none that is sent to the group */
	int64_t render_ns;     /* 0: drawn from 2..8 ms */
	uint64_t drawing;      /* frame, 0 none */
	int64_t drawn_at_ns;
	uint64_t start; /* frame told, not yet begun to be drawn */
	uint64_t swap;  /* told, not yet reported */
	int64_t swap_at_ns; /* its clock; 0: at once */
	int64_t clock_ns; /* its clock less the master's at SIM_EPOCH_NS */
	double clock_ppm; /* what it gains from then on */
	int64_t wake_ns; /* true time at which it has something to do, kept while the simulation runs */
	uint64_t frames, swaps, last_frame, last_swap, joined, lost, refused, mismatches, left;
	char reason[FDP_REASON_MAX];
	uint64_t offered; /* the room's plan, of the last refusal */
};

struct sim {
	struct unit_random random;
	int64_t now_ns;
	double loss, duplicate;
	struct sim_bursts bursts; /* besides `loss` */
	int64_t delay_ns, jitter_ns;
	size_t datagram_max;
	enum fdp_swap swap;
	enum fdp_parity parity;
	int64_t slow_ns; /* what the way to the nodes takes longer than the way from them */
	bool probe_group;
	bool multicast, lamps; /* lamps: the larger parameters change every frame too */
	bool still, wand;      /* nothing but time changes; all that is tracked does */
	unsigned evict_frames;
	uint32_t receive_bytes; /* that nodes announce; 0: they do not */
	struct fdp_pace_params pace;
	int64_t byte_ns;      /* that a byte takes on the master's link; 0: none */
	int64_t link_free_ns; /* when the link has sent all that is queued */

	struct fdp_master *master; /* NULL: dead */
	int64_t master_wake_ns;    /* as a node's wake_ns */
	uint64_t session, outranked; /* outranked: session that a node has been in, above ours; 0: none */
	size_t node_count;
	struct sim_node nodes[FDP_MAX_NODES];
	char names[FDP_MAX_NODES][FDP_NAME_BYTES];

	struct sim_packet *packets; /* a binary heap */
	size_t packet_count, packet_room, packet_most; /* most: ever under way */
	uint64_t order;

	struct param_state *state;
	uint64_t frame;
	bool running;
	uint64_t stop_at; /* begin no frame once so many have swapped */
	int64_t begin_at_ns, begun_ns;
	struct param_state states[SIM_STATES]; /* that the master said, by frame */
	uint64_t swapped, joined, left, late, evicted, mismatches, refused;
	uint64_t paced[4]; /* FDP_MASTER_PACE, by state */
	uint64_t fresh; /* datagrams that the master took as no recording */
	uint64_t to_group, ways; /* datagrams to the group; FDP_MASTER_WAY */
	enum fdp_way way;	 /* of the last of these, and whom it named */
	int deaf;
	bool join_pending;
	char reason[FDP_REASON_MAX];
	bool untimed; /* deliveries and spreads are not kept: a long run has too many */
	int64_t *delivery_ns; /* begin to FDP_NODE_FRAME, all nodes and frames */
	size_t delivery_count, delivery_room;
	/* From the first node that shows a frame to the last, by true time; of frames that all showed. */
	uint64_t shown_frame;
	size_t shown;
	int64_t shown_first_ns, shown_last_ns;
	int64_t *spread_ns;
	size_t spread_count, spread_room;
	uint64_t scheduled; /* frames with a time */
	/* What the daemon does with the light: before it draws, and when that is done. */
	size_t share_bytes; /* 0: nothing is shared */
	void (*begin_light)(struct sim_node *n, uint64_t frame);
	void (*light_done)(struct sim_node *n, uint64_t frame);
	/* More of the state of a frame that begins. */
	void (*more_state)(struct sim *sim, uint64_t frame);
	/* May change a datagram on its way; false drops it. */
	bool (*tamper)(struct sim *sim, int to, uint8_t *bytes, size_t len);
	void *tamper_ctx;
};

void sim_init(struct sim *s, size_t nodes, uint64_t seed);
void sim_start_master(struct sim *s);
void sim_kill_master(struct sim *s);
void sim_start_node(struct sim *s, int node);
void sim_kill_node(struct sim *s, int node);
void sim_start_all(struct sim *s);
/* Until every node is live and idle; fails the test when that takes 5 s. */
void sim_assemble(struct sim *s);
void sim_run_ns(struct sim *s, int64_t ns);
/* Frames at 60 Hz until so many more have swapped. */
void sim_run_frames(struct sim *s, uint64_t frames);
void sim_inject(struct sim *s, int to, const uint8_t *bytes, size_t len, int64_t delay_ns);
void sim_finish(struct sim *s);
struct fdp_peer_status sim_peer(const struct sim *s, int node);
int64_t sim_delivery_quantile(struct sim *s, double q);
int64_t sim_spread_quantile(struct sim *s, double q);
/* A node's clock now. */
int64_t sim_node_time(const struct sim_node *n);

/* Of a random test, said so that it can be repeated. */
uint64_t sim_seed_of(const char *name);
/* Every node is live and has the master's state, and none ever differed. */
void sim_assert_in_step(struct sim *s);
/* And all have drawn and swapped so many frames. */
void sim_assert_all_swapped(struct sim *s, uint64_t frames);
/* A room without loss that has shown 20 frames. */
void sim_start_running(struct sim *s, size_t nodes);

#endif
