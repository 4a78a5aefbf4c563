#!/bin/sh
# A replayed wand goes through the input layouts: every wall shows each of them from the
# same frame on, as the record has it, and the room moves and the light changes with it.
. "${srcdir:-.}/tests/loopback/room.sh"
grotto=$builddir/tools/grotto
command -v jq >/dev/null || { echo "SKIP: jq is not installed"; exit 77; }
make_room "48, 36" 20000.0
need_gl

# Navigation, flies for half a second; next; takes the torch, makes it brighter; next; more steps, quality; next.
awk 'BEGIN {
	for (n = 0; n <= 240; n++) {
		t = n / 60; b = 0
		if (t >= 0.2 && t < 0.7) b = 1
		if (t >= 0.8 && t < 0.9) b = 8
		if (t >= 1.0 && t < 1.3) b = 1
		if (t >= 1.3 && t < 1.5) b = 4
		if (t >= 1.6 && t < 1.7) b = 8
		if (t >= 1.8 && t < 1.9) b = 4
		if (t >= 2.0 && t < 2.1) b = 1
		if (t >= 2.4 && t < 2.5) b = 8
		printf "%.9f head 1 0 1.7 0.3 0 0 0 1 0\n%.9f wand 1 %.4f 1.3 -0.1 0 0 0 1 %d\n", t, t, 0.1 * t, b
	} }' > "$dir/wand.log"
sed -i 's/kind = "sim"; *$/kind = "replay"; file = "wand.log"; loop = false; }/; /sim = {/d' "$dir/room.cave"

for n in $nodes; do start_node $n --once --swap-log "$dir/$n.swaps"; done
start_master --frames 180 --frame-clock --wait-all --record "$dir/room.rec"
ends $master_pid 0 master
for n in $nodes; do eval "ends \$pid_$n 0 $n"; done
"$grotto" record --export - --table frames "$dir/room.rec" > "$dir/frames.csv" || fail "no table of frames"
jq -e '.hand.layout == "navigation" and .hand.quality and .hand.put_down and .hand.torch == "torch" and
	.settings.gi_steps == 5' "$dir/master.json" > /dev/null ||
	fail "the hand ended otherwise: $(jq -c '.hand, .settings' "$dir/master.json")"

awk -F, -v walls="$nodes" -v dir="$dir" '
	NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
	{ hash[$1] = $at["hash"]; layout[$1] = $at["hand_layout"]; x[$1] = $at["room_z_m"]; last = $1
	  if (layout[$1] != now) { now = layout[$1]; changes++; change[$1] = 1; order = order " " now "@" $1 } }
	END {
		if (changes != 3 || order !~ /^ 1@[0-9]+ 2@[0-9]+ 0@[0-9]+$/) { print "FAIL: layouts" order; exit 1 }
		if (x[1] == x[last]) { print "FAIL: the room has not moved"; exit 1 }
		n = split(walls, wall, " ")
		for (w = 1; w <= n; w++) {
			file = dir "/" wall[w] ".swaps"; shown = 0; here = 0
			while ((getline line < file) > 0) {
				split(line, f, " ")
				if (f[3] != hash[f[2]]) { print "FAIL: " wall[w] " showed another state of frame " f[2]; exit 1 }
				shown++; here += change[f[2]]
			}
			if (here != 3) { print "FAIL: " wall[w] " has not shown each frame of a change: " here; exit 1 }
			total += shown
		}
		print "# layouts change at frames" order "; " total " pictures on " n " walls, all of the recorded states"
	}' "$dir/frames.csv" || fail "see above"
all_equal $(light_hashes) || fail "the nodes' light differs: $(light_hashes | tr '\n' ' ')"
echo "ok: each layout from one frame on, on all walls"
