#include "tracking/report.h"

#include <math.h>

const char *track_fault_name(enum track_fault fault)
{
	static const char *const name[TRACK_FAULTS] = {
		[TRACK_FAULT_NONE] = "none",	     [TRACK_FAULT_LENGTH] = "length",
		[TRACK_FAULT_CHECKSUM] = "checksum", [TRACK_FAULT_FORMAT] = "format",
		[TRACK_FAULT_POSE] = "pose",	     [TRACK_FAULT_ORDER] = "order",
		[TRACK_FAULT_SENSOR] = "sensor",
	};

	return (unsigned)fault < TRACK_FAULTS ? name[fault] : "unknown";
}

uint64_t track_unwrap(uint64_t raw, unsigned bits, uint64_t expected)
{
	const uint64_t span = bits < 64 ? UINT64_C(1) << bits : 0; /* 0: nothing wraps */
	uint64_t ahead;

	if (!span)
		return raw;
	ahead = (raw - expected) & (span - 1);
	if (ahead < span / 2 || expected + ahead < span)
		return expected + ahead;
	return expected + ahead - span;
}

float track_dead_zone(float value, float zone)
{
	const float beyond = fabsf(value) - zone;

	return beyond > 0 ? copysignf(beyond / (1 - zone), value) : 0;
}
