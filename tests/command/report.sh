#!/bin/sh
# A daemon whose --report cannot be written does not start: exit status 2.
. "${srcdir:-.}/tests/command/lib.sh"
for daemon in master "node --node front"; do
	for report in "$work/none/report.json" "$work" /proc/report.json; do
		# shellcheck disable=SC2086
		said=$("$builddir"/daemon/grotto-$daemon --layout "$srcdir/layouts/cave4.cave" \
			--scene "$srcdir/scenes/box.scene" --report "$report" 2>&1 </dev/null)
		status=$?
		case $status:$said in
		2:*"$report: cannot be written"*) ;;
		*) fail "$daemon --report $report: exit $status: $said" ;;
		esac
	done
done
[ -z "$(ls "$work")" ] || fail "left behind: $(ls "$work")"
[ $failed -eq 0 ] && echo "ok"
exit $failed
