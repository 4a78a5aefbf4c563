#!/bin/sh
# A whole cave on loopback: master and four nodes, twice, with the same result;
# then half-wall nodes in stereo and an eye per node.
. "${srcdir:-.}/tests/loopback/lib.sh"
need_gl

# demo OUT FRAMES [OPTION...]
demo() {
	out=$work/$1 frames=$2
	shift 2
	"$grotto" demo --scene "$srcdir/tests/data/loop.scene" --frames "$frames" --out "$out" "$@" \
		>"$out.said" 2>&1 || { fail "demo: exit $?"; cat "$out.said"; }
}

demo cave 20 --layout "$srcdir/layouts/cave4.cave" --pixels-scale 0.125 --every 10 --exr
check_summary "$work/cave/summary.json" 20 4
sed -n '/swap skew/p; /commit to/p; /frames in/p' "$work/cave.said"
for wall in front left right; do
	"$picture" "$work/cave/wall-$wall.png" 64x48 || fail "wall-$wall.png"
done
"$picture" "$work/cave/wall-floor.png" 64x64 || fail "wall-floor.png"
# Left, front and right in a row, the floor below: 3 x 3 m by 2.25 + 3 m.
"$picture" "$work/cave/room.png" 192x112 || fail "room.png"
for frame in 000010 000020; do
	[ -s "$work/cave/front-$frame.png" ] && [ -s "$work/cave/front-$frame.exr" ] ||
		fail "no pictures of frame $frame: $(ls "$work/cave")"
done
cmp -s "$work/cave/front-000010.png" "$work/cave/front-000020.png" &&
	fail "nothing moved in ten frames"

# What is shown is a function of the frame's number alone.
demo again 20 --layout "$srcdir/layouts/cave4.cave" --pixels-scale 0.125
for wall in front left right floor; do
	cmp "$work/cave/wall-$wall.png" "$work/again/wall-$wall.png" || fail "$wall differs"
done

demo halves 6 --layout "$srcdir/tests/data/halves.cave"
check_summary "$work/halves/summary.json" 6 4
"$picture" "$work/halves/wall-front.png" 64x48 || fail "wall-front.png of halves"
"$picture" "$work/halves/wall-floor.png" 48x48 || fail "wall-floor.png of eyes"

[ $failed -eq 0 ] && echo "ok"
exit $failed
