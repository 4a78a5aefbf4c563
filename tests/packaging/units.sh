#!/bin/sh
# The units are what systemd takes without a word, name the installed daemons,
# and are hardened; the sysusers file makes the user. Prints the exposure
# scores that docs/operating.md states.
set -eu
export LC_ALL=C
srcdir=${srcdir:-.}
command -v systemd-analyze >/dev/null || { echo "skipped: no systemd-analyze"; exit 77; }

tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
failed=0
fail() { echo "FAIL: $*"; failed=1; }

# verify looks whether the executables exist: give it some that do.
mkdir "$tmp/sbin"
for daemon in grotto-master grotto-node; do
	printf '#!/bin/sh\n' > "$tmp/sbin/$daemon"
	chmod +x "$tmp/sbin/$daemon"
done
for unit in grotto-master.service grotto-node@.service; do
	daemon=${unit%%.service}; daemon=${daemon%@}
	grep -q "^ExecStart=/.*/$daemon --layout" "systemd/$unit" || fail "$unit does not start $daemon"
	if grep -n '@[a-z]*@' "systemd/$unit"; then fail "$unit has a word that was not replaced"; fi
	sed "s|^ExecStart=[^ ]*/|ExecStart=$tmp/sbin/|" "systemd/$unit" > "$tmp/$unit"
done
cp "$tmp/grotto-node@.service" "$tmp/grotto-node@front.service"

for unit in grotto-master.service grotto-node@front.service; do
	if said=$(systemd-analyze verify --man=no --recursive-errors=no "$tmp/$unit" 2>&1); then
		# Words about other units of this machine are not ours.
		said=$(printf '%s\n' "$said" | grep -F "$tmp" || true)
		[ -z "$said" ] || fail "verify: $said"
	else
		fail "systemd-analyze verify $unit: $said"
	fi
	# 0 is shut, 10 is open; the threshold is in tenths.
	if said=$(systemd-analyze security --offline=true --threshold=20 "$tmp/$unit" 2>&1); then
		printf '%s\n' "$said" | sed -n 's/.*Overall exposure level for //p'
	else
		fail "systemd-analyze security: $unit is more exposed than 2.0: $said"
	fi
done

if [ "$(id -u)" = 0 ] && command -v systemd-sysusers >/dev/null; then
	mkdir -p "$tmp/root/etc"
	systemd-sysusers --root="$tmp/root" "$(realpath "$srcdir")/systemd/sysusers.d/grotto.conf" 2>&1 ||
		fail "systemd-sysusers"
	grep -q '^grotto:.*:/:/usr/sbin/nologin$' "$tmp/root/etc/passwd" || fail "no user grotto"
	for group in grotto video render; do
		grep -q "^$group:" "$tmp/root/etc/group" || fail "no group $group"
	done
fi

exit $failed
