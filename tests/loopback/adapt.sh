#!/bin/sh
# The room's eye: a visitor who looks about, and what each wall says of what is looked at.
# The eye gets used to it, on all walls in the same frame, and to the dark when the lamp goes.
. "${srcdir:-.}/tests/loopback/room.sh"
make_room "48, 36" 20000.0
need_gl
sed -i 's/^tone = .*/tone = { curve = "drago"; adapt = "pattanaik"; adaptation = 1.0; };/' "$dir/cell.scene"

# Ahead, then to the left wall, then at the corner of the two and the floor.
awk 'BEGIN { for (n = 0; n <= 600; n++) {
		t = n / 60; a = t < 1 ? 0 : t < 2 ? 1.2 : 0.7; p = t < 2 ? 0 : -0.6
		printf "%.9f head 1 0 1.7 0.3 %.6f %.6f %.6f %.6f 0\n", t, cos(a / 2) * sin(p / 2), sin(a / 2) * cos(p / 2),
			-sin(a / 2) * sin(p / 2), cos(a / 2) * cos(p / 2) } }' > "$dir/head.log"
sed -i 's/kind = "sim"; *$/kind = "replay"; file = "head.log"; loop = false; }/; /sim = {/d' "$dir/room.cave"

eye() { status_to && jq -r ".eye.$1" "$dir/status.json"; }
# used_to LOW HIGH: what is looked at is within, and the eye is used to it.
used_to() {
	status_to && jq -e --argjson low "$1" --argjson high "$2" '.eye.looks_at > $low and .eye.looks_at < $high and
		(.eye.cones / .eye.looks_at - 1 | fabs) < 0.02 and .eye.white >= .eye.looks_at * 0.98' "$dir/status.json" > /dev/null
}
command -v jq > /dev/null || { echo "SKIP: jq is not installed"; exit 77; }
for n in $nodes; do start_node $n --swap-log "$dir/$n.swaps"; done
start_master --wait-all --frame-clock
wait_for 120 used_to 1.2 100000
lit=$(eye looks_at)
ask set lamp ceiling off > /dev/null
wait_for 120 used_to 0 "$(awk -v lit="$lit" 'BEGIN { printf "%g", 0.5 * lit }')"
dark=$(eye looks_at)
wait_for 120 frame_is_past 200
status_to
for n in $nodes; do
	[ "$(node_field "$dir/status.json" $n mismatches)" -eq 0 ] || fail "$n held another state"
done
kill -TERM "$master_pid"
ends "$master_pid" 0 master
for n in $nodes; do
	eval "kill -TERM \$pid_$n"
	eval "ends \$pid_$n 0 $n"
	sed "s/^/$n /" "$dir/$n.swaps"
done > "$dir/swaps"
awk '{ key = $2 " " $3; if (key in hash && hash[key] != $4) { print "two states of frame " key; bad = 1 }
	hash[key] = $4; seen[key]++ } END { for (k in seen) whole += seen[k] == 4
	print "# " NR " pictures, " whole " frames of one state on four walls"; exit bad || !whole }' "$dir/swaps" ||
	fail "walls showed different eyes"
echo "# looks at $lit cd/m2 with the lamp, $dark without"
echo "ok: one eye for all walls"
