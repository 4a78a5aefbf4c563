#!/bin/sh
# A cave whose nodes share out the light: every slice arrives in time, all nodes end
# with the same bits, twice the same ones; and what it spares a node.
. "${srcdir:-.}/tests/loopback/lib.sh"
need_gl
frames=40

# The bake file goes beside the scene: there must be no other's.
mkdir "$work/tests" "$work/scenes" "$work/tests/data"
cp "$srcdir/tests/data/shared.scene" "$work/tests/data/cluster.scene"
sed 's/share = "cluster"/share = "local"/' "$srcdir/tests/data/shared.scene" \
	>"$work/tests/data/local.scene"
sed 's/^gi = .*/gi = { method = "none"; };/' "$srcdir/tests/data/shared.scene" \
	>"$work/tests/data/none.scene"
cp "$srcdir/scenes/cornell-spot.gltf" "$work/scenes/"

# demo OUT SCENE
demo() {
	"$grotto" demo --layout "$srcdir/layouts/cave4.cave" --pixels-scale 0.0625 --frames $frames \
		--scene "$work/tests/data/$2.scene" --out "$work/$1" >"$work/$1.said" 2>&1 || {
		fail "demo of $2: exit $?"
		cat "$work/$1.said"
	}
	check_summary "$work/$1/summary.json" $frames 4
}
demo local local
demo cluster cluster
demo again cluster
demo none none

of() { jq -r "$2" "$work/$1/summary.json"; }
jq -e '.light_agrees and .share.on and .share.nodes == 4 and .share.lost == 0 and
	(.nodes | all(.share.on and .share.sent > 30 and .share.late == 0 and .share.lost == 0 and
		.share.refused == 0 and .share.received > 90)) and
	([.nodes[].light_hash] | unique | length == 1)' "$work/cluster/summary.json" >/dev/null ||
	fail "cluster: $(of cluster '[.light_agrees, .share, (.nodes[] | .light_hash, .share)] | tostring')"
jq -e '.light_agrees and (.share.on | not) and (.nodes | all(.share.sent == 0))' \
	"$work/local/summary.json" >/dev/null || fail "local: $(of local '[.nodes[].share] | tostring')"
[ "$(of cluster '.nodes[0].light_hash')" = "$(of again '.nodes[0].light_hash')" ] ||
	fail "two runs end with different light"
grep -q "all nodes hold the same light" "$work/cluster.said" || fail "the summary does not say so"

# Of a software GL the processors' time is all there is, and other work on this
# machine weighs little on it. A figure to read; no time is asserted.
cpu() { of "$1" '[.nodes[].cpu_ms_a_frame] | add / length'; }
gi() { of "$1" '[.nodes[].stages[] | select(.name == "gi").median_ms] | add / length'; }
ratio=$(awk "BEGIN { print ($(cpu cluster) - $(cpu none)) / ($(cpu local) - $(cpu none)) }")
sed -n 's/^light shared/# light shared/p' "$work/cluster.said"
echo "# processor time a node and frame: local $(cpu local) ms, cluster $(cpu cluster) ms, no light \
$(cpu none) ms: the light $ratio"
echo "# gi, median of a frame, beside other work: local $(gi local) ms, cluster $(gi cluster) ms"

[ $failed -eq 0 ] && echo "ok"
exit $failed
