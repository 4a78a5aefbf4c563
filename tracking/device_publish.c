/* What every report goes through on its way out of a device's thread. */
#include "tracking/device_private.h"

#include "base/result.h"

#include <math.h>

#define STALE_MOST 8	 /* reports late in a row: it is the clock that went back */
#define UNIT_SLACK 0.02f /* of a quaternion's length: 16-bit fixed point and some */

/* One thread writes: to load and to store is enough. */
void track_device_count(struct track_device *d, size_t counter, uint64_t more)
{
	_Atomic uint64_t *at = &d->counters[counter];

	atomic_store_explicit(at, atomic_load_explicit(at, memory_order_relaxed) + more,
			      memory_order_relaxed);
}

void track_device_fault(struct track_device *d, enum track_fault fault)
{
	track_device_count(d, TRACK_COUNTER(faults) + (size_t)fault, 1);
}

void track_device_missed(struct track_device *d, uint64_t reports)
{
	track_device_count(d, TRACK_COUNTER(missed), reports);
}

/* A unit quaternion up to what a device's number format costs; normalises it. */
static bool make_unit(versor q)
{
	float norm2 = 0;

	for (int i = 0; i < 4; i++)
		norm2 += q[i] * q[i];
	if (!(fabsf(sqrtf(norm2) - 1.0f) <= UNIT_SLACK)) /* NaN, too */
		return false;
	glm_quat_normalize(q);
	return true;
}

static enum track_fault check_values(struct track_report *r)
{
	if (r->sensor >= TRACK_SENSORS)
		return TRACK_FAULT_SENSOR;
	if (r->has & TRACK_LOST)
		r->has &= ~(unsigned)(TRACK_POSITION | TRACK_ORIENTATION);
	if (r->has & TRACK_POSITION)
		for (int i = 0; i < 3; i++)
			if (!(fabsf(r->T_base_sensor.p[i]) <= TRACK_PLACE_MAX_M))
				return TRACK_FAULT_POSE;
	if ((r->has & TRACK_ORIENTATION) && !make_unit(r->T_base_sensor.q))
		return TRACK_FAULT_POSE;
	if (r->has & TRACK_AXIS_VALUES) {
		if (r->axis_count > TRACK_AXES)
			return TRACK_FAULT_FORMAT;
		for (unsigned i = 0; i < r->axis_count; i++)
			if (!(fabsf(r->axes[i]) <= 1.0f))
				return TRACK_FAULT_FORMAT;
	}
	if ((r->has & TRACK_BATTERY) && !(r->battery >= 0 && r->battery <= 1))
		r->has &= ~(unsigned)TRACK_BATTERY;
	if ((r->has & TRACK_QUALITY) && !(r->quality >= 0 && r->quality <= 1))
		r->has &= ~(unsigned)TRACK_QUALITY;
	return TRACK_FAULT_NONE;
}

/* False: a duplicate or a straggler. */
static bool check_order(struct track_device *d, const struct track_report *r)
{
	const int64_t last = d->device_ns[r->sensor];

	if (!(d->seen >> r->sensor & 1) || r->device_ns > last ||
	    last - r->device_ns > TRACK_CLOCK_STEP_NS) {
		d->stale = 0;
		return true;
	}
	if (++d->stale < STALE_MOST)
		return false;
	/* Not stragglers: the clock was set back by less than a second. */
	d->stale = 0;
	d->seen = 0;
	track_clock_init(&d->times);
	track_device_count(d, TRACK_COUNTER(steps), 1);
	return true;
}

static void set_times(struct track_device *d, struct track_report *r)
{
	bool stepped;

	r->time_ns = r->arrived_ns;
	if (r->has & TRACK_DEVICE_TIME) {
		r->time_ns = track_clock_map(&d->times, r->device_ns, r->arrived_ns, &stepped);
		track_device_count(d, TRACK_COUNTER(steps), stepped);
		d->device_ns[r->sensor] = r->device_ns;
		d->seen |= UINT32_C(1) << r->sensor;
	}
	/* A line that was drawn lower must not make two reports change places. */
	if (r->time_ns <= d->time_ns[r->sensor])
		r->time_ns = d->time_ns[r->sensor] + GR_NS_PER_US;
	d->time_ns[r->sensor] = r->time_ns;
}

int track_device_publish(struct track_device *d, struct track_report *report)
{
	enum track_fault fault = check_values(report);

	if (fault == TRACK_FAULT_NONE && (report->has & TRACK_DEVICE_TIME) &&
	    !check_order(d, report))
		fault = TRACK_FAULT_ORDER;
	if (fault != TRACK_FAULT_NONE) {
		track_device_fault(d, fault);
		return -(int)fault;
	}
	report->arrived_ns = track_device_now(d);
	set_times(d, report);
	track_handover_put(&d->handover, report);
	track_device_count(d, TRACK_COUNTER(reports), 1);
	return GR_OK;
}
