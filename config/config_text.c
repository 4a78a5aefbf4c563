#include "config/config_text.h"

#include "base/result.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int read_all(int fd, char *text, size_t size, size_t *out_len)
{
	size_t len = 0;

	while (len < size) {
		ssize_t n = read(fd, text + len, size - len);

		if (n < 0 && errno == EINTR)
			continue;
		if (n < 0)
			return GR_ERR_IO;
		if (n == 0)
			break;
		len += (size_t)n;
	}
	*out_len = len;
	return GR_OK;
}

int config_text_load(const char *path, char **out_text, size_t *out_len, struct gr_diag *diag)
{
	struct stat status;
	size_t size = CONFIG_TEXT_MAX + 1, len;
	char *text = NULL;
	/* Not blocking: a FIFO of that name must not hang a daemon's start. */
	int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
	int result = GR_ERR_IO;

	if (fd < 0 || fstat(fd, &status) < 0) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL, "cannot be opened: %s",
			    strerror(errno));
		goto out;
	}
	if (!S_ISREG(status.st_mode)) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL, "is not a regular file");
		result = GR_ERR_CONFIG;
		goto out;
	}
	text = malloc(size);
	if (!text) {
		result = GR_ERR_NOMEM;
		goto out;
	}
	result = read_all(fd, text, size, &len);
	if (result < 0) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL, "cannot be read: %s",
			    strerror(errno));
		goto out;
	}
	if (len > CONFIG_TEXT_MAX) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL, "is longer than %u bytes",
			    CONFIG_TEXT_MAX);
		result = GR_ERR_CONFIG;
		goto out;
	}
	text[len] = '\0';
	*out_text = text;
	*out_len = len;
	text = NULL;
out:
	free(text);
	if (fd >= 0)
		close(fd);
	return result;
}

/* Line of the first @include that begins a line, where libconfig would obey it; 0 for none. */
static int include_line(const char *text)
{
	int line = 1;

	for (const char *at = text; at; line++) {
		at += strspn(at, " \t\r\f\v");
		if (!strncmp(at, "@include", strlen("@include")))
			return line;
		at = strchr(at, '\n');
		if (at)
			at++;
	}
	return 0;
}

/* What libconfig says is right but terse; the slips that people make get a hint. */
static const char *parse_hint(const char *error)
{
	if (strstr(error, "mismatched element type"))
		return "; libconfig wants one type in [ ]: write [0.0, 1.5, 0.0], or use ( )";
	if (strstr(error, "syntax error"))
		return "; the fault may be at the end of the line before: look for a missing ';', ',', "
		       "'\"' or bracket";
	if (strstr(error, "duplicate setting"))
		return "; give each key once";
	return "";
}

/* The key that a line sets, when it sets just one; else NULL. Caller frees. */
static char *line_key(const char *text, int line)
{
	size_t blanks, n, signs = 0;

	for (; line > 1 && text; line--) {
		text = strchr(text, '\n');
		text = text ? text + 1 : NULL;
	}
	if (!text || line < 1)
		return NULL;
	for (size_t i = 0; text[i] && text[i] != '\n'; i++)
		signs += text[i] == '=' || text[i] == ':';
	blanks = strspn(text, " \t\r{(");
	n = strspn(text + blanks, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-*");
	return signs == 1 && n > 0 ? strndup(text + blanks, n) : NULL;
}

/* What libconfig found wrong, and where. */
static void report_parse(const config_t *config, const char *text, const char *name,
			 struct gr_diag *diag)
{
	const char *error = config_error_text(config);
	int line = config_error_line(config);
	char *key = strstr(error, "duplicate setting") ? line_key(text, line) : NULL;

	gr_diag_add(diag, GR_DIAG_ERROR, name, line, key, "%s%s", error, parse_hint(error));
	free(key);
}

static int line_of(const char *text, const char *at)
{
	int line = 1;

	for (; text < at; text++)
		line += *text == '\n';
	return line;
}

static size_t count_keys(const char *text, size_t len)
{
	size_t count = 0;

	for (size_t i = 0; i < len; i++)
		count += text[i] == '=' || text[i] == ':';
	return count;
}

int config_text_parse(const char *text, size_t len, const char *name, config_t *out,
		      struct gr_diag *diag)
{
	char *copy;
	int line, result = GR_ERR_CONFIG;

	if (len > CONFIG_TEXT_MAX) {
		gr_diag_add(diag, GR_DIAG_ERROR, name, 0, NULL, "is longer than %u bytes",
			    CONFIG_TEXT_MAX);
		return GR_ERR_CONFIG;
	}
	if (memchr(text, '\0', len)) {
		gr_diag_add(diag, GR_DIAG_ERROR, name, line_of(text, memchr(text, '\0', len)), NULL,
			    "holds a NUL byte; this is not a text file");
		return GR_ERR_CONFIG;
	}
	if (count_keys(text, len) > CONFIG_TEXT_KEYS) {
		gr_diag_add(diag, GR_DIAG_ERROR, name, 0, NULL, "holds more than %d keys",
			    CONFIG_TEXT_KEYS);
		return GR_ERR_CONFIG;
	}
	copy = malloc(len + 1);
	if (!copy)
		return GR_ERR_NOMEM;
	memcpy(copy, text, len);
	copy[len] = '\0';
	config_init(out);
	/* Belt and braces: were an @include missed above, this leads nowhere. */
	config_set_include_dir(out, "/dev/null");
	line = include_line(copy);
	if (line) {
		gr_diag_add(diag, GR_DIAG_ERROR, name, line, "@include",
			    "not allowed; write everything into this one file");
	} else if (!config_read_string(out, copy)) {
		report_parse(out, copy, name, diag);
	} else {
		result = GR_OK;
	}
	if (result < 0)
		config_destroy(out);
	free(copy);
	return result;
}

char *config_text_beside(const char *beside, const char *file)
{
	const char *slash = strrchr(beside, '/');
	size_t folder = slash && file[0] != '/' ? (size_t)(slash - beside) + 1 : 0;
	char *path = malloc(folder + strlen(file) + 1);

	if (!path)
		return NULL;
	memcpy(path, beside, folder);
	strcpy(path + folder, file);
	return path;
}
