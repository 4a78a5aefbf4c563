# Sourced after lib.sh by the tests in network namespaces of their own: machines on
# a bridge. Needs CAP_NET_ADMIN, iproute2 and nftables; touches nothing but its own
# namespaces, which are gone at the end with all that was started in them.
id=grotto-$$
machines= # their namespaces are $id-NAME, the bridge's is $id-hub
started=  # processes
scene=$srcdir/tests/data/loop.scene

cleanup() {
	for pid in $started; do
		kill -KILL "$pid" 2>/dev/null
	done
	wait 2>/dev/null
	for ns in hub $machines; do
		ip netns del "$id-$ns" 2>/dev/null
	done
	rm -rf "$work"
}
trap cleanup EXIT
trap 'exit 1' INT TERM HUP

# can_net: whether there can be namespaces; else the reason is in $why
can_net() {
	command -v ip >/dev/null || { why="ip (iproute2) is not installed"; return 1; }
	command -v nft >/dev/null || { why="nft (nftables) is not installed"; return 1; }
	ip netns add "$id-hub" 2>"$work/said" || { why="no network namespaces: $(cat "$work/said")"; return 1; }
}
add_machines() {
	ip -n "$id-hub" link add br0 type bridge || return 1
	ip -n "$id-hub" link set br0 up
	address=1
	for ns in $machines; do
		ip netns add "$id-$ns" || return 1
		ip -n "$id-$ns" link set lo up
		ip -n "$id-$ns" link add eth0 type veth peer name "p$ns" netns "$id-hub" || return 1
		ip -n "$id-hub" link set "p$ns" master br0 up || return 1
		ip -n "$id-$ns" address add "$1.$address/24" dev eth0
		ip -n "$id-$ns" link set eth0 up
		address=$((address + 1))
	done
}
# make_net SUBNET NAME...: a machine per name, SUBNET.1 and on, where can_net; else $why
make_net() {
	subnet=$1
	shift
	machines=$*
	add_machines "$subnet" 2>"$work/said" || { why="no bridge of namespaces: $(cat "$work/said")"; return 1; }
}

# start NS NAME PROGRAM OPTION...: in the background; its pid is left in $pid
start() {
	ns=$1 name=$2 program=$3
	shift 3
	ip netns exec "$id-$ns" "$builddir/daemon/$program" --layout "$work/a.cave" \
		--scene "$scene" --report "$work/$name.json" "$@" \
		>"$work/$name.log" 2>&1 &
	pid=$!
	started="$started $pid"
}
status() { # of the master
	"$grotto" status --socket "$work/control" --json
}
holds() { # JQ-CONDITION: of the master's status
	said=$(status) && printf '%s' "$said" | jq -e "$1"
}
# await SECONDS WHAT COMMAND...: until the command is true
await() {
	tries=$(($1 * 10)) what=$2
	shift 2
	while ! "$@" >/dev/null 2>&1; do
		tries=$((tries - 1))
		if [ $tries -le 0 ]; then
			status
			fail "waited in vain for: $what"
			tail -n 8 "$work"/*.log
			exit 1
		fi
		sleep 0.1
	done
}
