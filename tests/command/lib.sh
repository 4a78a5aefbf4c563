# Sourced by the tests of the command: where it is, how a fault is said, and a
# folder, $work, that is gone at the end.
set -u
: "${srcdir:=.}" "${builddir:=.}"
grotto=$builddir/tools/grotto
failed=0

fail() {
	echo "FAIL: $*"
	failed=1
}
skip() {
	echo "SKIP: $*"
	exit 77
}
[ -x "$grotto" ] || { echo "FAIL: $grotto is not built"; exit 1; }
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
