#!/bin/sh
# grotto bake: with gi.method = "auto" what a node takes, so that it need not bake.
. "${srcdir:-.}/tests/command/lib.sh"
# nothing of this user's counts, and nothing is left there
XDG_CACHE_HOME=$work/cache
export XDG_CACHE_HOME
unset CACHE_DIRECTORY
cp "$srcdir/scenes/box.scene" "$srcdir/scenes/box.gltf" "$work" || exit 1
scene=$work/box.scene

said=$("$grotto" bake "$scene" 2>&1) || fail "bake: exit $?: $said"
echo "$said"
case $said in *"without OpenGL"*) skip "no OpenGL here" ;; esac
for words in "as a node on " "costs measured now" "box.surfels: written"; do
	case $said in *"$words"*) ;; *) fail "bake: '$words' is not in: $said" ;; esac
done
apart=$(echo "$said" | sed -n 's/.*surfels \([0-9.]* m apart, [0-9]* links\), .*/\1/p' | head -n 1)
[ -n "$apart" ] || fail "bake: does not say spacing and links"
case $said in *"${apart%%,*}, ${apart#*, } and "*) ;; *) fail "bake: not baked as chosen, $apart: $said" ;; esac

# What it wrote is what a node on this machine reads: it stays as it is, and no other is made.
before=$(cksum <"$work/box.surfels")
said=$("$grotto" render "$scene" --size 16x16 -o "$work/box.png" 2>&1) || fail "render: exit $?: $said"
case $said in *"$apart"*) ;; *) fail "render: chooses otherwise than bake, $apart: $said" ;; esac
case $said in *"it is not used"*) fail "render: bakes again: $said" ;; esac
[ "$(cksum <"$work/box.surfels")" = "$before" ] || fail "render: wrote its own surfels: $said"
[ -z "$(find "$work/cache" -name '*.surfels')" ] || fail "render: baked into the cache: $said"
said=$("$grotto" bake "$scene" 2>&1) || fail "bake again: exit $?: $said"
for words in "costs kept from before" "box.surfels: is up to date"; do
	case $said in *"$words"*) ;; *) fail "bake again: '$words' is not in: $said" ;; esac
done

# Baked with other settings it is replaced, which is seen by the same two signs.
sed 's/^name = .*/&\ngi = { method = "surfels"; surfels = { spacing_m = 0.6; links = 64; }; };/' "$scene" \
	>"$work/named.scene"
said=$("$grotto" bake "$work/named.scene" --out "$work/box.surfels" 2>&1) || fail "as named: exit $?: $said"
case $said in *"as a node"*) fail "as named: it planned: $said" ;; esac
case $said in *" surfels 0.6 m apart, 64 links"*) ;; *) fail "as named: $said" ;; esac
other=$(cksum <"$work/box.surfels")
"$grotto" render "$scene" --size 16x16 -o "$work/box.png" >"$work/other.log" 2>&1 || fail "render: $(cat "$work/other.log")"
grep -q "box.surfels: .*it is not used" "$work/other.log" || fail "other settings: $(cat "$work/other.log")"
[ "$(cksum <"$work/box.surfels")" != "$other" ] || fail "other settings: not replaced: $(cat "$work/other.log")"

# A plan without surfels needs nothing.
sed 's/^name = .*/&\nmedium = { scattering_per_m = 5.0; };/' "$scene" >"$work/fog.scene"
said=$("$grotto" bake "$work/fog.scene" 2>&1) || fail "fog: exit $?: $said"
case $said in *"a lattice of "*"nothing to bake"*) ;; *) fail "fog: $said" ;; esac
[ ! -e "$work/fog.surfels" ] || fail "fog: baked"

# Where no costs are known, as the file says, and said; a GPU that was named must be there.
said=$(__EGL_VENDOR_LIBRARY_FILENAMES="$work/no-vendor.json" "$grotto" bake "$scene" --out "$work/none.surfels" 2>&1) ||
	fail "no OpenGL: exit $?: $said"
case $said in
*"as a node on "*) echo "# the drivers of OpenGL cannot be hidden here: not tried without" ;;
*"without OpenGL no costs are known: surfels are as the file says"*)
	[ -s "$work/none.surfels" ] || fail "no OpenGL: nothing baked" ;;
*) fail "no OpenGL: $said" ;;
esac
said=$("$grotto" bake "$scene" --gpu 64 --out "$work/gpu.surfels" 2>&1)
[ $? != 0 ] && [ ! -e "$work/gpu.surfels" ] || fail "a GPU that is not there: $said"

# What is no file of surfels is not replaced by one.
before=$(cksum <"$work/named.scene")
said=$("$grotto" bake "$work/named.scene" --out "$work/named.scene" 2>&1)
[ $? = 2 ] || fail "over the scene: $said"
[ "$(cksum <"$work/named.scene")" = "$before" ] || fail "over the scene: it is gone"
exit $failed
