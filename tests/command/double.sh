#!/bin/sh
# A test double of grotto-master and grotto-node, by the name it is called by.
# DOUBLE_FRAMES frames; DOUBLE_FAULT is "NAME:HOW" (NAME "master" or a node).
me=master
report= pictures=
while [ $# -gt 0 ]; do
	case $1 in
	--node) me=$2; shift ;;
	--report) report=$2; shift ;;
	--pictures) pictures=$2; shift ;;
	esac
	shift
done
applied=$DOUBLE_FRAMES swapped=$DOUBLE_FRAMES mismatches=0 hash=00000000000000aa
how=
case $DOUBLE_FAULT in
"$me":*) how=${DOUBLE_FAULT#*:} ;;
esac
echo "double of $me: ${how:-well}"
case $how in
die) exit 3 ;;
crash) kill -ABRT $$ ;;
hang) exec sleep 600 ;;
miss) swapped=$((swapped - 1)) ;;
differ) mismatches=2 ;;
state) hash=00000000000000bb ;;
garbage) echo '{"applied":' >"$report"; exit 0 ;;
silent) exit 0 ;;
esac
if [ "$me" = master ]; then
	cat >"$report" <<EOF
{"ok":true,"frame":$DOUBLE_FRAMES,"frames_complete":$DOUBLE_FRAMES,"state_hash":"$hash","skew_us":{"count":1,"p50":5,"p99":9,"max":9},
"commit_to_last_swap_us":{"count":1,"p50":50,"p99":90,"max":90},"nodes":[],"wire":{"bytes_out":1}}
EOF
else
	[ "$how" = blind ] || cp "$DOUBLE_PICTURE" "$pictures/$me-$(printf %06d "$DOUBLE_FRAMES").png"
	cat >"$report" <<EOF
{"node":"$me","applied":$applied,"swapped":$swapped,"mismatches":$mismatches,"state_hash":"$hash",
"renderer":"double","light_hash":"0","stages":[{"name":"gbuffer","count":3,"mean_ms":1.5}],"wire":{"bytes_in":10}}
EOF
fi
