#!/bin/sh
# grotto reference: files, resuming, and what is refused with exit status 2.
. "${srcdir:-.}/tests/command/lib.sh"
scene=$srcdir/scenes/cornell-spot.scene

# In one go and in two: the same bytes. Threads do not matter.
reference() {
	"$grotto" reference "$scene" --size 24x24 --bounces 8 "$@" 2>&1
}
said=$(reference -n 96 -j 1 -o "$work/once.exr") || fail "one go: $said"
said=$(reference -n 32 -j 2 --resume "$work/film" --png "$work/first.png") || fail "first half: $said"
said=$(reference -n 96 -j 3 --resume "$work/film" -o "$work/twice.exr") || fail "second half: $said"
case $said in *"goes on from 32 samples"*) ;; *) fail "not resumed: $said" ;; esac
cmp "$work/once.exr" "$work/twice.exr" || fail "resumed is not the same"
[ -s "$work/first.png" ] || fail "no PNG"

# A wall, seen by one eye.
said=$(reference -n 32 --layout "$srcdir/layouts/cave4.cave" --wall left --head 0.2,1.6,0.3 \
	--eye right -o "$work/wall.exr") || fail "wall: $said"

# Points of a file, and of surfels.
printf 'x,y,z,nx,ny,nz\n1,0,1,0,2,0\n# a comment\n2,0,0.5,0,1,0\n' >"$work/points.csv"
said=$(reference -n 64 --points "$work/points.csv" --points-out "$work/out.csv") || fail "points: $said"
[ "$(wc -l <"$work/out.csv")" = 3 ] || fail "points: $(cat "$work/out.csv")"
said=$(reference -n 32 --bounces 0 --surfels --points-out "$work/surfels.csv") || fail "surfels: $said"
[ "$(wc -l <"$work/surfels.csv")" -gt 100 ] || fail "surfels: few lines"

# refused WORDS ARGUMENT...: exit status 2, and the words are said
refused() {
	words=$1
	shift
	said=$(reference "$@")
	status=$?
	[ $status = 2 ] || fail "$*: exit $status: $said"
	case $said in *"$words"*) ;; *) fail "$*: does not say '$words': $said" ;; esac
}
head -c 300 "$work/film" >"$work/cut"
sed 's/^/x/' "$work/film" >"$work/none"
refused "cut short" -n 96 --resume "$work/cut" -o "$work/x.exr"
refused "no film" -n 96 --resume "$work/none" -o "$work/x.exr"
refused "belongs to another" -n 96 --seed 2 --resume "$work/film" -o "$work/x.exr"
printf '1,2,3,0,0,0\n4,5\n' >"$work/bad.csv"
refused "bad.csv:1: not a point" --points "$work/bad.csv" --points-out "$work/x.csv"
printf '0,0,0,0,1,0\n0,0,1e30,0,1,0\n' >"$work/far.csv"
refused "far.csv:2: not a point" --points "$work/far.csv" --points-out "$work/x.csv"
refused "zero:1: not a point" --points /dev/zero --points-out "$work/x.csv"
printf '1,0,1,0,1,nan\n1,0,1,0,1,nan\n' >"$work/bad.csv"
refused "not a point" --points "$work/bad.csv" --points-out "$work/x.csv"
refused "has no wall 'frnt'" --layout "$srcdir/layouts/cave4.cave" --wall frnt -o "$work/x.exr"
refused "not in front of wall" --layout "$srcdir/layouts/cave4.cave" --wall front --head 0,1,-90 -o "$work/x.exr"
refused "is not X,Y,Z" --layout "$srcdir/layouts/cave4.cave" --wall front --head 0,1 -o "$work/x.exr"
refused "has no camera 'nobody'" --camera nobody -o "$work/x.exr"
refused "needs --out"
refused "--eye is left or right" --layout x --wall y --eye up -o "$work/x.exr"
printf 'nan,0,1,0,1,0\n' >"$work/bad.csv"
refused "bad.csv:1: not a point" --points "$work/bad.csv" --points-out "$work/x.csv"
[ ! -e "$work/x.exr" ] && [ ! -e "$work/x.csv" ] || fail "a refused command wrote something"

refused "files of their own" -n 32 --resume "$work/one" -o "$work/one"
refused "files of their own" -n 32 -o "$work/one" --png "$work/one"

# Ended before a standard error is known: no zeros that would pass for light.
awk 'BEGIN { for (i = 0; i < 200000; i++) print 1 + i % 300 / 100 ",0,1,0,1,0" }' >"$work/many.csv"
timeout -s INT 1 "$grotto" reference "$scene" -j 1 -n 4096 --points "$work/many.csv" --points-out "$work/many.out" 2>/dev/null
[ ! -e "$work/many.out" ] || fail "ended early, and wrote $(sed -n 2p "$work/many.out")"

# A pipe is not replaced by a file, nor removed.
mkfifo "$work/pipe"
timeout 60 "$grotto" bake "$scene" --out "$work/pipe" >"$work/bake.log" 2>&1
"$grotto" reference "$scene" --size 16x16 -n 32 -o "$work/pipe" >"$work/pipe.log" 2>&1 &&
	fail "a picture went into a pipe"
[ -p "$work/pipe" ] || fail "bake: the pipe is gone: $(cat "$work/bake.log")"

# A folder that is not there is found before anything is traced.
said=$(timeout 20 "$grotto" reference "$scene" --size 24x24 -n 100000000 --resume "$work/none.d/film" \
	-o "$work/x.exr" 2>&1)
[ $? = 1 ] || fail "resume to no folder: exit $?: $said"
case $said in *"none.d/film: its folder cannot be written"*) ;; *) fail "resume to no folder: $said" ;; esac

# Ctrl-C: what there is, and the sums to go on from.
"$grotto" reference "$scene" --size 24x24 -n 100000000 --resume "$work/long" -o "$work/long.exr" \
	>"$work/long.log" 2>&1 &
pid=$!
sleep 2
kill -INT $pid
wait $pid || fail "interrupted: exit $?: $(cat "$work/long.log")"
grep -q "ended early" "$work/long.log" || fail "interrupted: $(cat "$work/long.log")"
[ -s "$work/long" ] && [ -s "$work/long.exr" ] || fail "interrupted: no files"

# A crash or a loss of power: what was kept meanwhile is whole, and is gone on from.
"$grotto" reference "$scene" --size 24x24 -n 100000000 --resume "$work/crash" --keep-every 1 \
	-o "$work/crash.exr" >"$work/crash.log" 2>&1 &
pid=$!
sleep 3
kill -KILL $pid
wait $pid 2>/dev/null
[ ! -e "$work/crash.exr" ] || fail "killed: wrote a picture"
said=$("$grotto" reference "$scene" --size 24x24 -n 32 --resume "$work/crash" -o "$work/crash.exr" 2>&1) ||
	fail "after a crash: $said"
case $said in *"goes on from "*" samples"*) ;; *) fail "after a crash: begins anew: $said" ;; esac

# Nothing shines: black is known to be black before all samples are taken.
sed -e 's/^name = .*/name = "dark";/' -e "s|^model = .*|model = \"$(cd "$srcdir" && pwd)/scenes/cornell-spot.gltf\";|" \
	-e 's/318.31/0.0/g' "$scene" >"$work/dark.scene"
said=$(timeout 60 "$grotto" reference "$work/dark.scene" --size 24x24 -n 100000000 --until-error 1 \
	-o "$work/dark.exr" 2>&1) || fail "black: $said"
case $said in *"128 samples a pixel, standard error 0.000 %"*) ;; *) fail "black: $said" ;; esac
said=$("$grotto" reference "$work/dark.scene" --size 24x24 -n 32 -o "$work/dark.exr" 2>&1) || fail "black: $said"
case $said in *"standard error not known"*) ;; *) fail "black, few samples: $said" ;; esac

# Surfels that are baked are read; their places are those that are found without.
said=$("$grotto" reference "$work/dark.scene" -n 32 --bounces 0 --surfels --points-out "$work/without.csv" 2>&1) ||
	fail "surfels, none baked: $said"
"$grotto" bake "$work/dark.scene" >"$work/dark.log" 2>&1 || fail "bake: $(cat "$work/dark.log")"
said=$("$grotto" reference "$work/dark.scene" -n 32 --bounces 0 --surfels --points-out "$work/with.csv" 2>&1) ||
	fail "surfels, baked: $said"
case $said in *"dark.surfels: "*" surfels"*) ;; *) fail "the bake was not read: $said" ;; esac
cmp "$work/without.csv" "$work/with.csv" || fail "places of baked surfels are others"
exit $failed
