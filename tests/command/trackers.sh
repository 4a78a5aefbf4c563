#!/bin/sh
# grotto trackers without a master: what the simulated visitor does is shown, written as
# a log, and read again; a device that is not there is said to be absent, and why.
. "${srcdir:-.}/tests/command/lib.sh"
command -v jq >/dev/null || skip "jq is not installed"

# room TRACKERS: a layout with these
room() {
	cat >"$work/room.cave" <<-END
		walls = ( { name = "front"; center = [0.0, 1.5, -1.5]; size = [3.0, 3.0]; pixels = [64, 64];
		    nodes = ( { address = "127.0.0.1"; port = 5001; } ); } );
		network = { master_port = 5000; };
		room = { min = [-2.0, 0.0, -1.4]; max = [2.0, 3.0, 2.0]; };
		trackers = ( $1 );
	END
}
trackers() { "$grotto" trackers --open --layout "$work/room.cave" "$@"; }

room '{ name = "visitor"; kind = "sim"; wand = false; },
      { name = "wands"; kind = "hydra"; bind = ( { body = "wand"; sensor = "right"; } ); }'
trackers --seconds 1 --json --record "$work/head.log" >"$work/json" 2>"$work/said" ||
	fail "does not open: $(cat "$work/said")"
jq -e '.ok and (.trackers | length == 2) and .trackers[0].state == "running" and
	.trackers[0].kind == "sim" and .trackers[0].reports > 0 and .trackers[0].tracked == ["head"] and
	(.trackers[0].poses[0] | .body == "head" and .tracked and (.position_m | length == 3)) and
	.trackers[1].kind == "hydra" and .trackers[1].reports == 0 and .trackers[1].poses == []' \
	"$work/json" >/dev/null || fail "says $(cat "$work/json")"
# Where a Hydra is plugged in it may be anything else.
case $(jq -r '.trackers[1].state + ": " + .trackers[1].why' "$work/json") in
"absent: no Razer Hydra (1532:0300) is plugged in" | denied:* | running:* | busy:*) ;;
*) fail "the device: $(jq -c '.trackers[1]' "$work/json")" ;;
esac
lines=$(grep -c '^[0-9][0-9.]* head 1 ' "$work/head.log")
[ "$lines" -ge 2 ] || fail "$lines samples in the log: $(head -n 3 "$work/head.log")"
grep -q ": $lines samples, 0 refused$" "$work/said" || fail "says of the log: $(cat "$work/said")"

room '{ name = "again"; kind = "replay"; file = "head.log"; wand = false; }'
trackers --seconds 0.5 >"$work/text" || fail "the log is not read again"
grep -q '^again  *replay  *running ' "$work/text" || fail "shows $(cat "$work/text")"
grep -q '^    head  *-*[0-9.]* ' "$work/text" || fail "no pose: $(cat "$work/text")"

# wrong WHAT ARGUMENT...: refused with status 2 and these words
wrong() {
	what=$1
	shift
	said=$("$grotto" trackers "$@" 2>&1)
	[ $? -eq 2 ] || fail "trackers $*: not refused with 2"
	case $said in
	*"$what"*) ;;
	*) fail "trackers $*: says $said" ;;
	esac
}
wrong "need --layout" --open
wrong "not both" --layout "$work/room.cave" --socket "$work/none"
wrong "asks no master" --layout "$work/room.cave" --socket "$work/none" --open
# Neither a log nor what was measured is written over the layout, by whatever name it goes.
room '{ name = "wands"; kind = "hydra"; bind = ( { body = "wand"; sensor = "right"; } ); }'
ln -s room.cave "$work/link.cave"
echo "a 0 0 0" >"$work/points"
cp "$work/room.cave" "$work/before.cave"
wrong "write over the layout" --layout "$work/room.cave" --seconds 0.2 --record "$work/link.cave"
wrong "write over the layout" calibrate --layout "$work/link.cave" --points "$work/points" --keep "$work/room.cave" --open </dev/null
cmp -s "$work/room.cave" "$work/before.cave" || fail "the layout is another now"
room '{ name = "wands"; kind = "hydra"; bind = ( { body = "wand"; sensor = "middle"; buttons = "1 fire"; } ); }'
wrong 'sensor: "middle" is no sensor of a hydra; it has left, right' --open --layout "$work/room.cave"
room '{ name = "wands"; kind = "hydra"; bind = ( { body = "wand"; buttons = "1 fire"; } ); }'
wrong 'buttons: "fire" is nothing that this device has; it has bumper, 1, 2' --open --layout "$work/room.cave"
said=$("$grotto" check "$work/room.cave" 2>&1) && fail "grotto check takes a button that is none"
case $said in
*'room.cave:5: buttons: "fire"'*) ;;
*) fail "grotto check says $said" ;;
esac
said=$("$grotto" trackers --socket "$work/none" 2>&1)
[ $? -eq 1 ] || fail "no master, but no status 1"
[ $failed -eq 0 ] && echo "ok"
exit $failed
