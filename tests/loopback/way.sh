#!/bin/sh
# cast = "auto" in network namespaces of their own on a bridge that this test
# makes: multicast while both nodes hear it, unicast with the reason once one of
# them does not, multicast again when it does; no frame is missed. Needs
# CAP_NET_ADMIN, iproute2 and nftables; touches nothing but its own namespaces.
. "${srcdir:-.}/tests/loopback/lib.sh"
. "${srcdir:-.}/tests/loopback/net.sh"
can_net || skip "$why"
need_gl
make_net 10.77.1 m 1 2 || skip "$why"

# forget NS: as a switch that has forgotten a member of the group
forget() {
	ip netns exec "$id-$1" nft -f - <<-EOF
		table netdev deaf {
			chain in {
				type filter hook ingress device "eth0" priority 0;
				ip daddr 224.0.0.0/4 counter drop
			}
		}
	EOF
}
forget 2 2>"$work/said" || skip "no nftables at ingress: $(cat "$work/said")"

"$grotto" key "$work/key" >/dev/null || fail "no key"
cat >"$work/a.cave" <<EOF
name = "way";
control_socket = "$work/control";
walls = (
	{ name = "front"; lower_left = [-1.5, 0.0, -1.5]; lower_right = [1.5, 0.0, -1.5];
	  upper_left = [-1.5, 2.25, -1.5]; pixels = [32, 24];
	  nodes = ( { name = "n1"; address = "10.77.1.2"; } ); },
	{ name = "left"; lower_left = [-1.5, 0.0, 1.5]; lower_right = [-1.5, 0.0, -1.5];
	  upper_left = [-1.5, 2.25, 1.5]; pixels = [32, 24];
	  nodes = ( { name = "n2"; address = "10.77.1.3"; } ); }
);
network = { cast = "auto"; group = "239.255.71.7"; interface = "eth0"; master_address = "10.77.1.1";
	key_file = "$work/key"; };
rates = { frame_hz = 30.0; barrier_deadline_ms = 2000; };
EOF

start m master grotto-master --expect 2
master=$pid
start 1 n1 grotto-node --node n1 --once
start 2 n2 grotto-node --node n2 --once
await 60 "unicast, because of n2" holds '.frame > 60 and .wire.way == "unicast" and .wire.deaf == "n2"'
grep -q "node n2 does not hear 239.255.71.7: frames go to each node by itself" "$work/master.log" ||
	fail "the log does not say why"
echo "unicast: $(grep -o 'node n2 does not hear.*itself' "$work/master.log")"
ip netns exec "$id-2" nft delete table netdev deaf
await 20 "multicast" holds '.wire.way == "multicast" and (.wire | has("deaf") | not)'
echo "multicast again"
forget 2
await 20 "unicast again" holds '.wire.way == "unicast" and .wire.deaf == "n2"'
echo "and unicast"
kill -TERM "$master"
# shellcheck disable=SC2086
wait $started
started=
jq -e '.joined == 2 and .late == 0 and .evicted == 0 and
	(.nodes | all(.missed == 0 and .mismatches == 0))' "$work/master.json" >/dev/null ||
	fail "the walls missed something: $(jq -c '{joined, late, evicted, nodes}' "$work/master.json")"
jq -c '{frames, joined, late, repairs: .wire.repairs}' "$work/master.json"

[ $failed -eq 0 ] && echo "ok"
exit $failed
