#!/bin/sh
# A hundred frames of a four-wall room: every node swaps every one, all hold the
# same state and the same light, pictures are saved, one command ends all.
. "${srcdir:-.}/tests/loopback/room.sh"
make_room "64, 48" 20000.0
need_gl

# Two nodes before their master, two after it.
start_node front --once --pictures "$dir/pictures" --every 40 --exr
start_node left --once
wait_for 120 says left "draws with"
start_master --frames 100 --frame-clock --wait-all
start_node right --once
start_node floor --once
ends $master_pid 0 master
for n in $nodes; do
	eval "ends \$pid_$n 0 $n"
	[ "$(node_field "$dir/master.json" $n swapped)" -eq 100 ] || fail "$n did not swap 100 frames"
	[ "$(node_field "$dir/master.json" $n missed)" -eq 0 ] || fail "$n missed frames"
	[ "$(node_field "$dir/master.json" $n mismatches)" -eq 0 ] || fail "$n held another state"
	[ "$(field "$dir/$n.json" swapped)" -eq 100 ] || fail "$n swapped otherwise than it told"
	[ "$(field "$dir/$n.json" dropped)" -eq 0 ] || fail "$n dropped frames"
	[ "$(field "$dir/$n.json" nonfinite)" -eq 0 ] || fail "$n met NaN"
	[ "$(field "$dir/$n.json" gl_errors)" -eq 0 ] || fail "$n met GL errors"
	all_equal "$(field "$dir/master.json" state_hash)" "$(field "$dir/$n.json" state_hash)" ||
		fail "$n ended in another state"
done
all_equal $(light_hashes) || fail "the nodes' light differs: $(light_hashes | tr '\n' ' ')"
[ "$(field "$dir/front.json" light_hash)" != 0000000000000000 ] || fail "no light was computed"
[ "$(field "$dir/master.json" frames_complete)" -eq 100 ] || fail "reports of swaps are missing"
for f in 000040 000080 000100; do
	[ -s "$dir/pictures/front-$f.png" ] && [ -s "$dir/pictures/front-$f.exr" ] ||
		fail "the pictures of frame $f are missing"
done
[ "$(ls "$dir/pictures" | wc -l)" -eq 6 ] || fail "other pictures than asked for"
[ ! -e "$dir/control" ] || fail "the control socket was left behind"
scheduled=$(grep -o '"skew_scheduled_us":{"count":[0-9]*' "$dir/master.json" | grep -o '[0-9]*$')
[ "${scheduled:-0}" -gt 0 ] || fail "no frame was swapped at a time"
for key in skew_us skew_told_us skew_scheduled_us commit_to_applied_us swap_sent_to_last_swap_us commit_to_last_swap_us; do
	echo "# $key $(grep -o "\"$key\":{[^}]*}" "$dir/master.json" | cut -d: -f2-)"
done
echo "ok: 4 nodes, 100 frames"
