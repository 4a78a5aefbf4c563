# Counts what passed. Source it; count_one and count_logs add, count_end prints
# the sum as the last line and returns not 0 when anything failed.
# shellcheck shell=bash

passed=0 failed=0 skipped=0

# count_one NAME passed|failed|skipped
count_one() {
	case $2 in
	passed) passed=$((passed + 1)) ;;
	failed) failed=$((failed + 1)); echo "FAILED: $1" ;;
	skipped) skipped=$((skipped + 1)); echo "skipped: $1" ;;
	esac
}

# What one test program said: "passed failed skipped" and, below, the names of
# those that did not pass. A program of cmocka counts each of its tests; one
# that began and has no outcome (it crashed) failed. Any other counts as one.
# A program that failed though its tests passed (a leak, say) is one failure.
count_log() {
	local log=$1 result
	result=$(sed -n 's/^:test-result: //p' "${log%.log}.trs")
	awk -v result="${result:-ERROR}" -v program="${log%.log}" '
	function end_pending() { if (pending != "") bad(pending) }
	function bad(name) { failed++; names = names "\nfailed " program ": " name; pending = "" }
	/^\[ RUN      \] / { end_pending(); pending = $4; runs++; next }
	/^\[       OK \] / && $4 == pending { passed++; pending = ""; next }
	/^\[  FAILED  \] / && $4 == pending { bad($4); next }
	/^\[  SKIPPED \] / && $4 == pending {
		skipped++; names = names "\nskipped " program ": " $4; pending = ""; next
	}
	END {
		end_pending()
		if (result == "SKIP" && passed + failed == 0) {
			skipped = 1; names = "\nskipped " program
		} else if (result == "PASS" || result == "XFAIL") {
			if (runs == 0) passed = 1
		} else if (failed == 0) {
			bad("the program, with result " result)
		}
		printf "%d %d %d%s\n", passed, failed, skipped, names
	}' "$log"
}

# count_logs FOLDER: all tests that ran there. Not 0 when there are none.
count_logs() {
	local log line a b c any=no before=$failed
	while IFS= read -r log; do
		any=yes
		line=$(count_log "$log")
		read -r a b c <<<"${line%%$'\n'*}"
		passed=$((passed + a)) failed=$((failed + b)) skipped=$((skipped + c))
		case $line in *$'\n'*) printf '%s\n' "${line#*$'\n'}" ;; esac
		if [ "$b" != 0 ]; then
			echo "--- the end of $log:"
			tail -n 30 "$log"
		fi
	done < <(find "$1" -name '*.trs' | sort | sed 's/\.trs$/.log/')
	[ "$any" = yes ] && [ "$failed" -ge "$before" ]
}

count_end() {
	printf '%d passed, %d failed, %d skipped\n' "$passed" "$failed" "$skipped"
	[ "$failed" = 0 ]
}
