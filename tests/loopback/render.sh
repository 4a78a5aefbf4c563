#!/bin/sh
# grotto render: stills without daemons, and what it refuses.
. "${srcdir:-.}/tests/loopback/lib.sh"
need_gl
scene=$srcdir/tests/data/loop.scene

said=$("$grotto" render "$scene" --camera front --size 96x64 --frame 3 -o "$work/a.png" 2>&1) ||
	fail "png: $said"
"$picture" "$work/a.png" 96x64 || fail "a.png shows nothing"
case $said in *shade*ms*) ;; *) fail "no stage times: $said" ;; esac
said=$("$grotto" render "$scene" -o "$work/all.exr" 2>&1) || fail "exr: $said"
said=$("$grotto" render "$scene" --indirect -o "$work/indirect.exr" 2>&1) || fail "indirect: $said"
for file in all indirect; do
	[ "$(od -An -tx1 -N4 "$work/$file.exr" | tr -d ' ')" = 762f3101 ] || fail "$file.exr is no EXR"
done
cmp -s "$work/all.exr" "$work/indirect.exr" && fail "--indirect is the whole light"

# refused STATUS WORDS OPTION...
refused() {
	want=$1 words=$2
	shift 2
	said=$("$grotto" render "$@" 2>&1)
	status=$?
	[ $status -eq "$want" ] || fail "render $*: exit $status, not $want"
	case $said in *"$words"*) ;; *) fail "render $*: '$words' is not in: $said" ;; esac
}
refused 2 "it has 'front'" "$scene" --camera none -o "$work/b.png"
refused 2 "-o FILE.exr or FILE.png" "$scene" -o "$work/b.jpg"
refused 2 "-o FILE.exr or FILE.png" "$scene"
refused 2 "WIDTHxHEIGHT" "$scene" --size 0x5 -o "$work/b.png"
refused 2 "there-is-no-such.gltf" "$srcdir/tests/data/bad/no-model.scene" -o "$work/b.png"
refused 2 "--indirect" "$scene" --indirect -o "$work/b.png"
refused 1 "" "$scene" -o "$work/none/b.png"

# Nobody listens.
said=$("$grotto" status --socket "$work/none" 2>&1)
[ $? -eq 1 ] || fail "status without a master: $said"
[ $failed -eq 0 ] && echo "ok"
exit $failed
