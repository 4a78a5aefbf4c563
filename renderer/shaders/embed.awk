# Turns the GLSL files named on the command line into one C file: a table of
# names and texts (renderer/gl/shaders.h), so that a node needs no data files.
# A shader is found by its base name, so two of one name are an error.

function base(path) {
	sub(/.*\//, "", path)
	return path
}

function finish() {
	if (open)
		print "\t},"
	open = 0
}

BEGIN {
	print "/* Made by renderer/shaders/embed.awk. */"
	print "#include \"renderer/gl/shaders.h\"\n"
	print "const struct shader_file shader_files[] = {"
}

FNR == 1 {
	finish()
	name = base(FILENAME)
	if (name in seen) {
		print "embed.awk: two shaders named " name > "/dev/stderr"
		failed = 1
		exit 1
	}
	seen[name] = 1
	print "\t{ \"" name "\","
	open = 1
}

{
	gsub(/\\/, "&&")
	gsub(/"/, "\\\"")
	print "\t  \"" $0 "\\n\""
}

END {
	if (failed)
		exit 1
	finish()
	print "\t{ 0, 0 },"
	print "};"
}
