#include "masters_sim.h"

#include "base/result.h"

static const char *const names[ROOM_NODES] = { "wall0", "wall1", "wall2", "wall3" };
static const struct fdp_contents contents = { .layout_hash = { 4 }, .scene_hash = { 5 } };
static const uint8_t cluster_key[FDP_KEY_BYTES] = { 1, 2, 3 };

static double uniform(struct room *r)
{
	return unit_random_range(&r->random, 0, 1);
}

static void push(struct room *r, int from, int to, const uint8_t *bytes, size_t len, int64_t at_ns)
{
	if (r->packet_count == r->packet_room) {
		r->packet_room = r->packet_room ? 2 * r->packet_room : 1024;
		r->packets = realloc(r->packets, r->packet_room * sizeof *r->packets);
		assert_non_null(r->packets);
	}
	r->packets[r->packet_count++] = (struct room_packet){ at_ns, r->order++, to, from, len,
							      unit_copy(bytes, len) };
}

static void carry(struct room *r, int from, int to, const uint8_t *bytes, size_t len)
{
	if (from == to || r->cut[from][to] || (r->loss > 0 && uniform(r) < r->loss))
		return;
	push(r, from, to, bytes, len, r->now_ns + 100000 + (int64_t)(100000 * uniform(r)));
}

void room_inject(struct room *r, int to, const uint8_t *bytes, size_t len)
{
	push(r, -1, to, bytes, len, r->now_ns);
}

/* A master's own half: to nodes, and to masters as the peers after them. */
static void master_send(void *ctx, int to, const uint8_t *bytes, size_t len)
{
	struct room_master *m = ctx;

	for (int i = 0; i < ROOM_NODES; i++)
		if (to == FDP_TO_ALL)
			carry(m->room, ROOM_NODES + (int)m->index, i, bytes, len);
	if (to >= 0)
		carry(m->room, ROOM_NODES + (int)m->index, to, bytes, len);
}

/* Its ear, and a node: to masters alone. */
static void to_masters(struct room *r, int from, int to, const uint8_t *bytes, size_t len)
{
	for (int k = 0; k < ROOM_MASTERS; k++)
		if (to == FDP_TO_ALL || to == k)
			carry(r, from, ROOM_NODES + k, bytes, len);
}

static void ear_send(void *ctx, int to, const uint8_t *bytes, size_t len)
{
	struct room_master *m = ctx;

	to_masters(m->room, ROOM_NODES + (int)m->index, to, bytes, len);
}

static void node_send(void *ctx, int to, const uint8_t *bytes, size_t len)
{
	struct room_node *n = ctx;

	to_masters(n->room, n->index, to, bytes, len);
}

static void master_event(void *ctx, const struct fdp_master_event *e)
{
	struct room_master *m = ctx;

	if (e->kind == FDP_MASTER_SWAP) {
		m->begin_at_ns = m->begun_ns + ROOM_PERIOD_NS;
		if (m->begin_at_ns < m->room->now_ns)
			m->begin_at_ns = m->room->now_ns;
	}
	assert_int_not_equal(e->kind, FDP_MASTER_MISMATCH);
	if (e->kind == FDP_MASTER_OUTRANKED)
		fdp_standby_outranked(m->standby, e->theirs);
}

/* What no wall may ever do: go back to a session below, or show what was before. */
static void show(struct room_node *n)
{
	struct room *r = n->room;
	const uint64_t frame = n->wants_swap, session = fdp_node_session(n->fdp);

	n->wants_swap = 0;
	assert_true(session >= n->highest);
	assert_true(frame > n->frame); /* whoever said either */
	if (session > r->watched_session && !r->first_swap_ns)
		r->first_swap_ns = r->now_ns;
	n->session = n->highest = session;
	n->frame = frame;
	n->shown_ns = r->now_ns;
	n->swaps++;
	fdp_node_swapped(n->fdp, frame, r->now_ns, r->now_ns);
}

static void node_event(void *ctx, const struct fdp_node_event *e)
{
	struct room_node *n = ctx;

	switch (e->kind) {
	case FDP_NODE_JOINED:
		n->joined++;
		n->drawing = n->wants_swap = 0;
		break;
	case FDP_NODE_FRAME:
		n->drawing = e->frame;
		n->drawn_at_ns = n->room->now_ns + n->room->render_ns;
		break;
	case FDP_NODE_SWAP: n->wants_swap = e->frame; break;
	case FDP_NODE_LOST: n->lost++; break;
	case FDP_NODE_MASTER_LEFT: n->left++; break;
	case FDP_NODE_REFUSED: fail_msg("refused: %s", e->reason); break;
	case FDP_NODE_MISMATCH: fail_msg("another state"); break;
	}
}

void room_init(struct room *r, uint64_t seed)
{
	memset(r, 0, sizeof *r);
	r->random.state = 2 * seed + 1;
	unit_random_u32(&r->random);
	r->now_ns = ROOM_EPOCH_NS;
	r->render_ns = 8 * ROOM_MS;
}

void room_start_master(struct room *r, unsigned index, bool follows)
{
	struct room_master *m = &r->masters[index];
	const struct fdp_master_ops ops = { .send = master_send, .event = master_event, .ctx = m };
	const struct fdp_standby_ops ear = { .send = ear_send, .ctx = m };
	struct fdp_master_params p = {
		.session = fdp_session_after(0), .contents = contents, .node_names = names,
		.node_count = ROOM_NODES, .datagram_max = 1472, .deadline_ns = 33 * ROOM_MS,
		.evict_frames = 3, .masters = ROOM_MASTERS, .index = index,
		.heartbeat_ns = ROOM_TAKEOVER * ROOM_PERIOD_NS / 8,
	};
	struct fdp_standby_params s = {
		.index = index, .masters = ROOM_MASTERS, .node_count = ROOM_NODES,
		.contents = contents, .datagram_max = 1472,
		.silence_ns = ROOM_TAKEOVER * ROOM_PERIOD_NS / 2, .period_ns = ROOM_PERIOD_NS,
		.follows = follows,
	};

	memcpy(p.key, cluster_key, sizeof p.key);
	memcpy(s.key, cluster_key, sizeof s.key);
	*m = (struct room_master){ .room = r, .index = index, .begin_at_ns = r->now_ns };
	assert_int_equal(param_state_create(&m->state), GR_OK);
	assert_int_equal(fdp_master_create(&m->fdp, &p, &ops), GR_OK);
	assert_int_equal(fdp_standby_create(&m->standby, &s, &ear, m->fdp, r->now_ns), GR_OK);
}

void room_kill_master(struct room *r, unsigned index)
{
	struct room_master *m = &r->masters[index];

	if (!m->fdp)
		return;
	fdp_standby_destroy(&m->standby);
	fdp_master_destroy(&m->fdp);
	param_state_destroy(&m->state);
}

void room_start_node(struct room *r, int index)
{
	struct room_node *n = &r->nodes[index];
	const struct fdp_node_ops ops = { node_send, node_event, n };
	struct fdp_node_params p = {
		.index = (uint16_t)index, .name = names[index], .contents = contents,
		.datagram_max = 1472, .masters = ROOM_MASTERS,
		.call_ns = ROOM_TAKEOVER * ROOM_PERIOD_NS / 2 - ROOM_PERIOD_NS,
	};

	memcpy(p.key, cluster_key, sizeof p.key);
	*n = (struct room_node){ .room = r, .index = index };
	assert_int_equal(fdp_node_create(&n->fdp, &p, &ops), GR_OK);
}

void room_kill_node(struct room *r, int index)
{
	fdp_node_destroy(&r->nodes[index].fdp);
}

void room_cut(struct room *r, int a, int b, bool cut)
{
	r->cut[a][b] = r->cut[b][a] = cut;
}

static bool may_begin(const struct room_master *m)
{
	return fdp_standby_role(m->standby) == FDP_ROLE_RULES && fdp_master_idle(m->fdp) &&
	       fdp_master_present(m->fdp) && m->room->now_ns >= m->begin_at_ns &&
	       m->room->now_ns >= fdp_standby_begin_at(m->standby);
}

static void begin(struct room_master *m)
{
	const uint64_t floor = fdp_master_floor(m->fdp), frame = (floor > m->frame ? floor : m->frame) + 1;
	const uint64_t time = frame * 16666667;
	const float head[3] = { (float)uniform(m->room), 1.6f, (float)m->index };

	assert_true(param_set(m->state, PARAM_FRAME_TIME, &time, frame) >= 0);
	assert_true(param_set(m->state, PARAM_HEAD_POSITION, head, frame) >= 0);
	m->frame = frame;
	m->begun_ns = m->room->now_ns;
	m->begin_at_ns = INT64_MAX;
	assert_int_equal(fdp_master_begin(m->fdp, m->state, frame, m->room->now_ns), GR_OK);
}

static void changed(struct room_master *m, enum fdp_standby_change change)
{
	const int64_t now_ns = m->room->now_ns;
	const struct param_state *followed;
	uint64_t frame;

	switch (change) {
	case FDP_STANDBY_SAME:
	case FDP_STANDBY_FOLLOWS: break;
	case FDP_STANDBY_CALLS: m->called++; break;
	case FDP_STANDBY_RETURNS: m->returned++; break;
	case FDP_STANDBY_TAKES:
		m->taken++;
		followed = fdp_standby_state(m->standby, &frame, NULL);
		if (frame) {
			param_state_copy(m->state, followed);
			m->frame = fdp_standby_first_frame(m->standby, now_ns) - 1;
		}
		m->begin_at_ns = now_ns;
		break;
	case FDP_STANDBY_YIELDS: m->yielded++; break;
	case FDP_STANDBY_RENEWED:
		m->renewed++;
		m->begin_at_ns = now_ns;
		break;
	}
}

static void tend_master(struct room_master *m)
{
	const int64_t now_ns = m->room->now_ns;

	if (!m->fdp || m->hangs)
		return;
	if (now_ns >= fdp_standby_next(m->standby)) {
		changed(m, fdp_standby_tick(m->standby, now_ns));
		/* Or an event loop would spin. */
		assert_true(fdp_standby_next(m->standby) > now_ns);
	}
	if (fdp_standby_role(m->standby) == FDP_ROLE_FOLLOWS)
		return;
	if (now_ns >= fdp_master_next(m->fdp)) {
		fdp_master_tick(m->fdp, now_ns);
		assert_true(fdp_master_next(m->fdp) > now_ns);
	}
	if (may_begin(m))
		begin(m);
}

static void tend_node(struct room_node *n)
{
	const int64_t now_ns = n->room->now_ns;

	if (!n->fdp)
		return;
	if (n->wants_swap)
		show(n);
	if (n->drawing && now_ns >= n->drawn_at_ns) {
		const uint64_t frame = n->drawing;

		n->drawing = 0;
		fdp_node_ready(n->fdp, frame, 1000, now_ns);
	}
	if (n->wants_swap)
		show(n);
	if (now_ns >= fdp_node_next(n->fdp)) {
		fdp_node_tick(n->fdp, now_ns);
		assert_true(fdp_node_next(n->fdp) > now_ns);
	}
	if (n->wants_swap)
		show(n);
}

static void deliver(struct room *r, const struct room_packet *p)
{
	struct room_master *m = p->to >= ROOM_NODES ? &r->masters[p->to - ROOM_NODES] : NULL;

	if (!m) {
		if (r->nodes[p->to].fdp)
			fdp_node_receive(r->nodes[p->to].fdp, p->bytes, p->len, r->now_ns);
		tend_node(&r->nodes[p->to]);
		return;
	}
	if (!m->fdp)
		return;
	if (fdp_standby_is_its(m->standby, p->bytes, p->len))
		fdp_standby_receive(m->standby, p->bytes, p->len, p->at_ns, r->now_ns);
	else if (fdp_standby_role(m->standby) != FDP_ROLE_FOLLOWS)
		fdp_master_receive(m->fdp, p->bytes, p->len, r->now_ns, NULL);
	tend_master(m);
}

/* The first that is due and whose receiver is awake; SIZE_MAX: none. */
static size_t due(const struct room *r)
{
	size_t best = SIZE_MAX;

	for (size_t i = 0; i < r->packet_count; i++) {
		const struct room_packet *p = &r->packets[i];

		if (p->at_ns > r->now_ns || (p->to >= ROOM_NODES && r->masters[p->to - ROOM_NODES].hangs))
			continue;
		if (best == SIZE_MAX || p->at_ns < r->packets[best].at_ns ||
		    (p->at_ns == r->packets[best].at_ns && p->order < r->packets[best].order))
			best = i;
	}
	return best;
}

static int64_t least(int64_t a, int64_t b)
{
	return a < b ? a : b;
}

static int64_t earliest(const struct room *r)
{
	int64_t next = INT64_MAX;

	for (size_t i = 0; i < r->packet_count; i++)
		if (r->packets[i].to < ROOM_NODES || !r->masters[r->packets[i].to - ROOM_NODES].hangs)
			next = least(next, r->packets[i].at_ns);
	for (int i = 0; i < ROOM_NODES; i++) {
		const struct room_node *n = &r->nodes[i];

		if (n->fdp)
			next = least(next, least(fdp_node_next(n->fdp),
						 n->drawing ? n->drawn_at_ns : INT64_MAX));
	}
	for (int k = 0; k < ROOM_MASTERS; k++) {
		const struct room_master *m = &r->masters[k];

		if (!m->fdp || m->hangs)
			continue;
		next = least(next, fdp_standby_next(m->standby));
		if (fdp_standby_role(m->standby) == FDP_ROLE_FOLLOWS)
			continue;
		next = least(next, fdp_master_next(m->fdp));
		if (fdp_standby_role(m->standby) == FDP_ROLE_RULES && fdp_master_idle(m->fdp) &&
		    fdp_master_present(m->fdp)) {
			const int64_t wait_ns = fdp_standby_begin_at(m->standby);

			next = least(next, m->begin_at_ns > wait_ns ? m->begin_at_ns : wait_ns);
		}
	}
	return next;
}

void room_run(struct room *r, int64_t ns)
{
	const int64_t until = r->now_ns + ns;

	while (r->now_ns < until) {
		const int64_t next = earliest(r);
		size_t i;

		if (next > r->now_ns)
			r->now_ns = least(next, until);
		while ((i = due(r)) != SIZE_MAX) {
			const struct room_packet p = r->packets[i];

			r->packets[i] = r->packets[--r->packet_count];
			deliver(r, &p);
			free(p.bytes);
		}
		for (int k = 0; k < ROOM_MASTERS; k++)
			tend_master(&r->masters[k]);
		for (int k = 0; k < ROOM_NODES; k++)
			tend_node(&r->nodes[k]);
	}
}

void room_finish(struct room *r)
{
	for (unsigned k = 0; k < ROOM_MASTERS; k++)
		room_kill_master(r, k);
	for (int i = 0; i < ROOM_NODES; i++)
		room_kill_node(r, i);
	while (r->packet_count)
		free(r->packets[--r->packet_count].bytes);
	free(r->packets);
}

static bool rules(const struct room_master *m)
{
	return m->fdp && fdp_standby_role(m->standby) == FDP_ROLE_RULES;
}

int room_rulers(const struct room *r)
{
	int count = 0;

	for (int k = 0; k < ROOM_MASTERS; k++)
		count += rules(&r->masters[k]);
	return count;
}

int room_ruler(const struct room *r)
{
	int found = -1;

	for (int k = 0; k < ROOM_MASTERS; k++)
		if (rules(&r->masters[k]))
			found = k;
	return room_rulers(r) == 1 ? found : -1;
}

int room_driven(const struct room *r, unsigned master)
{
	int count = 0;

	for (int i = 0; i < ROOM_NODES; i++)
		count += r->nodes[i].fdp && r->masters[master].fdp &&
			 fdp_node_session(r->nodes[i].fdp) == fdp_master_session(r->masters[master].fdp);
	return count;
}

void room_start(struct room *r, uint64_t seed, uint64_t frames)
{
	room_init(r, seed);
	room_start_master(r, 0, false);
	for (unsigned k = 1; k < ROOM_MASTERS; k++)
		room_start_master(r, k, true);
	for (int i = 0; i < ROOM_NODES; i++)
		room_start_node(r, i);
	while (r->masters[0].frame < frames)
		room_run(r, ROOM_PERIOD_NS);
	assert_int_equal(room_ruler(r), 0);
	assert_int_equal(room_driven(r, 0), ROOM_NODES);
	for (unsigned k = 1; k < ROOM_MASTERS; k++)
		assert_int_equal(fdp_standby_follows(r->masters[k].standby), 0);
}
