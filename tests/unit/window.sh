#!/bin/sh
# Runs test_target in a virtual X server, so that windows are tested everywhere.
program=${GROTTO_BUILD:-.}/tests/unit/test_target
if ! command -v xvfb-run >/dev/null 2>&1; then
	echo "skipped: xvfb-run is not installed"
	exit 77
fi
# A server that starts anew after its last client turns the next one away meanwhile.
exec xvfb-run -a -s "-noreset -screen 0 640x480x24" "$program"
