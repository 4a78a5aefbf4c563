/*
 * Small files of /proc, /sys and /etc below a root, "" for the machine's own:
 * tests put others there. They are taken for what anybody may have written.
 */
#ifndef GROTTO_TOOLS_DOCTOR_SYSFILE_H
#define GROTTO_TOOLS_DOCTOR_SYSFILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SYSFILE_PATH 512
/* /proc/net/udp of a machine with a thousand sockets */
#define SYSFILE_MOST (256 * 1024)

/*
 * At most size - 1 bytes, NUL-terminated; bytes after a NUL of the file are left
 * out. GR_OK; GR_ERR_IO (errno), GR_ERR_RANGE where the file holds more, or the path is
 * too long; text is "" then.
 */
int sysfile_read(const char *root, char *text, size_t size, const char *format, ...)
	__attribute__((format(printf, 4, 5)));
/* The first word of the file, cut to size; false where there is none. */
bool sysfile_word(const char *root, char *text, size_t size, const char *format, ...)
	__attribute__((format(printf, 4, 5)));
/* One whole number and nothing else but blanks; false otherwise, and *out 0. */
bool sysfile_number(const char *root, int64_t *out, const char *format, ...)
	__attribute__((format(printf, 3, 4)));
/* The last part of where a link leads; false where there is none. */
bool sysfile_link(const char *root, char *name, size_t size, const char *format, ...)
	__attribute__((format(printf, 4, 5)));
bool sysfile_exists(const char *root, const char *format, ...)
	__attribute__((format(printf, 2, 3)));

#endif
