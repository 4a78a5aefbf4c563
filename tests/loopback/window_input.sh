#!/bin/sh
# Keyboard and mouse in a node's window, on a virtual X server, drive the master's hand.
if [ "${1:-}" != inside ]; then
	command -v xvfb-run >/dev/null || { echo "SKIP: xvfb-run is not installed"; exit 77; }
	command -v xauth >/dev/null || { echo "SKIP: xauth is not installed"; exit 77; }
	exec xvfb-run -a -s '-noreset -screen 0 640x480x24' "$0" inside
fi
. "${srcdir:-.}/tests/loopback/room.sh"
command -v jq >/dev/null || { echo "SKIP: jq is not installed"; exit 77; }
type_bin=$builddir/tests/loopback/type
[ -x "$type_bin" ] || { echo "SKIP: built without Xlib"; exit 77; }
make_room "64, 48" 20000.0
cat > "$dir/room.cave" <<END
name = "desk";
walls = ( { name = "monitor"; center = [0.0, 1.05, -0.7]; size = [0.6, 0.45]; pixels = [64, 48];
	nodes = ( { address = "127.0.0.1"; port = $((port + 1)); target = "window"; } ); } );
network = { master_address = "127.0.0.1"; master_port = $port; };
rates = { frame_hz = 60.0; barrier_deadline_ms = 20000.0; };
room = { min = [-0.6, 0.5, -0.8]; max = [0.6, 1.8, 0.8]; };
start = { head = [0.0, 1.2, 0.0]; wand = [0.0, 1.1, -0.4]; };
trackers = ( { name = "window"; kind = "window"; } );
END
"$node_bin" --layout "$dir/room.cave" --scene "$dir/cell.scene" --node monitor >> "$dir/monitor.log" 2>&1 &
pid_monitor=$!
pids=$!
wait_for 120 node_tried monitor
says monitor "draws with" || { grep -h "GL\|window" "$dir/monitor.log"; echo "SKIP: no OpenGL 4.5 in a window"; exit 77; }
start_master
wait_for 120 frame_is_past 5

person() { "$type_bin" monitor "$@" || fail "type $*"; }
hand() { status_to && jq -e "$1" "$dir/status.json" > /dev/null; }
wand() { ask trackers > "$dir/trackers.json" && jq -e ".trackers[0].poses[0] | $1" "$dir/trackers.json" > /dev/null; }
wait_for 60 hand '.tracking.wand_tracked and .hand.layout == "navigation"'

# Held, the space bar flies the room to where the pointer points.
person point 0.5 0.5
status_to
from=$(jq -c .hand.room_m "$dir/status.json")
person down space
wait_for 60 hand ".hand.room_m != $from"
person up space
wait_for 60 hand '.hand.buttons == 0'
person point 0.0 0.5
wait_for 60 wand '.orientation[1] > 0.3'
person point 1.0 0.5
wait_for 60 wand '.orientation[1] < -0.3'
# Tab goes on, and a tap is one press.
person tap Tab
wait_for 60 hand '.hand.layout == "lighting"'
person down Up
wait_for 60 wand '.axes[1] == 1'
person up Up
wait_for 60 wand '.axes[1] == 0'
person button down 3
wait_for 60 hand '.hand.put_down'
person button up 3
person tap Tab
wait_for 60 hand '.hand.layout == "settings"'
steps=$(jq .settings.gi_steps "$dir/status.json")
person tap 3
wait_for 60 hand ".settings.gi_steps == $((steps + 1))"
echo "ok: keys, buttons and pointer of a window reach the hand"
