#!/bin/sh
# grotto reference: files, resuming, and what is refused with exit status 2.
set -u
: "${srcdir:=.}" "${builddir:=.}"
grotto=$builddir/tools/grotto
scene=$srcdir/scenes/cornell-spot.scene
failed=0
[ -x "$grotto" ] || { echo "FAIL: $grotto is not built"; exit 1; }
fail() {
	echo "FAIL: $*"
	failed=1
}
folder=reference.work.$$
rm -rf "$folder" && mkdir "$folder" || exit 1
trap 'rm -rf "$folder"' EXIT

# In one go and in two: the same bytes. Threads do not matter.
reference() {
	"$grotto" reference "$scene" --size 24x24 --bounces 8 "$@" 2>&1
}
said=$(reference -n 96 -j 1 -o "$folder/once.exr") || fail "one go: $said"
said=$(reference -n 32 -j 2 --resume "$folder/film" --png "$folder/first.png") || fail "first half: $said"
said=$(reference -n 96 -j 3 --resume "$folder/film" -o "$folder/twice.exr") || fail "second half: $said"
case $said in *"goes on from 32 samples"*) ;; *) fail "not resumed: $said" ;; esac
cmp "$folder/once.exr" "$folder/twice.exr" || fail "resumed is not the same"
[ -s "$folder/first.png" ] || fail "no PNG"

# A wall, seen by one eye.
said=$(reference -n 32 --layout "$srcdir/layouts/cave4.cave" --wall left --head 0.2,1.6,0.3 \
	--eye right -o "$folder/wall.exr") || fail "wall: $said"

# Points of a file, and of surfels.
printf 'x,y,z,nx,ny,nz\n1,0,1,0,2,0\n# a comment\n2,0,0.5,0,1,0\n' >"$folder/points.csv"
said=$(reference -n 64 --points "$folder/points.csv" --points-out "$folder/out.csv") || fail "points: $said"
[ "$(wc -l <"$folder/out.csv")" = 3 ] || fail "points: $(cat "$folder/out.csv")"
said=$(reference -n 32 --bounces 0 --surfels --points-out "$folder/surfels.csv") || fail "surfels: $said"
[ "$(wc -l <"$folder/surfels.csv")" -gt 100 ] || fail "surfels: few lines"

# refused WORDS ARGUMENT...: exit status 2, and the words are said
refused() {
	words=$1
	shift
	said=$(reference "$@")
	status=$?
	[ $status = 2 ] || fail "$*: exit $status: $said"
	case $said in *"$words"*) ;; *) fail "$*: does not say '$words': $said" ;; esac
}
head -c 300 "$folder/film" >"$folder/cut"
sed 's/^/x/' "$folder/film" >"$folder/none"
refused "cut short" -n 96 --resume "$folder/cut" -o "$folder/x.exr"
refused "no film" -n 96 --resume "$folder/none" -o "$folder/x.exr"
refused "belongs to another" -n 96 --seed 2 --resume "$folder/film" -o "$folder/x.exr"
printf '1,2,3,0,0,0\n4,5\n' >"$folder/bad.csv"
refused "bad.csv:1: not a point" --points "$folder/bad.csv" --points-out "$folder/x.csv"
printf '0,0,0,0,1,0\n0,0,1e30,0,1,0\n' >"$folder/far.csv"
refused "far.csv:2: not a point" --points "$folder/far.csv" --points-out "$folder/x.csv"
refused "zero:1: not a point" --points /dev/zero --points-out "$folder/x.csv"
printf '1,0,1,0,1,nan\n1,0,1,0,1,nan\n' >"$folder/bad.csv"
refused "not a point" --points "$folder/bad.csv" --points-out "$folder/x.csv"
refused "has no wall 'frnt'" --layout "$srcdir/layouts/cave4.cave" --wall frnt -o "$folder/x.exr"
refused "not in front of wall" --layout "$srcdir/layouts/cave4.cave" --wall front --head 0,1,-90 -o "$folder/x.exr"
refused "is not X,Y,Z" --layout "$srcdir/layouts/cave4.cave" --wall front --head 0,1 -o "$folder/x.exr"
refused "has no camera 'nobody'" --camera nobody -o "$folder/x.exr"
refused "needs --out"
refused "--eye is left or right" --layout x --wall y --eye up -o "$folder/x.exr"
printf 'nan,0,1,0,1,0\n' >"$folder/bad.csv"
refused "bad.csv:1: not a point" --points "$folder/bad.csv" --points-out "$folder/x.csv"
[ ! -e "$folder/x.exr" ] && [ ! -e "$folder/x.csv" ] || fail "a refused command wrote something"

# A pipe is not replaced by a file, nor removed.
mkfifo "$folder/pipe"
timeout 60 "$grotto" bake "$scene" --out "$folder/pipe" >"$folder/bake.log" 2>&1
"$grotto" reference "$scene" --size 16x16 -n 32 -o "$folder/pipe" >"$folder/pipe.log" 2>&1 &&
	fail "a picture went into a pipe"
[ -p "$folder/pipe" ] || fail "bake: the pipe is gone: $(cat "$folder/bake.log")"

# A folder that is not there is found before anything is traced.
said=$(timeout 20 "$grotto" reference "$scene" --size 24x24 -n 100000000 --resume "$folder/none.d/film" \
	-o "$folder/x.exr" 2>&1)
[ $? = 1 ] || fail "resume to no folder: exit $?: $said"
case $said in *"none.d/film: its folder cannot be written"*) ;; *) fail "resume to no folder: $said" ;; esac

# Ctrl-C: what there is, and the sums to go on from.
"$grotto" reference "$scene" --size 24x24 -n 100000000 --resume "$folder/long" -o "$folder/long.exr" \
	>"$folder/long.log" 2>&1 &
pid=$!
sleep 2
kill -INT $pid
wait $pid || fail "interrupted: exit $?: $(cat "$folder/long.log")"
grep -q "ended early" "$folder/long.log" || fail "interrupted: $(cat "$folder/long.log")"
[ -s "$folder/long" ] && [ -s "$folder/long.exr" ] || fail "interrupted: no files"

# A crash or a loss of power: what was kept meanwhile is whole, and is gone on from.
"$grotto" reference "$scene" --size 24x24 -n 100000000 --resume "$folder/crash" --keep-every 1 \
	-o "$folder/crash.exr" >"$folder/crash.log" 2>&1 &
pid=$!
sleep 3
kill -KILL $pid
wait $pid 2>/dev/null
[ ! -e "$folder/crash.exr" ] || fail "killed: wrote a picture"
said=$("$grotto" reference "$scene" --size 24x24 -n 32 --resume "$folder/crash" -o "$folder/crash.exr" 2>&1) ||
	fail "after a crash: $said"
case $said in *"goes on from "*" samples"*) ;; *) fail "after a crash: begins anew: $said" ;; esac

# Nothing shines: black is known to be black before all samples are taken.
sed -e 's/^name = .*/name = "dark";/' -e "s|^model = .*|model = \"$(cd "$srcdir" && pwd)/scenes/cornell-spot.gltf\";|" \
	-e 's/318.31/0.0/g' "$scene" >"$folder/dark.scene"
said=$(timeout 60 "$grotto" reference "$folder/dark.scene" --size 24x24 -n 100000000 --until-error 1 \
	-o "$folder/dark.exr" 2>&1) || fail "black: $said"
case $said in *"128 samples a pixel, standard error 0.000 %"*) ;; *) fail "black: $said" ;; esac
said=$("$grotto" reference "$folder/dark.scene" --size 24x24 -n 32 -o "$folder/dark.exr" 2>&1) || fail "black: $said"
case $said in *"standard error not known"*) ;; *) fail "black, few samples: $said" ;; esac

# Surfels that are baked are read; their places are those that are found without.
said=$("$grotto" reference "$folder/dark.scene" -n 32 --bounces 0 --surfels --points-out "$folder/without.csv" 2>&1) ||
	fail "surfels, none baked: $said"
"$grotto" bake "$folder/dark.scene" >"$folder/dark.log" 2>&1 || fail "bake: $(cat "$folder/dark.log")"
said=$("$grotto" reference "$folder/dark.scene" -n 32 --bounces 0 --surfels --points-out "$folder/with.csv" 2>&1) ||
	fail "surfels, baked: $said"
case $said in *"dark.surfels: "*" surfels"*) ;; *) fail "the bake was not read: $said" ;; esac
cmp "$folder/without.csv" "$folder/with.csv" || fail "places of baked surfels are others"
exit $failed
