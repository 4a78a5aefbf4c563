#include "renderer/gl/shader_text.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/gl/program.h"
#include "renderer/gl/shaders.h"

#include <ctype.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NAME_SIZE 128

const char *shader_source(const char *name)
{
	const struct shader_file *file;

	for (file = shader_files; file->name; file++) {
		if (strcmp(file->name, name) == 0)
			return file->text;
	}
	return NULL;
}

static int append(struct shader_text *t, const char *bytes, size_t len)
{
	if (t->size - t->len <= len) {
		size_t size = (t->len + len + 1) * 2;
		char *text = realloc(t->text, size);

		if (!text)
			return GR_ERR_NOMEM;
		t->text = text;
		t->size = size;
	}
	memcpy(t->text + t->len, bytes, len);
	t->len += len;
	t->text[t->len] = '\0';
	return GR_OK;
}

static int append_line_number(struct shader_text *t, int line, int file)
{
	char directive[64];
	int len = snprintf(directive, sizeof directive, "#line %d %d\n", line, file);

	return append(t, directive, (size_t)len);
}

/* Past "#word" and blanks when the line starts with it, else NULL. */
static const char *directive(const char *line, const char *word)
{
	size_t len = strlen(word);

	while (*line == ' ' || *line == '\t')
		line++;
	if (*line++ != '#')
		return NULL;
	while (*line == ' ' || *line == '\t')
		line++;
	if (strncmp(line, word, len) != 0 || (line[len] != ' ' && line[len] != '\t'))
		return NULL;
	line += len;
	while (*line == ' ' || *line == '\t')
		line++;
	return line;
}

static bool copy_name(char name[NAME_SIZE], const char *from, size_t len)
{
	if (len == 0 || len >= NAME_SIZE)
		return false;
	memcpy(name, from, len);
	name[len] = '\0';
	return true;
}

static bool quoted_name(const char *at, char name[NAME_SIZE])
{
	if (*at != '"')
		return false;
	at++;
	return copy_name(name, at, strcspn(at, "\"\n"));
}

/* The file that `#include` names, directly or through a word in defines. */
static bool include_name(const char *at, const char *defines, char name[NAME_SIZE])
{
	size_t word = strcspn(at, " \t\r\n");
	const char *line = defines;

	if (*at == '"')
		return quoted_name(at, name);
	while (line && word) {
		const char *given = directive(line, "define");

		if (given && strncmp(given, at, word) == 0 &&
		    (given[word] == ' ' || given[word] == '\t'))
			return quoted_name(given + word + strspn(given + word, " \t"), name);
		line = strchr(line, '\n');
		if (line)
			line++;
	}
	return false;
}

static int file_number(const struct shader_text *t, const char *name)
{
	for (int i = 0; i < t->files; i++) {
		if (strcmp(t->names[i], name) == 0)
			return i;
	}
	return -1;
}

static const char *own_name(const char *name)
{
	const struct shader_file *file;

	for (file = shader_files; file->name; file++) {
		if (strcmp(file->name, name) == 0)
			return file->name;
	}
	return NULL;
}

/* Recursion ends: every file is added once, and there are at most SHADER_TEXT_FILES. */
static int add_file(struct shader_text *t, const char *wanted, const char *defines)
{
	const char *name = own_name(wanted);
	const char *line = shader_source(wanted);
	int number = t->files;
	int at = 1;
	int result = GR_OK;

	if (!name) {
		gr_error("shader %s: no such file among the embedded ones", wanted);
		return GR_ERR_FORMAT;
	}
	if (number == SHADER_TEXT_FILES) {
		gr_error("shader %s: more than %d files included", wanted, SHADER_TEXT_FILES);
		return GR_ERR_FORMAT;
	}
	t->names[t->files++] = name;
	if (number > 0)
		result = append_line_number(t, 1, number);
	for (; *line && result == GR_OK; at++) {
		size_t len = strcspn(line, "\n");
		const char *included = directive(line, "include");
		char target[NAME_SIZE];

		if (line[len] == '\n')
			len++;
		if (included) {
			if (!include_name(included, defines, target)) {
				gr_error("%s:%d: #include wants \"file.glsl\" or a word that the "
					 "program defines as one", name, at);
				return GR_ERR_FORMAT;
			}
			if (file_number(t, target) < 0)
				result = add_file(t, target, defines);
			if (result == GR_OK)
				result = append_line_number(t, at + 1, number);
		} else {
			result = append(t, line, len);
			if (result == GR_OK && number == 0 && directive(line, "version")) {
				if (defines)
					result = append(t, defines, strlen(defines));
				if (result == GR_OK)
					result = append_line_number(t, at + 1, 0);
			}
		}
		line += len;
	}
	return result;
}

int shader_text_init(struct shader_text *out, const char *root, const char *defines)
{
	int result;

	memset(out, 0, sizeof *out);
	result = add_file(out, root, defines);
	if (result != GR_OK)
		shader_text_finish(out);
	return result;
}

void shader_text_finish(struct shader_text *text)
{
	free(text->text);
	memset(text, 0, sizeof *text);
}

/* Length of a leading "ERROR: " or "WARNING: ", as some drivers put it. */
static size_t severity_length(const char *line)
{
	static const char *const words[] = { "ERROR: ", "WARNING: " };

	for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
		if (strncmp(line, words[i], strlen(words[i])) == 0)
			return strlen(words[i]);
	}
	return 0;
}

char *shader_text_name_log(const struct shader_text *text, const char *log)
{
	char *out = NULL;
	size_t size;
	FILE *stream = open_memstream(&out, &size);

	if (!stream)
		return NULL;
	while (*log) {
		size_t len = strcspn(log, "\n");
		size_t start = severity_length(log);
		char *end;
		unsigned long number = 0;

		fwrite(log, 1, start, stream);
		if (isdigit((unsigned char)log[start]))
			number = strtoul(log + start, &end, 10);
		else
			end = NULL;
		if (end && (*end == ':' || *end == '(') && number < (unsigned long)text->files) {
			fputs(text->names[number], stream);
			start = (size_t)(end - log);
		}
		fwrite(log + start, 1, len - start, stream);
		log += len;
		if (*log == '\n') {
			fputc('\n', stream);
			log++;
		}
	}
	if (fclose(stream) != 0) {
		free(out);
		return NULL;
	}
	return out;
}
