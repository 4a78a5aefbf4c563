#!/bin/sh
# grotto demo judges its processes: with test doubles of the daemons that die,
# crash, hang, miss frames or hold another state. No GL is needed.
. "${srcdir:-.}/tests/command/lib.sh"
srcdir=$(cd "$srcdir" && pwd)

# The command looks for daemons beside itself first.
cp "$grotto" "$work/grotto"
cp "$srcdir/tests/command/double.sh" "$work/grotto-master"
cp "$srcdir/tests/command/double.sh" "$work/grotto-node"
chmod +x "$work"/grotto-*
cat >"$work/a.scene" <<'EOF'
name = "a";
model = "box.gltf";
EOF
cp "$srcdir/scenes/box.gltf" "$work/box.gltf"
DOUBLE_FRAMES=4 DOUBLE_PICTURE=$srcdir/tests/data/picture.png DOUBLE_FAULT=
export DOUBLE_FRAMES DOUBLE_PICTURE DOUBLE_FAULT

# demo FAULT [OPTION...]: runs it, leaves its words in $said and its status in $status
demo() {
	DOUBLE_FAULT=$1
	shift
	said=$("$work/grotto" demo --layout "$srcdir/layouts/cave4.cave" --scene "$work/a.scene" \
		--frames 4 --out "$work/out" --pixels-scale 0.1 "$@" 2>&1)
	status=$?
}
# refused FAULT WORDS: it must fail and say so
refused() {
	demo "$1"
	[ $status -eq 1 ] || fail "$1: exit $status: $said"
	case $said in
	*"$2"*) ;;
	*) fail "$1: '$2' is not in: $said" ;;
	esac
	grep -q '"ok": *false' "$work/out/summary.json" || fail "$1: summary.json says ok"
}

demo none
[ $status -eq 0 ] || fail "all well: exit $status: $said"
grep -q '"ok": *true' "$work/out/summary.json" || fail "all well: summary.json is not ok"
for wall in front left right floor; do
	[ -s "$work/out/wall-$wall.png" ] || fail "no wall-$wall.png"
	[ -s "$work/out/node-$wall.log" ] || fail "no log of $wall"
done
[ -s "$work/out/room.png" ] || fail "no room.png"
"$grotto" check "$work/out/layout.cave" >/dev/null ||
	fail "the planned layout is refused"
[ -z "$(find /tmp -maxdepth 1 -name 'grotto-??????' -newer "$work/a.scene" -user "$(id -u)" -empty 2>/dev/null)" ] ||
	fail "the socket's folder is left behind"

refused left:die "left ended with status 3"
refused right:crash "right was killed by signal 6"
refused floor:miss "floor swapped 3 of 4 frames"
refused front:differ "front held another state"
refused front:state "front ended with state 00000000000000bb, the master with 00000000000000aa"
refused front:garbage "front left no report"
refused front:silent "front left no report"
refused master:die "master ended with status 3"
refused master:silent "the master left no report"
demo floor:blind
[ $status -eq 1 ] || fail "a node without pictures: exit $status"
case $said in *"floor: left no picture"*) ;; *) fail "blind: $said" ;; esac

# A master that hangs is ended after the patience; its nodes' reports do not help.
demo master:hang --patience 1
[ $status -eq 1 ] || fail "a hanging master: exit $status"
case $said in *"no new frame for 1 s"*) ;; *) fail "hang: $said" ;; esac

# So is a node that goes on after its master has ended.
demo floor:hang --patience 1
[ $status -eq 1 ] || fail "a hanging node: exit $status"
case $said in *"floor did not end"*) ;; *) fail "node hang: $said" ;; esac
case $said in *"front "*"signal"*) fail "innocent nodes are blamed: $said" ;; esac

# A person who interrupts gets everything ended.
DOUBLE_FAULT=master:hang
rm -f "$work/out/master.log"
"$work/grotto" demo --layout "$srcdir/layouts/cave4.cave" --scene "$work/a.scene" --frames 4 \
	--out "$work/out" >"$work/said" 2>&1 &
demo_pid=$!
tries=0
while ! grep -q hang "$work/out/master.log" 2>/dev/null && [ $tries -lt 100 ]; do
	sleep 0.05
	tries=$((tries + 1))
done
children=$(cat "/proc/$demo_pid/task/$demo_pid/children" 2>/dev/null)
kill -TERM $demo_pid
wait $demo_pid
[ $? -eq 1 ] || fail "interrupted: not exit 1: $(cat "$work/said")"
grep -q 'asked for' "$work/said" || fail "interrupted: frames that were not: $(cat "$work/said")"
for child in $children; do
	[ ! -d "/proc/$child" ] || fail "process $child outlives its demo"
done

# Wrong words are refused before anything runs.
for wrong in "--frames 0" "--frames many" "--pixels-scale 0" "--rate -1" "--size 3" extra; do
	# shellcheck disable=SC2086
	"$work/grotto" demo $wrong >/dev/null 2>&1
	[ $? -eq 2 ] || fail "demo $wrong: exit $?"
done
demo none --pixels-scale 0.001
[ $status -eq 2 ] || fail "pixels scaled to nothing: exit $status: $said"
demo none --layout "$srcdir/tests/data/bad/empty.cave"
[ $status -eq 2 ] || fail "a faulty layout: exit $status: $said"

# Nothing is started for an input that cannot be used.
cat >"$work/nowhere.scene" <<'EOF'
name = "nowhere";
model = "nowhere.gltf";
EOF
# unfit WORDS OPTION...: exit 2 with these words, and no process was started
unfit() {
	words=$1
	shift
	rm -f "$work"/out/*.log
	demo none "$@"
	[ $status -eq 2 ] || fail "demo $*: exit $status: $said"
	case $said in *"$words"*) ;; *) fail "demo $*: '$words' is not in: $said" ;; esac
	case $said in *" frames of "* | *"start and end"*) fail "demo $*: runs on: $said" ;; esac
	[ -z "$(find "$work/out" -name '*.log')" ] || fail "demo $*: a process was started"
}
unfit nowhere.gltf --scene "$work/nowhere.scene"
unfit truncated.gltf --scene "$srcdir/tests/data/bad/model-truncated.scene"
unfit none.scene --scene "$work/none.scene"
unfit none.cave --layout "$work/none.cave"
unfit "no folder" --out "$work/a.scene"
unfit --out --out "$work/a.scene/below"
unfit --out --out /proc/nowhere
if [ "$(id -u)" -ne 0 ]; then
	mkdir "$work/closed" && chmod 500 "$work/closed"
	unfit --out --out "$work/closed"
fi
for scene in "$work/none.scene" "$work/nowhere.scene"; do
	said=$("$work/grotto" render "$scene" -o "$work/out/still.png" 2>&1)
	status=$?
	[ $status -eq 2 ] || fail "render $scene: exit $status: $said"
done

[ $failed -eq 0 ] && echo "ok"
exit $failed
