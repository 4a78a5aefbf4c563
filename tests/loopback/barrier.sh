#!/bin/sh
# grotto bench barrier: in namespaces where that is allowed, else over loopback, nodes swap
# when told in one run and at a time in the next; what is wrong in its words is said.
. "${srcdir:-.}/tests/loopback/lib.sh"
"$grotto" bench barrier --runs 1 --frames 120 >"$work/said" 2>"$work/words" ||
	fail "it ended with $?: $(cat "$work/words")"
grep -q 'told .*; 120 frames, 0 with a time' "$work/said" || fail "not told: $(cat "$work/said")"
scheduled=$(sed -n 's/.*at a time.*; 120 frames, \([0-9]*\) with a time.*/\1/p' "$work/said")
[ "${scheduled:-0}" -ge 100 ] || fail "hardly a frame had a time: $(cat "$work/said")"
for wrong in "--nodes 1" "--frames x" "--runs" "--fast 1"; do
	# shellcheck disable=SC2086
	"$grotto" bench barrier $wrong >/dev/null 2>"$work/words"
	[ $? -eq 2 ] && grep -q -e '--nodes' "$work/words" || fail "$wrong: $(cat "$work/words")"
done
sed 's/^/# /' "$work/said"
[ $failed -eq 0 ] && echo "ok"
exit $failed
