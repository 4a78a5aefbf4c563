#include "daemon/replay_check.h"

#define BIT(node) (UINT64_C(1) << (node))

static void differs(struct replay_check *c, uint64_t frame, int node, uint64_t recorded,
		    uint64_t found)
{
	c->different++;
	if (c->first.frame == 0)
		c->first = (struct replay_difference){ frame, node, recorded, found };
}

static void close_frame(struct replay_check *c, struct replay_open *open)
{
	if (open->frame == 0)
		return;
	c->unanswered += (uint64_t)__builtin_popcountll(open->live & ~(open->right | open->wrong));
	open->frame = 0;
}

void replay_check_begin(struct replay_check *c, uint64_t frame, uint64_t recorded, uint64_t ours,
			uint64_t live)
{
	struct replay_open *open = &c->open[frame % REPLAY_CHECK_OPEN];

	close_frame(c, open);
	*open = (struct replay_open){ .frame = frame, .hash = recorded, .live = live };
	c->frames++;
	if (ours == recorded)
		c->master_equal++;
	else
		differs(c, frame, REPLAY_CHECK_MASTER, recorded, ours);
}

void replay_check_held(struct replay_check *c, unsigned node, uint64_t frame, uint64_t hash)
{
	struct replay_open *open = &c->open[frame % REPLAY_CHECK_OPEN];

	if (node >= 64 || frame == 0 || open->frame != frame || (open->right | open->wrong) & BIT(node))
		return;
	if (hash == open->hash) {
		open->right |= BIT(node);
		c->node_equal++;
	} else {
		/* It gets the state again, and then agrees; it has differed all the same. */
		open->wrong |= BIT(node);
		differs(c, frame, (int)node, open->hash, hash);
	}
}

void replay_check_end(struct replay_check *c, uint64_t cut_off)
{
	struct replay_open *last = &c->open[cut_off % REPLAY_CHECK_OPEN];

	if (last->frame == cut_off)
		last->frame = 0;
	for (int i = 0; i < REPLAY_CHECK_OPEN; i++)
		close_frame(c, &c->open[i]);
}

bool replay_check_passed(const struct replay_check *c)
{
	return c->frames > 0 && c->node_equal > 0 && c->different == 0 && c->unanswered == 0;
}
