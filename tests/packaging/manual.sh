#!/bin/sh
# The manual is right mdoc, and tells of every option that the programs take.
set -eu
export LC_ALL=C
command -v mandoc >/dev/null || { echo "skipped: no mandoc"; exit 77; }
failed=0
fail() { echo "FAIL: $*"; failed=1; }

for page in docs/man/*.[158]; do
	# Whether other pages are installed on this machine is not the question.
	said=$(mandoc -Tlint -Wwarning "$page" 2>&1 | grep -v 'referenced manual not found' || true)
	[ -z "$said" ] || fail "$said"
	if grep -n '@[a-z]*@' "$page"; then fail "$page has a word that was not replaced"; fi
done

# told_of PAGE HELP [SECTION]: the options of the help and of the page, or of
# its section, are the same.
told_of() {
	# The text above the options may name those of other programs.
	printf '%s\n' "$2" | grep -e '^  *-' | grep -o -e '--[a-z][a-z-]*' | sed 's/^--//' |
		grep -v -x -e help -e version | sort -u > "$tmp/known"
	awk -v section="${3-}" '/^\.S[sh] / { on = substr($0, 5) == section } section == "" || on' "$1" |
		grep -e '^\.It Fl' | grep -o -e 'Fl -[a-z-]*' | sed 's/Fl -//' |
		grep -v -x -e help -e version -e '' | sort -u > "$tmp/told"
	for option in $(comm -23 "$tmp/known" "$tmp/told"); do
		fail "$1 does not tell of ${3-} --$option"
	done
	for option in $(comm -13 "$tmp/known" "$tmp/told"); do
		fail "$1 tells of ${3-} --$option, which there is not"
	done
}
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
for daemon in master node; do
	[ ! -x daemon/grotto-$daemon ] ||
		told_of docs/man/grotto-$daemon.8 "$(daemon/grotto-$daemon --help)"
done
if [ -x tools/grotto ]; then
	for command in $(tools/grotto --help | sed -n 's/^  \([a-z]*\) .*/\1/p'); do
		grep -q "^\.Ss $command$" docs/man/grotto.1 || fail "grotto.1 does not tell of $command"
		told_of docs/man/grotto.1 "$(tools/grotto "$command" --help)" "$command"
	done
	told_of docs/man/grotto.1 "$(tools/grotto trackers calibrate --help)" "trackers calibrate"
fi

# The layout of the manual's example is one.
if [ -x tools/grotto ]; then
	sed -n '/^\.Bd/,/^\.Ed/p' docs/man/grotto-layout.5 | sed '1d;$d' > "$tmp/example.cave"
	tools/grotto check "$tmp/example.cave" || fail "the example of grotto-layout(5)"
fi
exit $failed
