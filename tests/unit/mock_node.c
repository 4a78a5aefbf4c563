#include "tests/unit/mock_node.h"

#include <fcntl.h>
#include <pty.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <termios.h>
#include <unistd.h>

#define WORDS 64 /* of a command line */

UMockdevTestbed *mock_begin(char **argv)
{
	const char *preload = getenv("LD_PRELOAD"), *asan = getenv("ASAN_OPTIONS");
	char options[1024], *words[WORDS] = { 0 };
	int count = 0;

	if (preload && strstr(preload, "umockdev"))
		return umockdev_testbed_new();
	/* The wrapper's library comes before the sanitizer's, which would mind. */
	snprintf(options, sizeof options, "%s%sverify_asan_link_order=0", asan ? asan : "",
		 asan ? ":" : "");
	setenv("ASAN_OPTIONS", options, 1);
	/* The path of a socket below it must fit into a socket's address. */
	setenv("TMPDIR", "/tmp", 1);
	for (words[count++] = (char *)"umockdev-wrapper"; *argv && count < WORDS - 1; argv++)
		words[count++] = *argv;
	execvp(words[0], words);
	printf("skipped: no umockdev-wrapper\n");
	exit(77);
}

bool mock_node_open(struct mock_node *node, UMockdevTestbed *bed, const char *devnode)
{
	g_autofree char *root = umockdev_testbed_get_root_dir(bed);
	g_autofree char *path = g_strconcat(root, devnode, NULL);
	g_autofree char *folder = g_path_get_dirname(path);
	struct termios raw = { .c_cflag = CS8 | CREAD };
	struct stat st;
	char pts[64];

	raw.c_cc[VMIN] = 1;
	if (openpty(&node->master, &node->slave, pts, &raw, NULL) < 0 ||
	    fstat(node->slave, &st) < 0)
		return false;
	node->major = major(st.st_rdev);
	node->minor = minor(st.st_rdev);
	fcntl(node->slave, F_SETFL, O_NONBLOCK);
	/* Or a child would keep the device alive. */
	fcntl(node->master, F_SETFD, FD_CLOEXEC);
	fcntl(node->slave, F_SETFD, FD_CLOEXEC);
	g_mkdir_with_parents(folder, 0755);
	unlink(path);
	return symlink(pts, path) == 0;
}

void mock_node_hang_up(struct mock_node *node)
{
	close(node->master);
	close(node->slave);
	node->master = node->slave = -1;
}

void mock_forget_number(UMockdevTestbed *bed, unsigned major, unsigned minor)
{
	g_autofree char *root = umockdev_testbed_get_root_dir(bed);
	g_autofree char *path = g_strdup_printf("%s/sys/dev/char/%u:%u", root, major, minor);

	unlink(path);
}

void mock_add(UMockdevTestbed *bed, const char *text)
{
	GError *error = NULL;

	if (umockdev_testbed_add_from_string(bed, text, &error))
		return;
	fprintf(stderr, "umockdev: %s\n", error->message);
	abort();
}

void mock_remove(UMockdevTestbed *bed, const char *devpath)
{
	g_autofree char *path = g_strconcat("/sys", devpath, NULL);

	umockdev_testbed_uevent(bed, path, "remove");
	umockdev_testbed_remove_device(bed, path);
}

char *mock_hex(const uint8_t *bytes, size_t len)
{
	char *text = g_malloc(2 * len + 1);

	text[0] = '\0';
	for (size_t i = 0; i < len; i++)
		snprintf(text + 2 * i, 3, "%02X", bytes[i]);
	return text;
}
