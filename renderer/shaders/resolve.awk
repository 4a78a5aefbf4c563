# Prints one shader as program.c would hand it to the driver: #include lines
# replaced (each file once), and what the file's own "// check:" lines define put
# after #version. For glslangValidator during make; file names come back in its
# messages through #line and the -v files table on stderr when it fails.
#
#   awk -v root=NAME -f resolve.awk FILES...

function base(path) {
	sub(/.*\//, "", path)
	return path
}

function add(name, from,    i, count, lines, line, number, target, word) {
	if (!(name in text)) {
		print "resolve.awk: " from ": includes " name ", which is not in SHADERS" > "/dev/stderr"
		failed = 1
		return
	}
	if (name in done)
		return
	done[name] = number = files++
	print "// file " number " " name > "/dev/stderr"
	if (number > 0)
		print "#line 1 " number
	count = split(text[name], lines, "\n") - 1
	for (i = 1; i <= count; i++) {
		line = lines[i]
		if (line ~ /^[ \t]*#[ \t]*include[ \t]/) {
			target = line
			sub(/^[ \t]*#[ \t]*include[ \t]+/, "", target)
			sub(/[ \t]+$/, "", target)
			if (target !~ /^"/ && target in macro)
				target = macro[target]
			gsub(/"/, "", target)
			add(target, name ":" i)
			print "#line " (i + 1) " " number
		} else {
			print line
			if (number == 0 && line ~ /^[ \t]*#[ \t]*version/) {
				printf "%s", defines
				print "#line " (i + 1) " 0"
			}
		}
	}
}

FNR == 1 { file = base(FILENAME) }

{ text[file] = text[file] $0 "\n" }

file == root && /^\/\/ check: / {
	line = $0
	sub(/^\/\/ check: /, "", line)
	defines = defines line "\n"
	split(line, word, /[ \t]+/)
	if (word[1] == "#define")
		macro[word[2]] = word[3]
}

END {
	add(root, "command line")
	exit failed
}
