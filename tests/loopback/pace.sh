#!/bin/sh
# A node that does not keep up, by each policy: waited for past the deadline, at half
# the rate, left out for a while; each time named with what takes its time, shown by
# grotto status, and healed. How slow this machine is makes no difference: the node is
# slow because it sleeps (grotto faults), far longer than anything takes that draws.
. "${srcdir:-.}/tests/loopback/room.sh"
grotto=$builddir/tools/grotto
nodes="front right"

faults() { "$grotto" faults --layout "$dir/room.cave" --node right "$@" > "$dir/faults.log" 2>&1; }
pace_is() { status_to && [ "$(node_field "$dir/status.json" right pace)" = "$1" ]; }
status_says() { "$grotto" status --socket "$dir/control" > "$dir/status.log" 2>&1; says status "$1"; }
number() { status_to && node_field "$dir/status.json" "$1" "$2"; }

# start_room DEADLINE_MS SLOW: the settings of the group
start_room() {
	make_room "32, 24" "$1"
	printf 'control_socket = "%s";\ntest = { faults = true; };\nslow = { %s };\n' "$dir/control" "$2" \
		>> "$dir/room.cave"
	rm -f "$dir"/*.log
	start_master --expect 2
	for n in $nodes; do start_node $n; done
	wait_for 120 frame_is_past 20
	pace_is "in step" || fail "right is out of step before anything was done"
}

end_room() {
	kill -TERM "$master_pid"
	ends "$master_pid" 0 master
	for n in $nodes; do
		eval "kill -TERM \$pid_$n"
		eval "ends \$pid_$n 0 $n"
	done
}

make_room "32, 24" 2000.0
need_gl

# Past the deadline nobody is late; the room has the slow one's pace.
start_room 500.0 'policy = "wait"; frames = 2; wait_most_ms = 60000.0;'
missed=$(number right missed)
faults --stall 800 --stall-every 1 || fail "stall: $(cat "$dir/faults.log")"
wait_for 120 pace_is "slow"
says master "node right does not keep up: last ready .* ms after its frame began, 500.0 are allowed; it draws for .* ms.*All wait for it" ||
	fail "the master does not name right, and what takes its time"
status_says "^right does not keep up: ready .* ms after a frame begins, draws for .*: .*shade" ||
	fail "grotto status does not say where right's time goes: $(cat "$dir/status.log")"
status_says "^right .* slow [0-9]* s " || fail "grotto status: $(cat "$dir/status.log")"
[ "$(number right missed)" -eq "$missed" ] || fail "right was late although all wait for it"
faults --clear
wait_for 120 pace_is "in step"
says master "node right keeps up again" || fail "nothing is said of its being in step again"
[ "$(count master "node right does not keep up")" -eq 1 ] || fail "told more than once"
[ "$(field "$dir/status.json" evicted)" -eq 0 ] || fail "somebody was left out of a room that waits"
end_room
echo "ok: waited for"

# It shows every second frame and the others all of them, of the same states.
start_room 20000.0 'policy = "half"; limit_ms = 1000.0; frames = 2;'
faults --stall 1500 --stall-every 1 || fail "stall: $(cat "$dir/faults.log")"
wait_for 120 pace_is "half rate"
says master "node right does not keep up: .* It shows every second frame from now on" || fail "right is not named"
status_says "^right .* half rate [0-9]* s " || fail "grotto status: $(cat "$dir/status.log")"
frame=$(field "$dir/status.json" frame)
wait_for 60 frame_is_past $((frame + 2)) # the pair under way
frame=$(field "$dir/status.json" frame) right=$(node_field "$dir/status.json" right swapped)
front=$(node_field "$dir/status.json" front swapped)
wait_for 120 frame_is_past $((frame + 7))
frames=$(($(field "$dir/status.json" frame) - frame))
right=$(($(node_field "$dir/status.json" right swapped) - right))
front=$(($(node_field "$dir/status.json" front swapped) - front))
[ $((frames - 2 * right)) -ge -2 ] && [ $((frames - 2 * right)) -le 2 ] &&
	[ $((frames - front)) -ge -1 ] && [ $((frames - front)) -le 1 ] ||
	fail "of $frames frames front showed $front and right $right"
echo "# half rate: of $frames frames front showed $front and right $right"
faults --clear
wait_for 120 pace_is "in step"
says master "node right keeps up again" || fail "nothing is said of its being in step again"
frame=$(field "$dir/status.json" frame)
wait_for 60 frame_is_past $((frame + 20))
for n in $nodes; do
	[ "$(number $n mismatches)" -eq 0 ] || fail "$n held another state"
	[ "$(number $n missed)" -eq 0 ] || fail "$n was late"
done
end_room
echo "ok: at half the rate"

# Left out; the second time for a second, not to be back at once.
start_room 20000.0 'policy = "evict"; limit_ms = 500.0; frames = 2;'
faults --stall 800 --stall-every 1 || fail "stall: $(cat "$dir/faults.log")"
wait_for 120 says master "node right does not keep up: .* left out and may join again at once"
wait_for 120 says master "node right does not keep up: .* left out and may join again in 1 s"
faults --clear
wait_for 120 pace_is "in step"
[ "$(node_field "$dir/status.json" right state)" != dead ] || fail "right is in step and dead"
[ "$(field "$dir/status.json" evicted)" -ge 2 ] || fail "left out $(field "$dir/status.json" evicted) times"
frame=$(field "$dir/status.json" frame)
wait_for 60 frame_is_past $((frame + 20))
[ "$(number right mismatches)" -eq 0 ] || fail "right held another state"
! says master "node right is gone" || fail "right was taken for dead"
end_room
echo "ok: left out for a while"
