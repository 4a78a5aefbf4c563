# Sourced by the loopback tests: what they need, and who can run them here.
. "${srcdir:-.}/tests/command/lib.sh"
picture=$builddir/tests/loopback/picture
command -v jq >/dev/null || skip "jq is not installed"

# No GL 4.5, no loopback cave: one small still says so.
need_gl() {
	said=$("$grotto" render "$srcdir/tests/data/loop.scene" --size 16x16 -o "$work/gl.png" 2>&1) &&
		return
	case $said in
	*"cannot"* | *"unsupported"* | *"not supported"*) skip "no OpenGL 4.5: $said" ;;
	*) echo "FAIL: the smallest still: $said"; exit 1 ;;
	esac
}

# check_summary FILE FRAMES NODES: all nodes applied and swapped all frames, none differed.
check_summary() {
	jq -e --argjson frames "$2" --argjson nodes "$3" '
		.ok and (.faults | length == 0) and (.nodes | length == $nodes) and
		.frames_complete == $frames and .skew_us.count >= 0 and
		.commit_to_last_swap_us.count == $frames and
		.commit_to_last_swap_us.p99 >= .commit_to_last_swap_us.p50 and
		(.nodes | all(.applied == $frames and .swapped == $frames and
			.mismatches == 0 and .gl_errors == 0 and .nonfinite == 0 and
			(.renderer | length > 0) and .wire.bytes_in > 0 and
			(.stages | length > 0)))' "$1" >/dev/null ||
		fail "$1: $(jq -c '{ok, faults, frames_complete, nodes: [.nodes[] | {name, applied, swapped, mismatches}]}' "$1" 2>&1)"
}
