#!/bin/sh
# Strangers on the wire, nodes of another room, and a busy control socket: all are
# counted and refused with a reason, and the room does not miss a frame.
. "${srcdir:-.}/tests/loopback/room.sh"
make_room "32, 24" 5000.0
need_gl
nodes="front left"

start_master --expect 2
for n in $nodes; do start_node $n --once; done
wait_for 120 frame_is_past 5

"$builddir/tests/loopback/stranger" 127.0.0.1 $port || fail "the stranger failed"
"$builddir/tests/loopback/stranger" 127.0.0.1 $((port + 1)) || fail "the stranger failed"
status_to
before=$(field "$dir/status.json" frame)
wait_for 60 frame_is_past $((before + 10))
for kind in short version auth format; do
	[ "$(field "$dir/status.json" $kind)" -gt 0 ] || fail "no datagram was counted as bad: $kind"
done
[ "$(count master "dropped a datagram from 127.0.0.1")" -ge 2 ] || fail "strangers were not named"
[ "$(count master "dropped a datagram from 127.0.0.1")" -le 8 ] || fail "strangers flood the log"
for n in $nodes; do
	[ "$(node_field "$dir/status.json" $n missed)" -eq 0 ] || fail "$n missed frames"
	[ "$(node_field "$dir/status.json" $n mismatches)" -eq 0 ] || fail "$n held another state"
done
echo "ok: garbage, wrong key, wrong version"

# Another scene: refused with the reason on both sides, exit 2 with --once.
sed -e 's/318.31, 318.31, 318.31/1.0, 1.0, 1.0/' "$dir/cell.scene" > "$dir/other.scene"
start_node right --once --scene "$dir/other.scene"
ends "$pid_right" 2 "a node of another scene"
says right "refuses this node: another scene, first at lamps" || fail "the node does not say why"
says master "node right may not join: another scene, first at lamps" || fail "the master does not say why"
echo "ok: another scene is refused, and says where"

# Another layout likewise.
sed -e 's/evict_frames = 3/evict_frames = 4/' "$dir/room.cave" > "$dir/other.cave"
start_node floor --once --layout "$dir/other.cave"
ends "$pid_floor" 2 "a node of another layout"
says floor "refuses this node: another layout, first at rates.evict_frames" ||
	fail "the node does not say where the layouts differ"
says master "node floor may not join: another layout, first at rates.evict_frames" ||
	fail "the master does not say where the layouts differ"
echo "ok: another layout is refused, and says where"

# Live settings, right and wrong.
ask set gi_steps 6 | grep -q '"ok":true' || fail "set gi_steps 6"
ask set lamp torch off | grep -q '"ok":true' || fail "set lamp torch off"
ask set gi_steps 600 | grep -q '"ok":false' || fail "set gi_steps 600 was taken"
ask set lamp sun on | grep -q 'ceiling, torch' || fail "the refusal does not name the lamps"
ask gibberish | grep -q '"ok":false' || fail "gibberish was taken"
status_to
before=$(field "$dir/status.json" frame)
wait_for 60 frame_is_past $((before + 5))
grep -q '"gi_steps":6,' "$dir/status.json" || fail "gi_steps is not 6"
grep -q '"torch":false' "$dir/status.json" || fail "the torch is not off"
ask quit | grep -q '"ok":true' || fail "quit"
ends "$master_pid" 0 master
for n in $nodes; do eval "ends \$pid_$n 0 $n"; done
says master "dropped [0-9]* more datagram" || fail "the other dropped datagrams are not told"
echo "ok: control socket"

# Before anything is opened: a fault of the layout is exit 2 with its line.
sed -e 's/frame_hz = 60.0/frame_hz = 0.0/' "$dir/room.cave" > "$dir/bad.cave"
"$master_bin" --layout "$dir/bad.cave" --scene "$dir/cell.scene" > "$dir/bad.log" 2>&1
[ $? -eq 2 ] || fail "a bad layout is not exit 2 (master)"
grep -q "bad.cave:[0-9]*: .*frame_hz" "$dir/bad.log" || fail "no line of the fault (master)"
"$node_bin" --layout "$dir/bad.cave" --scene "$dir/cell.scene" --node front > "$dir/bad.log" 2>&1
[ $? -eq 2 ] || fail "a bad layout is not exit 2 (node)"
"$node_bin" --layout "$dir/room.cave" --scene "$dir/cell.scene" --node roof > "$dir/bad.log" 2>&1
[ $? -eq 2 ] || fail "an unknown node is not exit 2"
grep -q "front, left, right, floor" "$dir/bad.log" || fail "the nodes there are were not named"
"$master_bin" --layout "$dir/none.cave" --scene "$dir/cell.scene" > "$dir/bad.log" 2>&1
[ $? -eq 2 ] || fail "a missing layout is not exit 2"
for bin in "$master_bin" "$node_bin"; do
	"$bin" --version | grep -q "(grotto)" || fail "--version"
	"$bin" --help | grep -q -- "--layout" || fail "--help"
	"$bin" --no-such > "$dir/bad.log" 2>&1
	[ $? -eq 2 ] || fail "an unknown option is not exit 2"
done
echo "ok: exit codes"
