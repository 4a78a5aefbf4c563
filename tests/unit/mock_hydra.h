/* A Hydra with both its nodes: begins as a gamepad, says reports once it is switched. */
#ifndef GROTTO_TESTS_UNIT_MOCK_HYDRA_H
#define GROTTO_TESTS_UNIT_MOCK_HYDRA_H

#include "tests/unit/mock_hid.h"

#define MOCK_HYDRA_SERIAL "TEST0123456789ABC"

enum mock_hydra_mode { MOCK_HYDRA_GAMEPAD, MOCK_HYDRA_MOTION };

struct mock_hydra {
	struct mock_hid *reports, *control;
	_Atomic int mode;
	_Atomic unsigned switches; /* feature reports that it understood */
	bool plugged;
};

/* Zero-initialised, or finished. The numbers are those of its hidraw nodes, interface 0 and 1. */
void mock_hydra_plug(struct mock_hydra *hydra, UMockdevTestbed *bed, int reports, int control);
void mock_hydra_unplug(struct mock_hydra *hydra);
/* Unplugs it where it is not yet; no client may have it open. */
void mock_hydra_finish(struct mock_hydra *hydra);
enum mock_hydra_mode mock_hydra_mode(const struct mock_hydra *hydra);
void mock_hydra_set_mode(struct mock_hydra *hydra, enum mock_hydra_mode mode);
/* A report as by hydra_make, whatever the mode. */
void mock_hydra_say(struct mock_hydra *hydra, uint8_t sequence, int x_mm, int y_mm, int z_mm);

#endif
