# Shared by the scripts beside it: set-up that says what it does and does
# nothing twice. Source it with the repository's root as the working directory.
# shellcheck shell=bash

jobs=$(nproc 2>/dev/null || echo 2)

say() { printf '==> %s\n' "$*"; }
die() { printf '%s: %s\n' "${0##*/}" "$*" >&2; exit 1; }

# logged FILE COMMAND...: the output goes to FILE; when the command fails its
# end is shown.
logged() {
	local log=$1 rc=0
	shift
	mkdir -p "$(dirname "$log")"
	"$@" >"$log" 2>&1 </dev/null || rc=$?
	if [ "$rc" != 0 ]; then
		echo "--- $* failed with status $rc; the end of $log:"
		tail -n 40 "$log"
	fi
	return "$rc"
}

as_root() {
	if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi
}

# need_packages LIST...: installs what the lists name and the machine lacks.
need_packages() {
	local wanted missing=() package
	mapfile -t wanted < <(cat "$@" | grep -v -e '^#' -e '^$')
	if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
		say "not a Debian machine: taking for granted ${wanted[*]}"
		return
	fi
	for package in "${wanted[@]}"; do
		dpkg-query -W -f='${db:Status-Abbrev}' "$package" 2>/dev/null | grep -q '^ii' ||
			missing+=("$package")
	done
	if [ ${#missing[@]} = 0 ]; then
		say "packages: all ${#wanted[@]} are there"
		return
	fi
	[ "$(id -u)" = 0 ] || command -v sudo >/dev/null ||
		die "missing packages, and no root or sudo to install them: ${missing[*]}"
	say "packages: installing ${missing[*]}"
	# The log stays out of sight: it names the machine's package mirrors.
	if ! { as_root apt-get -q update &&
		as_root env DEBIAN_FRONTEND=noninteractive \
			apt-get -q install -y --no-install-recommends "${missing[@]}"; } \
		>out/packages.log 2>&1 </dev/null; then
		die "apt-get could not install them; out/packages.log says why"
	fi
}

# bootstrap: makes ./configure when it is missing or older than what makes it.
bootstrap() {
	if [ -x configure ] && [ Makefile.in -nt Makefile.am ] && [ ! configure.ac -nt configure ]; then
		return
	fi
	say "autoreconf"
	logged out/autoreconf.log autoreconf -i
}

# configure_in FOLDER COMPILER FLAGS...: once; later runs leave it to make.
configure_in() {
	local folder=$1 cc=$2
	shift 2
	[ ! -f "$folder/config.status" ] || return 0
	if command -v ccache >/dev/null; then cc="ccache $cc"; fi
	say "configure in $folder/ ($cc $*)"
	mkdir -p "$folder"
	(cd "$folder" && logged configure.log ../configure -q CC="$cc" "$@")
}

# build FOLDER TARGETS...
build() {
	local folder=$1
	shift
	say "make $* in $folder/ ($jobs jobs, log in $folder/make.log)"
	logged "$folder/make.log" make -C "$folder" -j"$jobs" "$@"
}

# Folders for the logs of this; ignored by git.
mkdir -p out
