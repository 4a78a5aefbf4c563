/*
 * Why a node may not take part. Both values stand in the reason, for they must
 * differ where a person can see it; of files the first part that differs too.
 */
#include "protocol/master_private.h"

#include <sodium.h>
#include <stdio.h>
#include <string.h>

/* The first part that is not as ours; NULL when the node has not said, or none is. */
static const char *first_other(const struct gr_item *ours, size_t count, const uint8_t *theirs,
			       size_t their_count, unsigned width)
{
	const size_t common = count < their_count ? count : their_count;

	for (size_t i = 0; i < common; i++)
		if (memcmp(ours[i].digest, theirs + i * width, width))
			return ours[i].name;
	if (!their_count || count == their_count)
		return NULL;
	return common < count ? ours[common].name : "its end";
}

static bool hashes_differ(const char *what, const uint8_t theirs[32], const uint8_t ours[32],
			  const char *first, char reason[FDP_REASON_MAX])
{
	char a[17], b[17];

	if (!memcmp(theirs, ours, 32))
		return false;
	sodium_bin2hex(a, sizeof a, theirs, 8);
	sodium_bin2hex(b, sizeof b, ours, 8);
	snprintf(reason, FDP_REASON_MAX,
		 "another %s%s%s: the node's hash is %s.., the master's %s..; give the node the master's file",
		 what, first ? ", first at " : "", first ? first : "", a, b);
	return true;
}

static bool contents_differ(const struct fdp_master *m, const struct fdp_join *join,
			    char reason[FDP_REASON_MAX])
{
	const struct fdp_contents *ours = &m->params.contents;
	const unsigned count = (unsigned)join->layout_items + join->scene_items;
	const unsigned width = fdp_items_width(count);
	const char *layout = first_other(ours->layout, ours->layout_count, join->items,
					 join->layout_items, width);
	const char *scene = first_other(ours->scene, ours->scene_count,
					join->items + (size_t)join->layout_items * width,
					join->scene_items, width);

	return hashes_differ("layout", join->layout_hash, ours->layout_hash, layout, reason) ||
	       hashes_differ("scene", join->scene_hash, ours->scene_hash, scene, reason);
}

/*
 * Nodes whose light is not computed alike would show a seam. The master draws
 * nothing and has no plan of its own: who is in the room decides.
 */
static bool plans_differ(const struct fdp_master *m, const struct fdp_join *join,
			 char reason[FDP_REASON_MAX], uint64_t *out_plan)
{
	if (fdp_master_is_follower(m, join->index))
		return false;
	for (size_t i = 0; i < m->params.node_count; i++) {
		const struct fdp_peer *peer = &m->peers[i];

		if (i == join->index || !fdp_peer_present(peer->state) || peer->status.plan == join->plan)
			continue;
		snprintf(reason, FDP_REASON_MAX,
			 "another plan of the light: the node's %016llx, '%s' has %016llx; it takes that one, or the scene file must name gi.method and its settings",
			 (unsigned long long)join->plan, m->names[i], (unsigned long long)peer->status.plan);
		*out_plan = peer->status.plan;
		return true;
	}
	return false;
}

bool fdp_master_refuses(const struct fdp_master *m, unsigned version, const struct fdp_join *join,
			char reason[FDP_REASON_MAX], uint64_t *out_plan)
{
	const uint64_t table = param_table_hash();

	*out_plan = 0;
	if (version != FDP_VERSION || join->version != FDP_VERSION) {
		snprintf(reason, FDP_REASON_MAX,
			 "another protocol version: the node speaks %u, the master %u",
			 (unsigned)(version != FDP_VERSION ? version : join->version), (unsigned)FDP_VERSION);
		return true;
	}
	if (strcmp(join->name, m->names[join->index])) {
		snprintf(reason, FDP_REASON_MAX,
			 "another name: node %u calls itself '%s', the master's layout says '%s'",
			 (unsigned)join->index, join->name, m->names[join->index]);
		return true;
	}
	if (join->table_hash != table) {
		snprintf(reason, FDP_REASON_MAX,
			 "another parameter table: the node's hash is %016llx, the master's %016llx",
			 (unsigned long long)join->table_hash, (unsigned long long)table);
		return true;
	}
	return contents_differ(m, join, reason) || plans_differ(m, join, reason, out_plan);
}
