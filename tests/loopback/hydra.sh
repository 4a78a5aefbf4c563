#!/bin/sh
# A Razer Hydra under the real hidapi, the master, four nodes: the head moves on all walls
# in the same frame; unplugged it holds, and comes back on other nodes of /dev.
. "${srcdir:-.}/tests/loopback/room.sh"
grotto=$builddir/tools/grotto
bed=$builddir/tests/loopback/bed
[ -x "$bed" ] || { echo "SKIP: built without umockdev"; exit 77; }
command -v jq >/dev/null || { echo "SKIP: jq is not installed"; exit 77; }
make_room "32, 24" 2000.0
sed -i '/^trackers/,$d' "$dir/room.cave"
cat >> "$dir/room.cave" <<'END'
trackers = (
	{ name = "wands"; kind = "hydra"; base = { position = [0.5, 1.7, 0.0]; };
	  bind = ( { body = "head"; sensor = "left"; }, { body = "wand"; sensor = "right"; } ); }
);
END
need_gl
mkfifo "$dir/fifo" || exit 1
# The master alone sees the mocked devices.
printf '#!/bin/sh\nexec "%s" "%s" "%s" "$@"\n' "$bed" "$dir/fifo" "$master_bin" > "$dir/master"
chmod +x "$dir/master"
master_bin=$dir/master
device() { echo "$@" > "$dir/fifo"; }
# tracking EXPRESSION: it holds of the status
tracking() { status_to && jq -e ".tracking | $1" "$dir/status.json" > /dev/null 2>&1; }

start_master --record "$dir/room.rec" --expect 4
for n in $nodes; do start_node $n; done
wait_for 120 frame_is_past 20
tracking '.head_tracked == false and .trackers[0].state == "absent" and (.head_m[0] | fabs) < 0.001' ||
	fail "without a device: $(jq -c .tracking "$dir/status.json")"
echo "ok: frames go on without the device"

device at 500 0 0
device plug 3
wait_for 120 tracking '.head_tracked and .wand_tracked and .trackers[0].state == "running"'
wait_for 120 tracking '.trackers[0].reports >= 100 and (.head_m[0] | fabs) < 0.001 and (.trackers[0].faults | length == 0)'
before=$(field "$dir/status.json" frame)
wait_for 120 frame_is_past $((before + 5))
device at 300 0 -100
wait_for 120 tracking '(.head_m[0] - 0.2 | fabs) < 0.001 and (.head_m[1] - 1.8 | fabs) < 0.001'
"$grotto" trackers --socket "$dir/control" > "$dir/trackers.log" 2>&1 || fail "grotto trackers fails"
grep -q '^wands  *hydra  *running ' "$dir/trackers.log" || fail "no line of the device"
grep -q '^    head  *0.200  *1.800  *-*0.000 m' "$dir/trackers.log" || fail "no pose of the head"
"$grotto" status --socket "$dir/control" | grep -q '^wands  *hydra  *running ' || fail "grotto status has no line of it"
echo "ok: the head is where the wand is"

device damage 7
wait_for 120 tracking '.trackers[0].faults.checksum == 7'
before=$(field "$dir/status.json" frame)
wait_for 120 frame_is_past $((before + 5))
tracking '.head_tracked and (.head_m[0] - 0.2 | fabs) < 0.001 and (.head_m[1] - 1.8 | fabs) < 0.001' ||
	fail "damaged reports moved the head: $(jq -c .tracking "$dir/status.json")"
for command in trackers status; do
	"$grotto" $command --socket "$dir/control" | grep -q '^    refused: 7 checksum$' ||
		fail "grotto $command does not say what was refused"
done
echo "ok: damaged reports are counted and said, and move nothing"

device unplug
wait_for 120 tracking '.head_tracked == false and .trackers[0].state == "absent" and .trackers[0].dropouts >= 1'
tracking '(.head_m[0] - 0.2 | fabs) < 0.001 and .head_seen_s_ago > 0' || fail "it does not hold: $(jq -c .tracking "$dir/status.json")"
before=$(field "$dir/status.json" frame)
wait_for 120 frame_is_past $((before + 5))
"$grotto" status --socket "$dir/control" | grep -q '^the head is lost, last seen ' || fail "grotto status does not say so"
device at 500 0 0
device plug 7
wait_for 120 tracking '.head_tracked and .trackers[0].opened == 2 and (.head_m[0] | fabs) < 0.001'
echo "ok: unplugged it holds, plugged in elsewhere it goes on"

before=$(field "$dir/status.json" frame)
wait_for 120 frame_is_past $((before + 10))
kill -TERM "$master_pid"
ends "$master_pid" 0 master
for n in $nodes; do
	wait_for 60 says $n "the master left"
done
"$grotto" record --export "$dir/csv" "$dir/room.rec" || fail "no tables"
# The first frame with the head more than half-way to where the wand went: its state, by its
# hash, was acknowledged by every node before any of them drew it.
first=$(awk -F, 'NR > 1 && $16 > 0.1 { print $1 "," $12; exit }' "$dir/csv/frames.csv")
[ -n "$first" ] || fail "the head never moved: $(tail -n 2 "$dir/csv/frames.csv")"
for n in $nodes; do
	awk -F, -v node="$n" -v frame="${first%,*}" -v hash="${first#*,}" '
		$2 ~ "^\"?" node "\"?$" && $3 == "ready" && $4 == frame && $5 == hash { found = 1 } END { exit !found }' \
		"$dir/csv/reports.csv" || fail "$n did not draw frame ${first%,*} with the head where the others had it"
done
[ "$(field "$dir/master.json" mismatches)" -eq 0 ] || fail "states differed"
echo "ok: frame ${first%,*} was the first with the moved head, on all four walls"
# Every report that was handed over is in the record, with the device's own time.
awk -F, 'NR > 1 && $22 == "" { none++ } NR > 1 { all++ } END { exit !(all >= 100 && none == 0) }' "$dir/csv/head.csv" ||
	fail "device times: $(head -n 3 "$dir/csv/head.csv")"
echo "ok: $(($(wc -l < "$dir/csv/head.csv") - 1)) samples of the head, each with the device's time"
