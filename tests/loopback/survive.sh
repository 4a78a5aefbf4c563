#!/bin/sh
# Deaths: a node killed in mid-frame, then the master killed; each comes back and
# the room goes on. At the end SIGTERM, in the middle of frames, ends all in order.
. "${srcdir:-.}/tests/loopback/room.sh"
make_room "32, 24" 2000.0
echo 'swap = { without_master = "test"; };' >>"$dir/room.cave"
need_gl

start_master --frame-clock --wait-all
for n in $nodes; do start_node $n; done
wait_for 120 frame_is_past 20
grep -q '"light":"a lattice of 8 cells, 4 steps"' "$dir/status.json" || fail "the status does not say how light is computed"
"$builddir/tools/grotto" status --socket "$dir/control" > "$dir/status.log" 2>&1
says status "^light: a lattice of 8 cells, 4 steps$" || fail "grotto status does not say how light is computed"

kill -9 "$pid_left"
wait "$pid_left" 2>/dev/null
wait_for 60 says master "node left is gone"
frame_is_past 0
before=$(field "$dir/status.json" frame)
[ "$(node_field "$dir/status.json" left missed)" -eq 3 ] || fail "left was not given up after 3 frames"
[ "$(node_field "$dir/status.json" left state)" = dead ] || fail "left is not called dead"
wait_for 60 frame_is_past $((before + 10))
echo "ok: the room went on without a killed node"

mv "$dir/left.log" "$dir/left-killed.log"
start_node left
wait_for 120 says left "joined the master"
status_to
before=$(field "$dir/status.json" frame)
wait_for 60 frame_is_past $((before + 20))
[ "$(node_field "$dir/status.json" left state)" = live ] || fail "left came back but is not live"
[ "$(node_field "$dir/status.json" left swapped)" -gt 5 ] || fail "left came back but does not swap"
echo "ok: its restart joined the running room"

kill -9 "$master_pid"
wait "$master_pid" 2>/dev/null
start_master --frame-clock --wait-all
wait_for 120 frame_is_past 20
for n in $nodes; do
	[ "$(node_field "$dir/status.json" $n state)" = live ] || fail "$n did not join the new master"
	[ "$(node_field "$dir/status.json" $n mismatches)" -eq 0 ] || fail "$n held another state"
done
for n in $nodes; do
	! says $n "the wall shows" || fail "$n did not hold its picture while the master was started again"
done
echo "ok: all nodes joined a restarted master"

kill -TERM "$master_pid"
ends "$master_pid" 0 master
for n in $nodes; do
	wait_for 60 says $n "the master left"
	wait_for 60 says $n "the wall shows a test pattern"
	eval "kill -TERM \$pid_$n"
	eval "ends \$pid_$n 0 $n"
done
[ "$(field "$dir/master.json" evicted)" -eq 0 ] || fail "the new master gave up nodes that lived"
all_equal $(light_hashes) || fail "the nodes' light differs: $(light_hashes | tr '\n' ' ')"
echo "ok: SIGTERM in the middle of frames"

# A node that may end with its master does so, too, when its last word was lost. (35 s)
if [ "${GROTTO_LONG:-0}" != 0 ]; then
	start_master --expect 1
	start_node front --once
	wait_for 60 frame_is_past 5
	kill -9 "$master_pid"
	wait "$master_pid" 2>/dev/null
	wait_for 60 says front "is taken to have ended"
	ends "$pid_front" 0 front
	echo "ok: a node ended after a master that said nothing"
fi
