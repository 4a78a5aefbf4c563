#!/bin/sh
# A recorded room: two nodes, real time; the master is killed in mid-frame. What
# is in the file is whole up to the last block, and says what the master said.
. "${srcdir:-.}/tests/loopback/room.sh"
grotto=$builddir/tools/grotto
walk=$builddir/tests/loopback/walk
command -v jq >/dev/null || { echo "SKIP: jq is not installed"; exit 77; }
nodes="front left"
make_room "32, 24" 2000.0
need_gl

record() { "$grotto" record "$@"; }
# fact EXPRESSION: of the first recording of $dir/room.rec
fact() { record --info --json "$dir/room.rec" | jq -r ".recordings[0] | $1"; }

start_master --record "$dir/room.rec" --expect 2
for n in $nodes; do start_node $n; done
wait_for 60 frame_is_past 60
ask set exposure 0.75 > /dev/null || fail "exposure cannot be set"
record --socket "$dir/control" "$dir/other.rec" 2> "$dir/said" && fail "two recordings at once"
grep -q "under way" "$dir/said" || fail "another reason: $(cat "$dir/said")"
wait_for 60 frame_is_past 150
said=$(field "$dir/status.json" frame)
sleep 0.3 # a block is written ten times a second
kill -9 "$master_pid"
wait "$master_pid" 2>/dev/null

record --info "$dir/room.rec" || fail "what a killed master left is called damaged"
[ "$(fact .ended)" = false ] || fail "a killed master ended its recording"
[ "$(fact .last_frame)" -ge "$said" ] || fail "frame $said was shown, $(fact .last_frame) is the last recorded"
[ "$(fact '.frames - .last_frame')" -eq 0 ] || fail "frames are missing"
[ "$(fact '.frames_missing + .frames_wrong + .frames_unusable + .lost + .gaps')" -eq 0 ] || fail "damaged"
[ "$(fact .events.joined)" -eq 2 ] && [ "$(fact .events.setting)" -eq 1 ] || fail "events: $(fact .events)"
[ "$(fact .layout)" = loopback ] && [ "$(fact .scene)" = cell ] || fail "names: $(fact .layout)"
fact .rules | jq -s -e '.[0].equal > 0 and .[0].different + .[0].early + .[0].back == 0' > /dev/null || fail "rules: $(fact .rules)"
for n in $nodes; do
	[ "$(fact ".reports.$n")" -ge "$((2 * said))" ] || fail "reports of $n: $(fact .reports)"
done
echo "ok: $(fact .frames) frames recorded, killed after $said"

record --export "$dir/csv" "$dir/room.rec" || fail "no tables"
"$walk" "$dir/room.cave" "$dir/csv/head.csv" || fail "the head did not walk as the visitor"
awk -F, 'NR > 1 && ($2 == "" || $5 < $2 || $8 != $7) { bad++ } END { exit bad > 3 }' "$dir/csv/frames.csv" ||
	fail "frames: $(head -n 3 "$dir/csv/frames.csv")"
grep -q '"exposure 0.75"' "$dir/csv/events.csv" || fail "events: $(cat "$dir/csv/events.csv")"
record --export - --table events "$dir/room.rec" | cmp - "$dir/csv/events.csv" || fail "two tables of events"
echo "ok: tables"

# What the killed master left is shown again, on nodes of its own: every state as it was.
"$grotto" replay "$dir/room.rec" --fast --out "$dir/again" > "$dir/again.said" 2>&1 ||
	fail "the killed recording does not replay: $(cat "$dir/again.said")"
jq -e --argjson frames "$(fact .frames)" '.ok and .replay.frames == $frames and
	.replay.master_equal == $frames and .replay.nodes_equal == 4 * $frames and
	.replay.different + .replay.unanswered + .replay.frames_missing == 0' "$dir/again/summary.json" > /dev/null ||
	fail "replayed: $(jq -c .replay "$dir/again/summary.json")"
echo "ok: $(grep '^replayed' "$dir/again.said")"

# A running room is recorded on a word, at the end of the same file.
start_master --expect 2
wait_for 60 frame_is_past 5
record --socket "$dir/control" "$dir/room.rec" || fail "cannot record a running room"
record --socket "$dir/control" /nowhere/x.rec 2>/dev/null && fail "recorded nowhere"
frame_is_past 0
wait_for 60 frame_is_past $(($(field "$dir/status.json" frame) + 30))
record --socket "$dir/control" --stop || fail "cannot stop"
record --socket "$dir/control" --stop 2>/dev/null && fail "stopped twice"
record --socket "$dir/control" "$dir/room.cave" 2>/dev/null && fail "recorded into a layout"
[ "$(record --info --json "$dir/room.rec" | jq '.recordings | length')" -eq 2 ] || fail "not two recordings"
[ "$(record --info --json "$dir/room.rec" | jq '.recordings[1] | .ended and .frames >= 30 and .frames_wrong + .frames_unusable + .gaps == 0')" = true ] ||
	fail "the second: $(record --info "$dir/room.rec")"
kill -TERM "$master_pid"
ends "$master_pid" 0 master
echo "ok: a running room, appended"
