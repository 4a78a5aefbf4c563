#!/bin/sh
# grotto faults in a running room: refused where the layout does not allow it; with
# 5 % loss and jitter everywhere frames go on and all hold the same state, and the
# counts are told; a node that stalls is late; one that is killed is named.
. "${srcdir:-.}/tests/loopback/room.sh"
grotto=$builddir/tools/grotto
make_room "32, 24" 500.0
need_gl
faults() { "$grotto" faults --layout "$dir/room.cave" "$@" > "$dir/faults.log" 2>&1; }

faults && fail "faults in a layout that does not allow them"
says faults "does not allow faults; test = { faults = true; }" || fail "the refusal does not say what would be right"
start_master --frame-clock
wait_for 30 status_to
ask faults set loss_in 5 | grep -q '"ok":false.*room.cave does not allow faults' || fail "the master was disturbed"
kill -TERM "$master_pid"
ends "$master_pid" 0 master
printf 'control_socket = "%s";\ntest = { faults = true; };\n' "$dir/control" >> "$dir/room.cave"

start_master --frame-clock --wait-all
for n in $nodes; do start_node $n; done
wait_for 120 frame_is_past 20
says master "faults may be injected here" || fail "the master does not say that it may be disturbed"
faults --loss-in 101 && fail "a loss of 101 %"
ask faults set loss_in 5 loss_in 101 | grep -q '"ok":false.*from 0 to 100 %' || fail "a loss of 101 %"
ask faults set los_in 5 | grep -q '"ok":false.*there are loss_in' || fail "an unknown fault"
ask faults | grep -q '"on":false' || fail "a refused request set something"

faults --loss-in 5 --jitter 3 --duplicate 2 --reorder 2 --seed 42 || fail "faults: $(cat "$dir/faults.log")"
for who in master $nodes; do
	grep -q "^$who .*loss-in 5 %, jitter 3 ms.*seed 42" "$dir/faults.log" || fail "$who: $(cat "$dir/faults.log")"
	says "$who" "faults are injected, as asked: loss_in 5 %, jitter_ms 3 ms" || fail "$who does not warn of it"
done
status_to
before=$(field "$dir/status.json" frame)
wait_for 120 frame_is_past $((before + 150))
"$grotto" status --socket "$dir/control" > "$dir/status.log" 2>&1
says status "^FAULTS are injected at the master" || fail "grotto status hides the faults"
faults --json
for who in master $nodes; do
	[ "$(grep "\"name\":\"$who\"" "$dir/faults.log" | grep -o '"lost_in":[0-9]*' | cut -d: -f2)" -gt 0 ] ||
		fail "nothing was lost at $who: $(cat "$dir/faults.log")"
done
echo "# 150 frames: $(tr '\n' ' ' < "$dir/faults.log")"
for n in $nodes; do
	[ "$(node_field "$dir/status.json" $n mismatches)" -eq 0 ] || fail "$n held another state"
	[ "$(node_field "$dir/status.json" $n state)" != dead ] || fail "$n was lost to 5 % loss"
done
faults --clear
grep -q "^master  *none" "$dir/faults.log" || fail "cleared: $(cat "$dir/faults.log")"
status_to
before=$(field "$dir/status.json" frame)
wait_for 60 frame_is_past $((before + 10))
echo "ok: loss, jitter, duplicates and disorder"

# Beside a running room the doctor asks the master, and knows whose the ports are.
for role in "--master" "--node front"; do
	"$grotto" doctor $role --no-gl --json --layout "$dir/room.cave" --scene "$dir/cell.scene" \
		> "$dir/doctor.log" 2>&1 || fail "grotto doctor $role: $(cat "$dir/doctor.log")"
	says doctor "allows faults to be injected" || fail "the doctor is silent about test.faults"
	says doctor "is held by grotto-${role#--}\|is held by grotto-node" || fail "doctor $role: whose port: $(cat "$dir/doctor.log")"
	says doctor "node front is live" || fail "doctor $role: front: $(cat "$dir/doctor.log")"
	says doctor "the clock of node front is known to" || fail "doctor $role: clock: $(cat "$dir/doctor.log")"
done
echo "ok: the doctor beside a running room"

# The barrier waits half a second.
faults --node right --stall 900 || fail "stall: $(cat "$dir/faults.log")"
wait_for 30 says right "stalls for 900 ms, as asked"
wait_for 30 says master "node right was late"
echo "ok: a node that stalls is late"

faults --kill && fail "a death of nobody in particular"
faults --node left --kill || fail "kill: $(cat "$dir/faults.log")"
ends "$pid_left" 137 left
wait_for 60 says master "node left is gone"
status_to
[ "$(node_field "$dir/status.json" left state)" = dead ] || fail "left is not called dead"
before=$(field "$dir/status.json" frame)
wait_for 60 frame_is_past $((before + 10))
faults --json --node left && fail "a dead node answers"
echo "ok: a node that is killed is named, the others go on"

kill -TERM "$master_pid"
ends "$master_pid" 0 master
for n in front right floor; do
	eval "kill -TERM \$pid_$n"
	eval "ends \$pid_$n 0 $n"
	[ ! -e "$dir/control.$n" ] || fail "$n left its control socket behind"
done
