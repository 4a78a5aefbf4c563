#!/bin/sh
# Somebody listens on the wire of a room that runs, holds no key, and throws back
# what he hears: as it was, to another daemon, cut, with bits flipped, renumbered,
# signed with a key of his own, and noise. Nothing is accepted, no answer is longer than
# what asked for it, no wall is late. GROTTO_LONG=1 throws a million.
. "${srcdir:-.}/tests/loopback/room.sh"
make_room "32, 24" 1000.0
forger=$builddir/tests/loopback/forger
nodes="front left"
number=60000 rate=12000
[ -n "${GROTTO_LONG-}" ] && number=1000000 rate=30000
need_gl

(umask 027 && od -An -tx1 -N32 /dev/urandom | tr -d ' \n' > "$dir/room.key" && echo >> "$dir/room.key")
sed -i -e 's|^network = {|network = { key_file = "room.key";|' "$dir/room.cave"

"$forger" $port $((port + 1)) 2 $number $rate > "$dir/forger.log" 2>&1 &
forger_pid=$!
pids="$pids $forger_pid"
listens() { says forger listens || ! kill -0 $forger_pid 2>/dev/null; }
wait_for 10 listens
if ! says forger listens; then
	cat "$dir/forger.log"
	wait $forger_pid
	[ $? -eq 77 ] || fail "the forger"
	echo "SKIP: may not listen on the loopback wire"
	exit 77
fi
start_master --expect 2
for n in $nodes; do start_node $n --once; done
ends $forger_pid 0 "the forger"
wait_for 60 frame_is_past 20
before=$(field "$dir/status.json" frame)
wait_for 60 frame_is_past $((before + 10))
kill -TERM "$master_pid"
ends "$master_pid" 0 master
for n in $nodes; do eval "ends \$pid_$n 0 $n"; done

said() { sed -n "s/.*\\b$1 \\([0-9]*\\).*/\\1/p" "$dir/forger.log" | tail -n 1; }
bad=0
for f in master $nodes; do
	grep -o '"bad":{[^}]*}' "$dir/$f.json" > "$dir/bad.json"
	echo "# $f: $(cat "$dir/bad.json")"
	for kind in short version auth session format replay; do
		bad=$((bad + $(field "$dir/bad.json" $kind)))
	done
done
thrown=$(said thrown) answers=$(said answers)
cat "$dir/forger.log"
# An answer is to a JOIN that was heard: a datagram of 384 bytes.
[ "$(said answer_bytes)" -le $((answers * 384)) ] || fail "an answer is longer than a JOIN"
[ "$bad" -le "$thrown" ] || fail "more bad datagrams than were thrown: the room's own are among them"
[ $((bad + answers)) -ge $((thrown - thrown / 50)) ] || fail "not all that was thrown is accounted for"
[ "$(field "$dir/master.json" joined)" -eq 2 ] || fail "somebody joined"
for kind in late evicted refused; do
	[ "$(field "$dir/master.json" $kind)" -eq 0 ] || fail "$kind is not 0"
done
for n in $nodes; do
	[ "$(node_field "$dir/master.json" $n missed)" -eq 0 ] || fail "$n missed frames"
	for kind in mismatches lost refused; do
		[ "$(field "$dir/$n.json" $kind)" -eq 0 ] || fail "$n: $kind is not 0"
	done
	[ "$(field "$dir/$n.json" joined)" -eq 1 ] || fail "$n joined more than once"
done
echo "ok: $thrown thrown, $bad counted as bad, $answers answered with $(said answer_bytes) bytes, 0 accepted;" \
	"$(field "$dir/master.json" frames) frames, 0 late"
