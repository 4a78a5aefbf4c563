#!/bin/sh
# kill -9 at random moments: the master, again and again, under running nodes, then each
# node under a running room. The walls' own logs of what they showed and when say that no
# two walls ever showed two states of one frame, that walls which were not killed went on
# within the frames until a dead one is left out, and that a restarted master went on
# from the state before. GROTTO_LONG kills each a hundred times.
. "${srcdir:-.}/tests/loopback/room.sh"
deadline_ms=250
make_room "32, 24" $deadline_ms.0
need_gl
kills=${GROTTO_LONG:+100}
kills=${kills:-2}
seed=${GROTTO_TEST_SEED:-$(date +%s)}
echo "# kills: seed $seed (GROTTO_TEST_SEED repeats it), $kills of each"

# A moment: 0.000 to 0.999 s, from the seed.
draw=0
moment() {
	draw=$((draw + 1))
	awk -v seed="$seed" -v n=$draw 'BEGIN { srand(seed + 7919 * n); printf "%.3f", rand() }'
}
now_ns() { "$ask_bin" --now; }
rss_kb() { awk '/VmRSS/ { print $2 }' "/proc/$1/status"; }
# AddressSanitizer keeps what was freed: what a process holds says nothing there.
ldd "$node_bin" | grep -q libasan && grows=0 || grows=1
launch_node() { start_node "$1" --swap-log "$dir/$1.swaps"; }
launch_master() { start_master --wait-all --state "$dir/state"; }
# All live in the present session, and ten frames more.
in_step() {
	status_to || return 1
	for n in $nodes; do
		[ "$(node_field "$dir/status.json" "$n" state)" = live ] || return 1
	done
	[ "$(field "$dir/status.json" frame)" -gt $((from + 10)) ]
}
settle() {
	from=0
	status_to && from=$(field "$dir/status.json" frame)
	wait_for 120 in_step
}

launch_master
for n in $nodes; do launch_node "$n"; done
from=0
wait_for 120 in_step
ask set exposure 3 >/dev/null
sleep 2.2 # the state is left every second

# The master, under nodes that live on.
for n in $nodes; do eval "rss_kb \$pid_$n"; done >"$dir/rss.before"
i=0
while [ $i -lt "$kills" ]; do
	i=$((i + 1))
	sleep "$(moment)"
	echo "master $(now_ns)" >>"$dir/killed"
	kill -9 "$master_pid"
	wait "$master_pid" 2>/dev/null
	launch_master
	from=0
	wait_for 60 in_step
	[ "$(field "$dir/status.json" exposure)" = 3 ] ||
		fail "the new master forgot the exposure: $(field "$dir/status.json" exposure)"
done
[ "$(count master "goes on from frame")" -eq "$kills" ] || fail "a master began afresh"
for n in $nodes; do eval "rss_kb \$pid_$n"; done >"$dir/rss.after"
paste "$dir/rss.before" "$dir/rss.after" | awk -v kills="$kills" -v grows=$grows '
	{ grown = $2 - $1; if (grown > most) most = grown; sum = sum " " $1 "->" $2 }
	END { print "# nodes over " kills " deaths of their master, VmRSS kB:" sum; exit grows && most > 6144 }' ||
	fail "nodes have grown"
echo "ok: $kills masters died, the room went on from where it was"

# Each node, under a master that lives on.
master_before=$(rss_kb "$master_pid")
i=0
while [ $i -lt "$kills" ]; do
	i=$((i + 1))
	for n in $nodes; do
		settle
		sleep 1 # the light is steady: no frame has a longer deadline
		sleep "$(moment)"
		eval "victim=\$pid_$n"
		echo "$n $(now_ns)" >>"$dir/killed"
		kill -9 "$victim"
		wait "$victim" 2>/dev/null
		sleep "$(moment)"
		launch_node "$n"
		settle
	done
done
master_after=$(rss_kb "$master_pid")
echo "# master over $((4 * kills)) deaths of nodes, VmRSS kB: $master_before->$master_after"
[ $grows -eq 0 ] || [ $((master_after - master_before)) -le 1024 ] || fail "the master has grown"
kill -TERM "$master_pid"
ends "$master_pid" 0 master
for n in $nodes; do
	eval "kill -TERM \$pid_$n"
	eval "ends \$pid_$n 0 $n"
	sed "s/^/$n /" "$dir/$n.swaps"
done >"$dir/swaps"

# One frame, one state, on every wall.
awk '{ key = $2 " " $3; if (key in hash && hash[key] != $4) { print "two states of frame " key; bad = 1 }
	hash[key] = $4; seen[key]++; lines++ }
	END { for (k in seen) whole += seen[k] == 4
		print "# " lines " pictures of " length(seen) " frames, " whole " of them on four walls"; exit bad }' \
	"$dir/swaps" || fail "walls showed two states"

# Around a death, both in the order of time: how long a wall whose node lived showed nothing
# new, from its last picture before to its first after. And a node that joins costs the
# others no frame: theirs follow one on the other, but for what a busy machine leaves out.
# How long, to the millisecond, is judged in the long run, on a machine of its own.
strict=${GROTTO_LONG:+1}
awk -v deadline_ms=$deadline_ms -v kills="$kills" -v strict="${strict:-0}" '
	FNR == NR { who[FNR] = $1; at[FNR] = $2; deaths = FNR; next }
	{ if ($1 != node) { node = $1; last = session = 0; k = 1 }
	  died = 0
	  for (; k <= deaths && at[k] < $5; k++) {
		if (who[k] == node) { died = 1; continue }
		if (!last) continue
		gap = ($5 - last) / 1e6
		what = who[k] == "master" ? 1 : 2
		if (gap > most[what]) most[what] = gap
		sum[what] += gap; count[what]++ }
	  if (last && !died && $2 == session) { shown++; left += $3 - frame - 1 }
	  session = $2; frame = $3; last = $5 }
	END {
		if (count[1] != 4 * kills || count[2] != 12 * kills) { print "not every death was seen: " count[1] + 0 ", " count[2] + 0; exit 1 }
		printf "# longest gap of a living wall at a death, ms: the master\047s %.0f (mean %.0f of %d), another node\047s %.0f (mean %.0f of %d)\n",
			most[1], sum[1] / count[1], count[1], most[2], sum[2] / count[2], count[2]
		printf "# of %d frames walls that lived left out %d\n", shown + left, left
		exit most[2] > (strict ? 3 * deadline_ms + 300 : 6000) || most[1] > 6000 || shown < 100 ||
			left > (strict ? 0.02 : 0.2) * shown }' \
	"$dir/killed" "$dir/swaps" ||
	fail "a wall stood still for longer than three frames and the rejoining, or left frames out"
echo "ok: $((4 * kills)) nodes died, the other walls went on"
