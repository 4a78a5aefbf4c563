#!/bin/sh
# grotto doctor from outside: a healthy room on loopback, faults that it must find,
# two doctors that answer each other; and between network namespaces (CAP_NET_ADMIN,
# iproute2, nftables; left out where there are none) a small MTU, a firewall, a
# machine that is not there, a group.
. "${srcdir:-.}/tests/loopback/lib.sh"
. "${srcdir:-.}/tests/loopback/net.sh"
inside= # "ip netns exec NAMESPACE" for the doctor

# wall NAME NODE ADDRESS PORT: one wall of the room
wall() {
	echo "{ name = \"$1\"; lower_left = [-1.5, 0.0, $5]; lower_right = [1.5, 0.0, $5];
	  upper_left = [-1.5, 2.25, $5]; pixels = [32, 24];
	  nodes = ( { name = \"$2\"; address = \"$3\"; port = $4; } ); }"
}
# layout MASTER N1 N2 NETWORK: two walls, one behind the other
layout() {
	port=$((20000 + ($$ % 1000) * 8))
	cat <<-END
		name = "doctor"; control_socket = "$work/control";
		walls = ( $(wall a n1 "$2" $((port + 1)) -1.5), $(wall b n2 "$3" $((port + 2)) -1.6) );
		room = { min = [-2.0, 0.0, -1.4]; max = [2.0, 3.0, 2.0]; };
		network = { master_address = "$1"; master_port = $port; $4 };
	END
}
# doctor STATUS OPTION...: its findings in found.json
doctor() {
	expected=$1
	shift
	$inside "$grotto" doctor --no-gl --json --layout "$work/room.cave" "$@" >"$work/found.json" 2>"$work/said"
	status=$?
	[ $status -eq "$expected" ] ||
		fail "grotto doctor $*: exit $status, not $expected: $(cat "$work/said") $(cat "$work/found.json")"
}
# finds CHECK LEVEL TEXT: there is such a finding
finds() {
	jq -e --arg c "$1" --arg l "$2" --arg t "$3" \
		'.findings | any(.check == $c and .level == $l and (.text | contains($t)))' \
		"$work/found.json" >/dev/null ||
		fail "no finding $1 $2 '$3' in: $(jq -c --arg c "$1" '.findings[] | select(.check == $c)' "$work/found.json")"
}
# listen ARGUMENTS...: a doctor that answers, in the background, until stop_listening
listen() {
	: >"$work/listen.log"
	$inside "$grotto" doctor --layout "$work/room.cave" --listen 60 "$@" >"$work/listen.log" 2>&1 &
	started=$!
	tries=100
	until grep -q answering "$work/listen.log"; do
		tries=$((tries - 1))
		[ $tries -gt 0 ] || { fail "nobody listens: $(cat "$work/listen.log")"; return; }
		sleep 0.05
	done
}
stop_listening() {
	kill "$started"
	wait "$started" 2>/dev/null
	started=
}

# A healthy room on loopback, and what stops the command itself.
layout 127.0.0.1 127.0.0.1 127.0.0.1 "" >"$work/room.cave"
doctor 0 --master --scene "$srcdir/tests/data/loop.scene"
finds address ok "127.0.0.1 is on interface lo"
finds files ok "triangles"
finds port ok "is free"
finds way warn "nobody listens"
finds way ok "arrive whole"
finds room unknown "no master answers"
jq -e '.ok and (.findings | all(.check != "" and (.level == "ok" or .level == "unknown" or .remedy)))' \
	"$work/found.json" >/dev/null || fail "a finding says not what to do: $(cat "$work/found.json")"
doctor 1 --master --strict
doctor 2
doctor 2 --master --node n1
doctor 2 --node n3
grep -q "it has n1, n2" "$work/said" || fail "the nodes are not named: $(cat "$work/said")"
doctor 2 --master --layout "$srcdir/tests/data/bad/syntax.cave"
doctor 1 --master --scene "$srcdir/tests/data/bad/no-model.scene"
finds files fail "model cannot be opened"

# Two doctors; the one that listens is no daemon, and says so of the port.
listen --node n1
doctor 0 --master
finds way ok "its doctor answers"
finds way ok "node n1: datagrams of 1472 bytes arrive whole"
doctor 1 --node n1
finds port fail "is held by grotto"
stop_listening

# Key and address.
layout 192.0.2.1 192.0.2.2 192.0.2.3 "key_file = \"$work/key\";" >"$work/room.cave"
doctor 1 --master
finds key fail "is not there"
finds address fail "no interface of this machine has the address 192.0.2.1"
"$grotto" key "$work/key" >/dev/null
chmod 604 "$work/key"
doctor 1 --master
finds key fail "has mode 604"
echo "ok: loopback"
[ $failed -eq 0 ] || exit 1

can_net && make_net 10.77.1 m n1 || { echo "left out: network namespaces: $why"; exit 0; }
ip -n "$id-hub" link set br0 type bridge mcast_snooping 0 || fail "the bridge still snoops"
for ns in $machines; do
	ip -n "$id-$ns" route add default dev eth0
done
chmod 600 "$work/key"
layout 10.77.1.1 10.77.1.2 10.77.1.3 "key_file = \"$work/key\"; cast = \"multicast\"; group = \"239.192.71.1\"; interface = \"eth0\";" \
	>"$work/room.cave"
in_master="ip netns exec $id-m" in_node="ip netns exec $id-n1"

inside=$in_node
listen --node n1
inside=$in_master
doctor 1 --master # n2 is not there
finds address ok "10.77.1.1 is on interface eth0"
finds nic ok "eth0 carries packets of 1500 bytes"
finds way ok "node n1"
finds way ok "node n1: datagrams of 1472 bytes arrive whole"
finds way fail "node n2"
finds multicast ok "group 239.192.71.1 can be joined on eth0"
finds multicast ok "the group reaches node n1"
finds multicast warn "node n2 did not answer"
finds multicast warn "querier"

# A path whose MTU is below the layout's, and a firewall, seen from both sides.
ip -n "$id-m" link set eth0 mtu 1400
doctor 1 --master
finds nic fail "eth0 carries packets of 1400 bytes, the layout sends 1500"
finds way fail "node n1: datagrams of 1472 bytes do not fit: the path carries packets of 1400"
ip -n "$id-m" link set eth0 mtu 1500
ip netns exec "$id-n1" nft -f - <<EOF2 2>"$work/said" || { echo "left out: nftables: $(cat "$work/said")"; exit $failed; }
table inet room {
	chain in {
		type filter hook input priority 0; policy accept;
		udp dport $((port + 1)) counter drop
	}
}
EOF2
doctor 1 --master
finds way unknown "node n1"
stop_listening
inside=$in_node
doctor 1 --node n1
finds firewall fail "nft drops UDP port $((port + 1))"
finds way warn "the master (10.77.1.1:$port): the machine answers, nobody listens"
[ $failed -eq 0 ] && echo "ok: namespaces"
exit $failed
