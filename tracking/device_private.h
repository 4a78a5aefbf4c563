/* What device.c and device_publish.c share. */
#ifndef GROTTO_TRACKING_DEVICE_PRIVATE_H
#define GROTTO_TRACKING_DEVICE_PRIVATE_H

#include "tracking/device.h"

/* Which of the counters a member is. */
#define TRACK_COUNTER(member) (offsetof(struct track_counters, member) / sizeof(uint64_t))

/* The device's thread alone. */
void track_device_count(struct track_device *device, size_t counter, uint64_t more);

#endif
