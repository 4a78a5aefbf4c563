#!/bin/sh
# check.sh AWK VALIDATOR FILES...: compiles every stage among the GLSL files
# offline, so that a broken shader stops make and not a node.
awk=$1
validator=$2
shift 2
here=`dirname "$0"`
work=`mktemp -d "${TMPDIR:-/tmp}/grotto-shaders.XXXXXX"` || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
failed=0
for file in "$@"; do
	name=`basename "$file"`
	case $name in
	*.vert|*.geom|*.frag|*.comp) ;;
	*) continue ;;
	esac
	if "$awk" -v root="$name" -f "$here/resolve.awk" "$@" >"$work/$name" 2>"$work/files" &&
	    "$validator" "$work/$name" >"$work/log" 2>&1; then
		:
	else
		failed=1
		echo "$file does not compile (numbers before the line are these files):" >&2
		cat "$work/files" >&2
		test ! -f "$work/log" || cat "$work/log" >&2
	fi
	rm -f "$work/log"
done
exit $failed
