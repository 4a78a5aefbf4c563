#!/bin/sh
# A recorded session on the room's own nodes again: at speed, from a damaged
# file, by steps; and that a node which does not hold the state is noticed.
. "${srcdir:-.}/tests/loopback/room.sh"
grotto=$builddir/tools/grotto
command -v jq >/dev/null || { echo "SKIP: jq is not installed"; exit 77; }
make_room "32, 24" 20000.0
need_gl

# said KEY: of the last replay's report
said() { jq ".replay.$1" "$dir/master.json"; }
# all_as_recorded FRAMES: on the master and on all four nodes
all_as_recorded() {
	jq -e --argjson n "$1" '.replay | .frames == $n and .master_equal == $n and
		.nodes_equal == 4 * $n and .different + .unanswered + .frames_wrong == 0' \
		"$dir/master.json" > /dev/null || fail "replayed: $(jq -c .replay "$dir/master.json")"
}
# column FILE N: of its frames
column() { "$grotto" record --export - --table frames "$1" | cut -d, -f"$2" | tail -n +2; }
seconds() { column "$1" 2 | sed -n '1p;$p' | paste -sd ' ' | awk '{ print $2 - $1 }'; }

for n in $nodes; do start_node $n; done
start_master --record "$dir/room.rec" --wait-all --frames 120
ends $master_pid 0 master

start_master --replay "$dir/room.rec" --wait-all --speed 2 --record "$dir/again.rec"
ends $master_pid 0 master
all_as_recorded 120
column "$dir/room.rec" 12 > "$dir/hashes"
column "$dir/again.rec" 12 | cmp - "$dir/hashes" || fail "the recorded replay has other states"
[ "$(sort -u "$dir/hashes" | wc -l)" -eq 120 ] || fail "the states do not change"
ratio=$(echo "$(seconds "$dir/again.rec") $(seconds "$dir/room.rec")" | awk '{ print $1 / $2 }')
awk "BEGIN { exit !($ratio > 0.4) }" || fail "at double speed it took $ratio of the time"
"$grotto" record --info --json "$dir/again.rec" | jq -e '.recordings[0].of_replay' > /dev/null || fail "not said to be a replay"
echo "ok: 120 frames at double speed, $ratio of the time, $(said nodes_equal) answers of nodes as recorded"

# Damage in the middle: what is left out is said, what is shown is right.
cp "$dir/room.rec" "$dir/damaged.rec"
size=$(wc -c < "$dir/damaged.rec")
printf 'damage' | dd of="$dir/damaged.rec" bs=1 seek=$((size / 2)) conv=notrunc 2>/dev/null
"$grotto" record --info "$dir/damaged.rec" > /dev/null && fail "damage is not noticed"
start_master --replay "$dir/damaged.rec" --wait-all --frame-clock
ends $master_pid 0 master
[ "$(said bytes_damaged)" -gt 0 ] && [ "$(said frames)" -ge 1 ] || fail "damage: $(jq -c .replay "$dir/master.json")"
all_as_recorded "$(said frames)"
echo "ok: damaged, $(said bytes_damaged) of $size bytes left out, $(said frames) of 120 frames shown"

# From the middle, and by steps.
start_master --replay "$dir/room.rec" --wait-all --step
wait_for 60 status_to
ask step 5 | grep -q true || fail "no steps"
wait_for 60 frame_is_past 4
sleep 0.3
frame_is_past 5 && fail "it goes on by itself"
ask set exposure 1 | grep -q "replayed" || fail "a replay's settings can be changed"
ask quit > /dev/null
ends $master_pid 0 master
all_as_recorded 5
echo "ok: by steps"

# The room by the command; a node that is killed meanwhile does not pass for one that agrees.
"$grotto" replay "$dir/room.rec" --room --speed 0.7 --deadline-ms 300 --out "$dir/room" > "$dir/room.log" 2>&1 &
replay_pid=$!
pids="$pids $replay_pid"
wait_for 60 grep -qs "frames begin" "$dir/room/master.log"
sleep 0.2
kill -9 "$pid_left"
ends $replay_pid 1 "the replay of a room that lost a node"
grep -q "did not say which state" "$dir/room.log" || fail "another fault: $(cat "$dir/room.log")"
jq -e '.replay.different == 0 and .replay.unanswered >= 1 and .replay.unanswered <= 3 and .replay.master_equal == 120' "$dir/room/master.json" > /dev/null ||
	fail "lost a node: $(jq -c .replay "$dir/room/master.json")"
echo "ok: a lost node is told"

sed -i 's/frame_hz = 60.0/frame_hz = 61.0/' "$dir/room.cave"
"$grotto" replay "$dir/room.rec" --out "$dir/other" 2> "$dir/other.log"
[ $? -eq 2 ] && grep -q "not the layout" "$dir/other.log" || fail "another layout: $(cat "$dir/other.log")"
"$master_bin" --layout "$dir/room.cave" --scene "$dir/cell.scene" --control none --replay "$dir/room.rec" 2> "$dir/other.log"
[ $? -eq 2 ] && grep -q "other-layout" "$dir/other.log" || fail "another layout: $(cat "$dir/other.log")"
printf '\n\n' | "$grotto" replay "$dir/room.rec" --step --other-layout --out "$dir/other" > "$dir/other.log" 2>&1 ||
	fail "by lines: $(cat "$dir/other.log")"
jq -e '.ok and .replay.frames == 2 and .replay.nodes_equal == 8' "$dir/other/summary.json" > /dev/null || fail "by lines: $(jq -c .replay "$dir/other/summary.json")"
echo "ok: another layout only when asked for"
