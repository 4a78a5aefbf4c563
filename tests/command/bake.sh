#!/bin/sh
# grotto bake: with gi.method = "auto" what a node takes, so that it need not bake.
set -u
: "${srcdir:=.}" "${builddir:=.}"
grotto=$builddir/tools/grotto
failed=0
[ -x "$grotto" ] || { echo "FAIL: $grotto is not built"; exit 1; }
fail() {
	echo "FAIL: $*"
	failed=1
}
folder=bake.work.$$
rm -rf "$folder" && mkdir "$folder" || exit 1
trap 'rm -rf "$folder"' EXIT
# nothing of this user's counts, and nothing is left there
XDG_CACHE_HOME=$(pwd)/$folder/cache
export XDG_CACHE_HOME
unset CACHE_DIRECTORY
cp "$srcdir/scenes/box.scene" "$srcdir/scenes/box.gltf" "$folder" || exit 1
scene=$folder/box.scene

said=$("$grotto" bake "$scene" 2>&1) || fail "bake: exit $?: $said"
echo "$said"
case $said in *"without OpenGL"*)
	echo "SKIP: no OpenGL here"
	exit 77 ;;
esac
for words in "as a node on " "costs measured now" "box.surfels: written"; do
	case $said in *"$words"*) ;; *) fail "bake: '$words' is not in: $said" ;; esac
done
apart=$(echo "$said" | sed -n 's/.*surfels \([0-9.]* m apart, [0-9]* links\), .*/\1/p' | head -n 1)
[ -n "$apart" ] || fail "bake: does not say spacing and links"
case $said in *"${apart%%,*}, ${apart#*, } and "*) ;; *) fail "bake: not baked as chosen, $apart: $said" ;; esac

# What it wrote is what a node on this machine reads: it stays as it is, and no other is made.
before=$(cksum <"$folder/box.surfels")
said=$("$grotto" render "$scene" --size 16x16 -o "$folder/box.png" 2>&1) || fail "render: exit $?: $said"
case $said in *"$apart"*) ;; *) fail "render: chooses otherwise than bake, $apart: $said" ;; esac
case $said in *"it is not used"*) fail "render: bakes again: $said" ;; esac
[ "$(cksum <"$folder/box.surfels")" = "$before" ] || fail "render: wrote its own surfels: $said"
[ -z "$(find "$folder/cache" -name '*.surfels')" ] || fail "render: baked into the cache: $said"
said=$("$grotto" bake "$scene" 2>&1) || fail "bake again: exit $?: $said"
for words in "costs kept from before" "box.surfels: is up to date"; do
	case $said in *"$words"*) ;; *) fail "bake again: '$words' is not in: $said" ;; esac
done

# Baked with other settings it is replaced, which is seen by the same two signs.
sed 's/^name = .*/&\ngi = { method = "surfels"; surfels = { spacing_m = 0.6; links = 64; }; };/' "$scene" \
	>"$folder/named.scene"
said=$("$grotto" bake "$folder/named.scene" --out "$folder/box.surfels" 2>&1) || fail "as named: exit $?: $said"
case $said in *"as a node"*) fail "as named: it planned: $said" ;; esac
case $said in *" surfels 0.6 m apart, 64 links"*) ;; *) fail "as named: $said" ;; esac
other=$(cksum <"$folder/box.surfels")
"$grotto" render "$scene" --size 16x16 -o "$folder/box.png" >"$folder/other.log" 2>&1 || fail "render: $(cat "$folder/other.log")"
grep -q "box.surfels: .*it is not used" "$folder/other.log" || fail "other settings: $(cat "$folder/other.log")"
[ "$(cksum <"$folder/box.surfels")" != "$other" ] || fail "other settings: not replaced: $(cat "$folder/other.log")"

# A plan without surfels needs nothing.
sed 's/^name = .*/&\nmedium = { scattering_per_m = 5.0; };/' "$scene" >"$folder/fog.scene"
said=$("$grotto" bake "$folder/fog.scene" 2>&1) || fail "fog: exit $?: $said"
case $said in *"a lattice of "*"nothing to bake"*) ;; *) fail "fog: $said" ;; esac
[ ! -e "$folder/fog.surfels" ] || fail "fog: baked"

# Where no costs are known, as the file says, and said; a GPU that was named must be there.
said=$(__EGL_VENDOR_LIBRARY_FILENAMES="$folder/no-vendor.json" "$grotto" bake "$scene" --out "$folder/none.surfels" 2>&1) ||
	fail "no OpenGL: exit $?: $said"
case $said in
*"as a node on "*) echo "# the drivers of OpenGL cannot be hidden here: not tried without" ;;
*"without OpenGL no costs are known: surfels are as the file says"*)
	[ -s "$folder/none.surfels" ] || fail "no OpenGL: nothing baked" ;;
*) fail "no OpenGL: $said" ;;
esac
said=$("$grotto" bake "$scene" --gpu 64 --out "$folder/gpu.surfels" 2>&1)
[ $? != 0 ] && [ ! -e "$folder/gpu.surfels" ] || fail "a GPU that is not there: $said"
exit $failed
