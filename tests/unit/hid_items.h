/* Report descriptors for tests, item by item. */
#ifndef GROTTO_TESTS_UNIT_HID_ITEMS_H
#define GROTTO_TESTS_UNIT_HID_ITEMS_H

#define PAGE(p) 0x05, (p)
#define USAGE(u) 0x09, (u)
#define USAGES(low, high) 0x19, (low), 0x29, (high)
#define RANGE(low, high) 0x15, (low) & 0xff, 0x25, (high) & 0xff
#define RANGE16(low, high) \
	0x16, (low) & 0xff, (low) >> 8 & 0xff, 0x26, (high) & 0xff, (high) >> 8 & 0xff
#define FIELD(bits, count) 0x75, (bits), 0x95, (count)
#define VARIABLE 0x81, 0x02
#define VARIABLE_NULL 0x81, 0x42
#define ARRAY 0x81, 0x00
#define CONSTANT 0x81, 0x03
#define RELATIVE 0x81, 0x06
#define REPORT(id) 0x85, (id)
#define PUSH 0xa4
#define POP 0xb4
#define APPLICATION(usage) PAGE(1), USAGE(usage), 0xa1, 0x01
#define PHYSICAL 0xa1, 0x00
#define END 0xc0
#define JOYSTICK 4
#define GAMEPAD 5
#define MULTI_AXIS 8

/* A joystick of one field as wide as said before. */
#define ONE_BUTTON APPLICATION(JOYSTICK), PAGE(9), USAGE(1), VARIABLE, END

/* Of a DualShock 4 by USB, without its feature reports. */
#define DUALSHOCK4_DESCRIPTOR                                                                       \
	APPLICATION(GAMEPAD), REPORT(1), USAGE(0x30), USAGE(0x31), USAGE(0x32), USAGE(0x35),        \
		0x15, 0x00, 0x26, 0xff, 0x00, FIELD(8, 4), VARIABLE, USAGE(0x39), RANGE(0, 7), 0x35, \
		0x00, 0x46, 0x3b, 0x01, 0x65, 0x14, FIELD(4, 1), VARIABLE_NULL, 0x65, 0x00, PAGE(9), \
		USAGES(1, 14), RANGE(0, 1), FIELD(1, 14), VARIABLE, 0x06, 0x00, 0xff, USAGE(0x20),  \
		FIELD(6, 1), RANGE(0, 127), VARIABLE, PAGE(1), USAGE(0x33), USAGE(0x34), 0x15, 0x00, \
		0x26, 0xff, 0x00, FIELD(8, 2), VARIABLE, 0x06, 0x00, 0xff, USAGE(0x21),             \
		FIELD(8, 54), VARIABLE, REPORT(5), USAGE(0x22), FIELD(8, 31), 0x91, 0x02, END

#endif
