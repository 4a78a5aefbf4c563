#!/bin/sh
# The same room with a key, over multicast, over broadcast, and over what works of multicast and
# unicast: one datagram for all nodes.
. "${srcdir:-.}/tests/loopback/room.sh"
make_room "32, 24" 20000.0
need_gl
nodes="front left"

(umask 027 && od -An -tx1 -N32 /dev/urandom | tr -d ' \n' > "$dir/room.key" && echo >> "$dir/room.key")
cp "$dir/room.cave" "$dir/unicast.cave"
for cast in "multicast 239.255.71.5" "broadcast 127.255.255.255" "auto 239.255.71.5"; do
	set -- $cast
	sed -e "s|^network = {|network = { cast = \"$1\"; group = \"$2\"; group_port = $((port + 5)); interface = \"lo\"; key_file = \"room.key\";|" \
		"$dir/unicast.cave" > "$dir/room.cave"
	start_master --frames 30 --frame-clock --expect 2
	for n in $nodes; do start_node $n --once; done
	ends $master_pid 0 "master ($1)"
	for n in $nodes; do
		eval "ends \$pid_$n 0 \"$n ($1)\""
		[ "$(node_field "$dir/master.json" $n swapped)" -eq 30 ] || fail "$n did not swap 30 frames ($1)"
		[ "$(node_field "$dir/master.json" $n mismatches)" -eq 0 ] || fail "$n held another state ($1)"
	done
	way=$1
	[ "$1" = auto ] && way=multicast
	grep -q "\"way\":\"$way\"" "$dir/master.json" || fail "the report does not say $way"
	echo "ok: $1"
done
says master "all nodes hear 239.255.71.5: frames go by multicast" || fail "auto does not say how"

# A node with another key: neither taken nor told anything, and both sides say so.
tr '0-9a-f' '1-9a-f0' < "$dir/room.key" > "$dir/other.key"
chmod 640 "$dir/other.key"
start_master
start_node front --key "$dir/other.key"
wait_for 120 says master "(node front): signed with another key, or forged; both sides need"
wait_for 30 says front "(the master): signed with another key, or forged; both sides need"
sleep 1
[ "$(count master "signed with another key")" -eq 1 ] || fail "more than a line a minute (master)"
[ "$(count front "signed with another key")" -eq 1 ] || fail "more than a line a minute (front)"
status_to
[ "$(node_field "$dir/status.json" front state)" = absent ] || fail "a node with another key was taken"
kill -TERM "$master_pid" "$pid_front"
ends "$master_pid" 0 master
ends "$pid_front" 0 front
chmod 644 "$dir/room.key"
"$master_bin" --layout "$dir/room.cave" --scene "$dir/cell.scene" > "$dir/bad.log" 2>&1
[ $? -eq 2 ] || fail "a key that all may read is not exit 2"
echo "ok: keys"
