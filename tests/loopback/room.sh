# Sourced by the loopback tests: real daemons, real UDP on 127.0.0.1, tiny walls,
# a folder and ports of their own. Everything started here is ended here.
set -u
srcdir=${srcdir:-.}
builddir=${builddir:-.}
master_bin=$builddir/daemon/grotto-master
node_bin=$builddir/daemon/grotto-node
ask_bin=$builddir/tests/loopback/ask
# Mesa's drivers leak at exit; leaks of our own are looked for in the unit tests.
export ASAN_OPTIONS="detect_leaks=0:abort_on_error=0${ASAN_OPTIONS:+:$ASAN_OPTIONS}"
unset NOTIFY_SOCKET WATCHDOG_USEC 2>/dev/null

dir=$(mktemp -d "${TMPDIR:-/tmp}/grotto-loopback-XXXXXX") || exit 1
# Eight ports that no other test has: a lock, which ends with the last of our processes.
slot=$(($$ % 1000))
ports() { echo "${TMPDIR:-/tmp}/grotto-ports-$(id -u)-$slot"; }
while exec 9> "$(ports)" && ! flock -n 9; do slot=$(((slot + 1) % 1000)); done
port=$((20000 + slot * 8))
nodes="front left right floor"
pids=

finish() {
	for pid in $pids; do kill -9 "$pid" 2>/dev/null; done
	wait 2>/dev/null
	rm -f "$(ports)"
	if [ "$1" -eq 0 ] || [ "$1" -eq 77 ]; then rm -rf "$dir"; else echo "# left behind: $dir"; fi
}
trap 'status=$?; trap - EXIT; finish $status; exit $status' EXIT
trap 'exit 1' HUP INT TERM

fail() {
	echo "FAIL: $*"
	tail -n 12 "$dir"/*.log 2>/dev/null
	exit 1
}

# make_room PIXELS DEADLINE_MS: layout and scene
make_room() {
	sed -e "s/@PORT@/$port/" -e "s/@PORT1@/$((port + 1))/" -e "s/@PORT2@/$((port + 2))/" \
	    -e "s/@PORT3@/$((port + 3))/" -e "s/@PORT4@/$((port + 4))/" -e "s/@PIXELS@/$1/g" \
	    -e "s/@DEADLINE@/$2/" "$srcdir/tests/loopback/room.cave.in" > "$dir/room.cave" || exit 1
	cp "$srcdir/tests/loopback/cell.scene" "$srcdir/scenes/cornell-spot.gltf" "$dir" || exit 1
}

# start_master ARGS...: its pid in $master_pid, its words in master.log
start_master() {
	"$master_bin" --layout "$dir/room.cave" --scene "$dir/cell.scene" --control "$dir/control" \
		--report "$dir/master.json" "$@" >> "$dir/master.log" 2>&1 &
	master_pid=$!
	pids="$pids $master_pid"
}

# start_node NAME ARGS...: its pid in $pid_NAME
start_node() {
	name=$1
	shift
	"$node_bin" --layout "$dir/room.cave" --scene "$dir/cell.scene" --node "$name" \
		--target headless --report "$dir/$name.json" "$@" >> "$dir/$name.log" 2>&1 &
	eval "pid_$name=$!"
	pids="$pids $!"
}

# ends PID STATUS WHAT: waits for a process and looks at its exit status
ends() {
	wait "$1"
	status=$?
	[ "$status" -eq "$2" ] || fail "$3 ended with $status, not $2"
}

# wait_for SECONDS COMMAND...: until it succeeds
wait_for() {
	left=$(($1 * 20))
	shift
	until "$@"; do
		left=$((left - 1))
		[ "$left" -gt 0 ] || fail "waited in vain for: $*"
		sleep 0.05
	done
}

says() { grep -q -- "$2" "$dir/$1.log" 2>/dev/null; }
count() { grep -c -- "$2" "$dir/$1.log" 2>/dev/null; }

# field FILE KEY: the first value of that name in a one-line JSON document
field() { grep -o "\"$2\":[^,}]*" "$1" | head -n 1 | cut -d: -f2- | tr -d '"'; }
# node_field FILE NODE KEY: of that node in the master's list
node_field() { grep -o "{\"name\":\"$2\"[^}]*}" "$1" | grep -o "\"$3\":[^,}]*" | cut -d: -f2- | tr -d '"'; }

ask() { "$ask_bin" "$dir/control" "$@"; }
status_to() { ask status > "$dir/status.json" 2>/dev/null; }
frame_is_past() { status_to && [ "$(field "$dir/status.json" frame)" -gt "$1" ]; }

# Skips the test where no node can draw.
need_gl() {
	start_node front
	wait_for 120 node_tried front
	if ! says front "draws with"; then
		grep -h "GL" "$dir/front.log"
		echo "SKIP: no OpenGL 4.5 here"
		exit 77
	fi
	kill "$pid_front"
	wait "$pid_front"
	rm -f "$dir/front.log"
}
node_tried() { says "$1" "draws with" || ! eval "kill -0 \$pid_$1" 2>/dev/null; }

all_equal() { [ "$(printf '%s\n' "$@" | sort -u | wc -l)" -eq 1 ]; }
light_hashes() { for n in $nodes; do field "$dir/$n.json" light_hash; done; }
