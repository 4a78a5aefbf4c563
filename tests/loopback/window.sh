#!/bin/sh
# The walls in GLFW windows, on a virtual X server.
. "${srcdir:-.}/tests/loopback/lib.sh"
command -v xvfb-run >/dev/null || skip "xvfb-run is not installed"
command -v xauth >/dev/null || skip "xauth is not installed"
need_gl

xvfb-run -a -s '-noreset -screen 0 1024x768x24' "$grotto" demo --window \
	--layout "$srcdir/tests/data/halves.cave" --scene "$srcdir/tests/data/loop.scene" \
	--frames 5 --out "$work/out" >"$work/said" 2>&1 || {
	fail "demo --window: exit $?"
	cat "$work/said"
}
check_summary "$work/out/summary.json" 5 4
jq -e '.nodes | all(.platform | test("GLFW|X11|GLX|window"; "i"))' "$work/out/summary.json" >/dev/null ||
	fail "not in windows: $(jq -c '[.nodes[].platform]' "$work/out/summary.json")"
"$picture" "$work/out/wall-front.png" 64x48 || fail "wall-front.png"
[ $failed -eq 0 ] && echo "ok"
exit $failed
