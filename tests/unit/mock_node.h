/*
 * Mocked devices under the unmodified libraries, by umockdev: its preload
 * library sends ioctl, read and write on a node to handlers of the test, but
 * not poll. So a node is a pty whose poll state the test controls.
 *
 * The program runs under umockdev-wrapper: mock_begin sees to that. The client
 * is a thread of the test or a child of it; a child must end before the test.
 */
#ifndef GROTTO_TESTS_UNIT_MOCK_NODE_H
#define GROTTO_TESTS_UNIT_MOCK_NODE_H

#include <stdbool.h>
#include <stdint.h>
#include <umockdev.h>

/*
 * First in main: runs the program again under the wrapper (does not return
 * then), and makes the test bed that all mocks are in. Exits 77 with a reason
 * where there is no wrapper.
 */
UMockdevTestbed *mock_begin(char **argv);

struct mock_node {
	int master, slave; /* -1: hung up */
	unsigned major, minor;
};

/* devnode: "/dev/hidraw3". False when there is no pty. */
bool mock_node_open(struct mock_node *node, UMockdevTestbed *bed, const char *devnode);
/* poll says POLLERR | POLLHUP from now on. */
void mock_node_hang_up(struct mock_node *node);
/* Of a device number that is used again: the bed itself would keep the old one. */
void mock_forget_number(UMockdevTestbed *bed, unsigned major, unsigned minor);
/* The device of umockdev's text; aborts with its message when it is wrong. */
void mock_add(UMockdevTestbed *bed, const char *text);
/* Tells udev, then takes it away; devpath without "/sys". */
void mock_remove(UMockdevTestbed *bed, const char *devpath);
/* Bytes as hexadecimal digits; g_free. */
char *mock_hex(const uint8_t *bytes, size_t len);

#endif
