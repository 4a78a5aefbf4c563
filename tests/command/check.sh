#!/bin/sh
# grotto check: the shipped files are right, every faulty one is refused with
# exit status 2 and says what its "// expect:" lines say.
. "${srcdir:-.}/tests/command/lib.sh"

# The key that a layout for several machines names is not on this one: give it one.
"$grotto" key "$work/key" >/dev/null || fail "no key for the shipped layouts"
for file in "$srcdir"/layouts/*.cave; do
	copy=$work/$(basename "$file")
	sed 's,key_file = "[^"]*",key_file = "key",' "$file" >"$copy"
	said=$("$grotto" check "$copy" 2>&1) || fail "$file: exit $?: $said"
	case $said in *"warning:"*) fail "$file: $said" ;; esac
done
for file in "$srcdir"/scenes/*.scene "$srcdir"/tests/data/*.scene; do
	said=$("$grotto" check "$file" 2>&1) || fail "$file: exit $?: $said"
done

# A key that is not here is a warning with its place and what to do; a bad one is an error.
file=$srcdir/tests/data/key-missing.cave
said=$("$grotto" check "$file" 2>&1) || fail "an absent key: exit $?: $said"
for words in "warning: $file:21: network.key_file: /nowhere/cluster.key" "grotto key"; do
	case $said in *"$words"*) ;; *) fail "an absent key: '$words' is not in: $said" ;; esac
done
sed 's,/nowhere/cluster.key,key,' "$file" >"$work/keyed.cave"
said=$("$grotto" check "$work/keyed.cave" 2>&1) || fail "a key beside: exit $?: $said"
chmod 644 "$work/key"
said=$("$grotto" check "$work/keyed.cave" 2>&1)
[ $? -eq 2 ] || fail "a key that others may read: $said"
rm -f "$work/key" && echo "no key" >"$work/key" && chmod 600 "$work/key"
said=$("$grotto" check "$work/keyed.cave" 2>&1)
[ $? -eq 2 ] || fail "a key that is none: $said"

count=0
for file in "$srcdir"/tests/data/bad/*.cave "$srcdir"/tests/data/bad/*.scene \
	    "$srcdir"/tests/data/bad/*.conf; do
	said=$("$grotto" check "$file" 2>&1)
	status=$?
	[ $status -eq 2 ] || fail "$file: exit $status, not 2: $said"
	case $said in
	*"$file"*) ;;
	*) fail "$file: is not named in: $said" ;;
	esac
	sed -n 's,^// expect: ,,p' "$file" >"$work/expect"
	while IFS= read -r expected; do
		case $said in
		*"$expected"*) ;;
		*) fail "$file: '$expected' is not in: $said" ;;
		esac
	done <"$work/expect"
	count=$((count + 1))
done
[ $count -ge 19 ] || fail "only $count faulty files in $srcdir/tests/data/bad"

# All files are looked at, and one that is wrong decides.
"$grotto" check "$srcdir/layouts/cave4.cave" "$srcdir/tests/data/bad/empty.cave" >/dev/null 2>&1
[ $? -eq 2 ] || fail "a right and a wrong file together are not refused"
"$grotto" check /there/is/none.cave >/dev/null 2>&1
[ $? -eq 2 ] || fail "a file that is not there is not refused"
"$grotto" check >/dev/null 2>&1
[ $? -eq 2 ] || fail "no file is not refused"

# The command table.
"$grotto" --help | grep -q check || fail "--help does not list the commands"
"$grotto" --version | grep -q '^grotto [0-9]' || fail "--version"
"$grotto" chekc 2>&1 | grep -q "did you mean 'check'" || fail "no suggestion for chekc"
"$grotto" chekc >/dev/null 2>&1
[ $? -eq 2 ] || fail "an unknown command is not exit 2"
"$grotto" check --nonsense 2>&1 | grep -q "no option --nonsense" || fail "unknown option"

# A key is made once and never overwritten.
key=$work/made.key
"$grotto" key "$key" >/dev/null || fail "no key was made"
[ "$(stat -c %a "$key")" = 640 ] || fail "the key's mode is $(stat -c %a "$key")"
[ "$(wc -c <"$key")" -eq 65 ] || fail "the key has $(wc -c <"$key") bytes"
before=$(cat "$key")
"$grotto" key "$key" >/dev/null 2>&1 && fail "an existing key was not refused"
[ "$(cat "$key")" = "$before" ] || fail "an existing key was overwritten"

[ $failed -eq 0 ] && echo "ok: $count faulty files refused"
exit $failed
