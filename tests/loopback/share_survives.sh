#!/bin/sh
# The light is shared out while nodes die and return: the others take the dead one's
# part over, and all that live hold the same light in the end.
. "${srcdir:-.}/tests/loopback/room.sh"
make_room "32, 24" 2000.0
sed -i 's/^gi = .*/gi = { method = "surfels"; share = "cluster"; surfels = { links = 64; probes = 2; }; };/' \
	"$dir/cell.scene"
# The torch circles, so that every frame has new light.
sed -i 's/mount = "wand";/mount = "orbit"; orbit_center = [2.78, 5.0, 2.8]; orbit_radius_m = 1.0; orbit_period_s = 1.0; direction = [0.0, -1.0, 0.0];/' \
	"$dir/cell.scene"
grep -q orbit "$dir/cell.scene" && grep -q cluster "$dir/cell.scene" || fail "the scene is not the one that was meant"
need_gl

# share KEY: of the master's status
share() { grep -o '"share":{[^}]*}' "$dir/status.json" | tail -n 1 | grep -o "\"$1\":[^,}]*" | cut -d: -f2; }
divided_by() { status_to && [ "$(share nodes)" -eq "$1" ]; }

start_master --frame-clock --wait-all
for n in $nodes; do start_node $n --once; done
wait_for 120 frame_is_past 20
divided_by 4 || fail "the light is not shared by four: $(share nodes)"
[ "$(share slices)" -gt 40 ] || fail "slices are not passed on: $(share slices)"

kill -9 "$pid_left"
wait "$pid_left" 2>/dev/null
wait_for 60 divided_by 3
before=$(field "$dir/status.json" frame)
wait_for 60 frame_is_past $((before + 10))
echo "ok: three share the light of a killed fourth"

mv "$dir/left.log" "$dir/left-killed.log"
start_node left --once
wait_for 120 divided_by 4
before=$(field "$dir/status.json" frame)
wait_for 60 frame_is_past $((before + 10))
echo "ok: its restart has a part again"

# At rest: lamps that move are switched off, and the last of the light arrives.
ask set lamp torch off >/dev/null
status_to
before=$(field "$dir/status.json" frame)
wait_for 60 frame_is_past $((before + 60))
slices=$(share slices)
before=$(field "$dir/status.json" frame)
wait_for 60 frame_is_past $((before + 20))
[ "$(share slices)" -eq "$slices" ] || fail "slices of a light at rest are sent"
kill -TERM "$master_pid"
ends "$master_pid" 0 master
for n in $nodes; do
	eval "ends \$pid_$n 0 $n"
	[ "$(field "$dir/$n.json" refused)" -eq 0 ] || fail "$n refused a slice"
done
all_equal $(light_hashes) || fail "the nodes' light differs: $(light_hashes | tr '\n' ' ')"
[ "$(field "$dir/front.json" light_hash)" != 0000000000000000 ] || fail "no light was computed"
echo "ok: all hold the same light, and nothing is sent of it at rest"
