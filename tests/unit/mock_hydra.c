#include "tests/unit/mock_hydra.h"

#include "tests/unit/hydra_bytes.h"

#include <errno.h>

#define FEATURE 91

/* As R. Pavlik's lsusb.txt has it: 52 bytes without a number. */
static const uint8_t reports_descriptor[] = {
	0x05, 0x01, 0x09, 0x00, 0xa1, 0x01, 0x09, 0x03, 0x15, 0x00, 0x26, 0xff, 0x00,
	0x35, 0x00, 0x46, 0xff, 0x00, 0x75, 0x08, 0x95, 0x34, 0x81, 0x02, 0xc0,
};
/* The real one is not known; hidapi looks at its first usage alone. */
static const uint8_t control_descriptor[] = {
	0x05, 0x01, 0x09, 0x05, 0xa1, 0x01, 0x15, 0x00, 0x26, 0xff, 0x00, 0x75, 0x08,
	0x95, 0x0c, 0x09, 0x30, 0x81, 0x02, 0x95, 0x5a, 0x09, 0x01, 0xb1, 0x02, 0xc0,
};

static int set_feature(void *ctx, const uint8_t *bytes, int len)
{
	struct mock_hydra *hydra = ctx;
	uint8_t sum = 0;

	if (len != FEATURE || bytes[0] != 0)
		return -EPIPE;
	for (int i = 1; i < 89; i++)
		sum ^= bytes[i];
	if (sum == bytes[89] && bytes[6] == 1 && bytes[8] == 4 &&
	    (bytes[9] == 3 || bytes[9] == 0)) {
		hydra->mode = bytes[9] == 3 ? MOCK_HYDRA_MOTION : MOCK_HYDRA_GAMEPAD;
		hydra->switches++;
	}
	return len;
}

static int get_feature(void *ctx, uint8_t *bytes, int room)
{
	(void)ctx;
	if (bytes[0] != 0)
		return -EPIPE;
	memset(bytes, 0, (size_t)room);
	for (int i = 0; MOCK_HYDRA_SERIAL[i] && 216 + i < room; i++)
		bytes[216 + i] = (uint8_t)MOCK_HYDRA_SERIAL[i];
	return room;
}

void mock_hydra_plug(struct mock_hydra *hydra, UMockdevTestbed *bed, int reports, int control)
{
	struct mock_hid_params params = {
		.number = control,
		.port = reports + 1,
		.interface = 1,
		.vendor = 0x1532,
		.product = 0x0300,
		.name = "Razer Hydra",
		.serial = "",
		.descriptor = control_descriptor,
		.descriptor_len = sizeof control_descriptor,
		.ops = { .get_feature = get_feature, .set_feature = set_feature, .ctx = hydra },
	};

	hydra->mode = MOCK_HYDRA_GAMEPAD;
	hydra->switches = 0;
	hydra->control = mock_hid_plug(bed, &params);
	params.number = reports;
	params.interface = 0;
	params.descriptor = reports_descriptor;
	params.descriptor_len = sizeof reports_descriptor;
	params.ops = (struct mock_hid_ops){ 0 };
	hydra->reports = mock_hid_plug(bed, &params);
	hydra->plugged = true;
}

void mock_hydra_unplug(struct mock_hydra *hydra)
{
	hydra->plugged = false;
	mock_hid_unplug(hydra->control, false);
	mock_hid_unplug(hydra->reports, true);
}

void mock_hydra_finish(struct mock_hydra *hydra)
{
	if (hydra->plugged)
		mock_hydra_unplug(hydra);
	mock_hid_free(&hydra->control);
	mock_hid_free(&hydra->reports);
}

enum mock_hydra_mode mock_hydra_mode(const struct mock_hydra *hydra)
{
	return (enum mock_hydra_mode)hydra->mode;
}

void mock_hydra_set_mode(struct mock_hydra *hydra, enum mock_hydra_mode mode)
{
	hydra->mode = mode;
}

void mock_hydra_say(struct mock_hydra *hydra, uint8_t sequence, int x_mm, int y_mm, int z_mm)
{
	uint8_t bytes[HYDRA_BYTES];

	hydra_make(bytes, sequence, x_mm, y_mm, z_mm);
	mock_hid_push(hydra->reports, bytes, sizeof bytes);
}
