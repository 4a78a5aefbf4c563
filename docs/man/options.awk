# The option tables of docs/layout.md and docs/scene.md, as mdoc. Those tables
# come from the program itself ("make docs-options"), so the manual does too.
# usage: awk -f options.awk -v tables=layout.md grotto-layout.5.in
function plain(text) {
	gsub(/`|\*\*/, "", text)
	gsub(/\\/, "\\e", text)
	gsub(/^ +| +$/, "", text)
	if (text ~ /^[.']/) text = "\\&" text
	return text
}
function end_list() { if (listed) print ".El"; listed = 0 }
function tables_now(line, cell, facts) {
	while ((getline line < tables) > 0) {
		if (line ~ /^<!-- end of options/) inside = 0
		if (inside && line ~ /^### /) {
			end_list()
			print ".Ss " plain(substr(line, 5))
			print ".Bl -tag -width Ds"
			listed = 1
		} else if (inside && line ~ /^\| `/) {
			split(line, cell, /[|]/)
			print ".It Ic " plain(cell[2])
			print plain(cell[6]) "."
			facts = plain(cell[3])
			if (plain(cell[4]) != "") facts = facts (facts == "one of" ? " " : ", ") plain(cell[4])
			if (plain(cell[5]) == "required") facts = facts "; required"
			else if (plain(cell[5]) != "") facts = facts "; default " plain(cell[5])
			print ".Pq " facts
		}
		if (line ~ /^<!-- options/) inside = 1
	}
	end_list()
}
/^@options@$/ { tables_now(); next }
{ print }
