#!/bin/sh
# cast = "auto" in network namespaces of their own on a bridge that this test
# makes: multicast while both nodes hear it, unicast with the reason once one of
# them does not, multicast again when it does; no frame is missed. Needs
# CAP_NET_ADMIN, iproute2 and nftables; touches nothing but its own namespaces.
. "${srcdir:-.}/tests/loopback/lib.sh"
id=gw$$
started=

cleanup() {
	for pid in $started; do
		kill -KILL "$pid" 2>/dev/null
	done
	wait 2>/dev/null
	for ns in hub m 1 2; do
		ip netns del "$id-$ns" 2>/dev/null
	done
	rm -rf "$work"
}
trap cleanup EXIT
trap 'exit 1' INT TERM HUP

command -v ip >/dev/null || skip "ip (iproute2) is not installed"
command -v nft >/dev/null || skip "nft (nftables) is not installed"
ip netns add "$id-hub" 2>"$work/said" || skip "no network namespaces: $(cat "$work/said")"
need_gl

make_net() {
	ip -n "$id-hub" link add br0 type bridge || return 1
	ip -n "$id-hub" link set br0 up
	address=1
	for ns in m 1 2; do
		ip netns add "$id-$ns" || return 1
		ip -n "$id-$ns" link set lo up
		ip -n "$id-$ns" link add eth0 type veth peer name "p$ns" netns "$id-hub" || return 1
		ip -n "$id-hub" link set "p$ns" master br0 up || return 1
		ip -n "$id-$ns" address add "10.77.1.$address/24" dev eth0
		ip -n "$id-$ns" link set eth0 up
		address=$((address + 1))
	done
}
make_net 2>"$work/said" || skip "no bridge of namespaces: $(cat "$work/said")"

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

# start NS NAME PROGRAM OPTION...: in the background; its pid is left in $pid
start() {
	ns=$1 name=$2 program=$3
	shift 3
	ip netns exec "$id-$ns" "$builddir/daemon/$program" --layout "$work/a.cave" \
		--scene "$srcdir/tests/data/loop.scene" --report "$work/$name.json" "$@" \
		>"$work/$name.log" 2>&1 &
	pid=$!
	started="$started $pid"
}
holds() { # JQ-CONDITION: of the master's status
	said=$("$grotto" status --socket "$work/control" --json 2>&1) &&
		printf '%s' "$said" | jq -e "$1" >/dev/null
}
await() { # SECONDS JQ-CONDITION
	tries=$(($1 * 10))
	while ! holds "$2"; do
		tries=$((tries - 1))
		if [ $tries -le 0 ]; then
			echo "FAIL: waited in vain for: $2"
			"$grotto" status --socket "$work/control" --json
			tail -n 8 "$work"/*.log
			exit 1
		fi
		sleep 0.1
	done
}

start m master grotto-master --expect 2
master=$pid
start 1 n1 grotto-node --node n1 --once
start 2 n2 grotto-node --node n2 --once
await 60 '.frame > 60 and .wire.way == "unicast" and .wire.deaf == "n2"'
grep -q "node n2 does not hear 239.255.71.7: frames go to each node by itself" "$work/master.log" ||
	fail "the log does not say why"
echo "unicast: $(grep -o 'node n2 does not hear.*itself' "$work/master.log")"
ip netns exec "$id-2" nft delete table netdev deaf
await 20 '.wire.way == "multicast" and (.wire | has("deaf") | not)'
echo "multicast again"
forget 2
await 20 '.wire.way == "unicast" and .wire.deaf == "n2"'
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
