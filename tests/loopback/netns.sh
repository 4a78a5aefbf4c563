#!/bin/sh
# Master and four nodes in network namespaces of their own on a bridge that
# this test makes: with 5 % of all datagrams lost at every ingress each frame
# still swaps on every node with the same state; a node that is cut off is
# left out, and is back after it is connected again; and a light that the nodes
# share out ends with the same bits on all, whatever was lost of it. Needs CAP_NET_ADMIN,
# iproute2 and nftables; touches nothing but its own namespaces.
. "${srcdir:-.}/tests/loopback/lib.sh"
. "${srcdir:-.}/tests/loopback/net.sh"
can_net || skip "$why"
need_gl
make_net 10.77.0 m 1 2 3 4 || skip "$why"
for ns in $machines; do
	# As on a wire: what the kernel cuts up is cut before it can be lost.
	ip -n "$id-$ns" link set eth0 gso_max_segs 1
done

# lose PERCENT: of the UDP datagrams that arrive anywhere
lose() {
	for ns in $machines; do
		ip netns exec "$id-$ns" nft -f - <<-EOF || return 1
			table netdev loss {
				chain in {
					type filter hook ingress device "eth0" priority 0;
					ip protocol udp numgen random mod 100 < $1 counter drop
				}
			}
		EOF
	done
}
lost() {
	for ns in $machines; do
		ip netns exec "$id-$ns" nft list table netdev loss
	done | sed -n 's/.*counter packets \([0-9]*\).*/\1/p' | awk '{ n += $1 } END { print n + 0 }'
}

# The walls are cave4's; each node has a machine, so there must be a key.
"$grotto" key "$work/key" >/dev/null || fail "no key"
cat >"$work/a.cave" <<EOF
name = "netns";
control_socket = "$work/control";
walls = (
	{ name = "front"; lower_left = [-1.5, 0.0, -1.5]; lower_right = [1.5, 0.0, -1.5];
	  upper_left = [-1.5, 2.25, -1.5]; pixels = [32, 24];
	  nodes = ( { name = "n1"; address = "10.77.0.2"; } ); },
	{ name = "left"; lower_left = [-1.5, 0.0, 1.5]; lower_right = [-1.5, 0.0, -1.5];
	  upper_left = [-1.5, 2.25, 1.5]; pixels = [32, 24];
	  nodes = ( { name = "n2"; address = "10.77.0.3"; } ); },
	{ name = "right"; lower_left = [1.5, 0.0, -1.5]; lower_right = [1.5, 0.0, 1.5];
	  upper_left = [1.5, 2.25, -1.5]; pixels = [32, 24];
	  nodes = ( { name = "n3"; address = "10.77.0.4"; } ); },
	{ name = "floor"; lower_left = [-1.5, 0.0, 1.5]; lower_right = [1.5, 0.0, 1.5];
	  upper_left = [-1.5, 0.0, -1.5]; pixels = [32, 32];
	  nodes = ( { name = "n4"; address = "10.77.0.5"; } ); }
);
network = { master_address = "10.77.0.1"; key_file = "$work/key"; };
rates = { evict_frames = 3; };
trackers = ( { name = "visitor"; kind = "sim"; sim = { walk_radius_m = 0.5; }; } );
EOF

gone() {
	for one in "$@"; do
		[ ! -d "/proc/$one" ] || grep -q '^State:.Z' "/proc/$one/status" || return 1
	done
}
cat_reports() {
	for n in n1 n2 n3 n4; do
		jq -c '{node, applied, swapped, mismatches, joined, lost, renderer: .renderer[0:8]}' "$work/$n.json"
	done
}

# Loss.
frames=60
lose 5 2>"$work/said" || skip "no nftables at ingress: $(cat "$work/said")"
start m master grotto-master --frames $frames --frame-clock --wait-all --deadline-ms 60000
nodes=$pid
for n in 1 2 3 4; do
	start $n n$n grotto-node --node n$n --once
	nodes="$nodes $pid"
done
# shellcheck disable=SC2086
await 120 "the end of $frames frames under loss" gone $nodes
started=
for n in n1 n2 n3 n4; do
	jq -e "(.applied == $frames) and (.swapped == $frames) and (.mismatches == 0)" \
		"$work/$n.json" >/dev/null || fail "under loss: $(cat_reports)"
done
jq -e ".frames == $frames and .late == 0 and .evicted == 0 and .wire.repairs > 0" \
	"$work/master.json" >/dev/null || fail "master under loss: $(jq -c . "$work/master.json")"
[ "$(lost)" -gt 0 ] || fail "nothing was lost"
echo "5 % loss: $(lost) datagrams lost, $(jq -c '{frames, repairs: .wire.repairs, commit_to_last_swap_us}' "$work/master.json")"
for ns in $machines; do
	ip netns exec "$id-$ns" nft delete table netdev loss
done

# Partition: frames go on without the node, and with it again.
rm -f "$work"/*.json
start m master grotto-master --frame-clock --wait-all --deadline-ms 500
master=$pid
for n in 1 2 3 4; do
	start $n n$n grotto-node --node n$n --once
done
await 60 "four live nodes" holds '.frame > 20 and (.nodes | all(.state == "live"))'
ip -n "$id-hub" link set p2 down
await 60 "the eviction of n2" holds '.evicted >= 1 and (.nodes[1].state == "dead")'
before=$(status | jq .frame)
await 60 "frames without n2" holds ".frame > $before + 20"
ip -n "$id-hub" link set p2 up
await 60 "n2 to be back" holds '.joined >= 5 and (.nodes | all(.state == "live"))'
before=$(status | jq .frame)
await 60 "frames with n2" holds ".frame > $before + 20 and (.nodes[1].swapped_frame > $before)"
kill -TERM "$master"
# shellcheck disable=SC2086
await 60 "the end" gone $started
started=
jq -e '(.nodes | all(.mismatches == 0))' "$work/master.json" >/dev/null ||
	fail "partition: $(jq -c .nodes "$work/master.json")"
for n in n1 n2 n3 n4; do
	jq -e '.mismatches == 0' "$work/$n.json" >/dev/null || fail "partition: $(cat_reports)"
done
echo "partition: $(jq -c '{frames, joined, evicted, late, missed: [.nodes[].missed]}' "$work/master.json")"

# A shared light under loss: a lamp that circles, then rest.
rm -f "$work"/*.json
mkdir -p "$work/a/b" "$work/scenes"
cp "$srcdir/scenes/cornell-spot.gltf" "$work/scenes/"
scene=$work/a/b/shared.scene
cp "$srcdir/tests/data/shared.scene" "$scene"
lose 5 || skip "no nftables at ingress"
start m master grotto-master --frame-clock --wait-all --deadline-ms 60000
master=$pid
for n in 1 2 3 4; do
	start $n n$n grotto-node --node n$n --once
done
await 120 "150 frames of a shared light under loss" holds '.frame > 150 and .share.nodes == 4'
"$builddir/tests/loopback/ask" "$work/control" set lamp sun off >/dev/null
before=$(status | jq .frame)
await 60 "the light to rest" holds ".frame > $before + 80"
kill -TERM "$master"
# shellcheck disable=SC2086
await 60 "the end" gone $started
started=
jq -es '([.[].light_hash] | unique | length == 1) and all(.mismatches == 0 and .share.refused == 0) and
	(map(.share.asked) | add) > 0' "$work"/n[1-4].json >/dev/null ||
	fail "shared light under loss: $(jq -c '[.node, .light_hash, .share]' "$work"/n[1-4].json)"
echo "shared light, 5 % loss: $(lost) datagrams lost; master $(jq -c '.share' "$work/master.json"); \
nodes $(jq -cs '{received: map(.share.received) | add, late: map(.share.late) | add, lost: map(.share.lost) | add}' "$work"/n[1-4].json)"

[ $failed -eq 0 ] && echo "ok"
exit $failed
