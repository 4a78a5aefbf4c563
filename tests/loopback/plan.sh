#!/bin/sh
# gi.method = "auto" on walls whose GPUs seem to differ: each node plans otherwise, the first one
# in the room decides, the others take its plan, and all walls show the same light.
. "${srcdir:-.}/tests/loopback/room.sh"
make_room "32, 24" 20000.0
costs_bin=$builddir/tests/loopback/costs
sed 's/^gi = .*/gi = { method = "auto"; share = "cluster"; budget_ms = 20.0; };/' "$dir/cell.scene" \
	> "$dir/auto.scene" && mv "$dir/auto.scene" "$dir/cell.scene" || exit 1
unset CACHE_DIRECTORY

# What costs are called on this device, from a node that measures them.
export XDG_CACHE_HOME="$dir/cache"
need_gl_and_costs() {
	start_node front
	wait_for 240 has_costs_or_ended
	says front "draws with" || {
		grep -h "GL" "$dir/front.log"
		echo "SKIP: no OpenGL 4.5 here"
		exit 77
	}
	kill "$pid_front"
	wait "$pid_front"
	rm -f "$dir/front.log"
}
has_costs() { costs=$(ls "$dir"/cache/grotto/costs-*.txt 2>/dev/null) && [ -n "$costs" ]; }
has_costs_or_ended() { has_costs || ! kill -0 "$pid_front" 2>/dev/null; }
need_gl_and_costs
has_costs || fail "a node with gi.method = auto keeps no costs"

# start_planner NAME FACTOR ARGS...: a node whose GPU takes FACTOR times what is usual
start_planner() {
	export XDG_CACHE_HOME="$dir/cache-$1"
	"$costs_bin" "$costs" "$XDG_CACHE_HOME/grotto/$(basename "$costs")" "$2" || fail "no costs for $1"
	planner=$1
	shift 2
	start_node "$planner" "$@"
}
light_of() { node_field "$1" "$2" light_plan; }

nodes="front left right"
start_master --frames 60 --frame-clock --expect 3
start_planner front 1 --once
wait_for 240 says front "joined the master"
start_planner left 5 --once
start_planner right 0.2 --once
ends $master_pid 0 master
for n in $nodes; do
	eval "ends \$pid_$n 0 $n"
	says $n "costs kept from before" || fail "$n has not planned by the costs that it was given"
	[ "$(node_field "$dir/master.json" $n swapped)" -eq 60 ] || fail "$n did not swap 60 frames"
	[ "$(node_field "$dir/master.json" $n mismatches)" -eq 0 ] || fail "$n held another state"
	[ "$(field "$dir/$n.json" refused)" -eq 0 ] || fail "$n counts the offer as a refusal"
	[ "$(field "$dir/$n.json" nonfinite)" -eq 0 ] || fail "$n met NaN"
	[ "$(light_of "$dir/master.json" $n)" = "$(light_of "$dir/master.json" front)" ] ||
		fail "$n computes light by another plan"
done
for n in left right; do
	says $n "the room's plan of the light is .*, and is taken; this node's own would have been" ||
		fail "$n does not say that it takes the room's plan"
	[ "$(count $n "and is taken")" -eq 1 ] || fail "$n takes more than one plan"
	says $n "cannot be had" && fail "$n cannot have the room's plan"
	grep -h "and is taken" "$dir/$n.log" | sed 's/^/# /'
done
says front "and is taken" && fail "the first node in the room takes another's plan"
says left "it is the room's plan" || fail "left does not warn that its GPU takes more than the budget"
says master "another plan of the light" || fail "the master does not say why it turned nodes back"
all_equal $(light_hashes) || fail "the nodes' light differs: $(light_hashes | tr '\n' ' ')"
[ "$(field "$dir/front.json" light_hash)" != 0000000000000000 ] || fail "no light was computed"
echo "ok: three nodes, one plan"
