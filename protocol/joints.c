#include "protocol/joints.h"

#include "base/cursor.h"
#include "base/result.h"

#include <math.h>
#include <string.h>

#define BITS 15
#define STEPS 16383 /* to either side of 0, which is one of them */
#define MASK 0x7fffu
#define SPARE (UINT64_C(1) << 47)

/* The three smaller components are within half a root of two. */
static const float largest_small = 0.70710678f;

static unsigned largest_of(const float q[4])
{
	unsigned largest = 0;

	for (unsigned i = 1; i < 4; i++)
		if (fabsf(q[i]) > fabsf(q[largest]))
			largest = i;
	return largest;
}

static bool is_joint(const struct fdp_joint *joint)
{
	double squared = 0;

	for (unsigned i = 0; i < 4; i++)
		squared += (double)joint->rotation[i] * (double)joint->rotation[i];
	/* NaN is nowhere. */
	if (!(fabs(sqrt(squared) - 1) <= 1e-3))
		return false;
	for (unsigned i = 0; joint->moved && i < 3; i++)
		if (!(fabsf(joint->position[i]) <= FDP_JOINT_REACH))
			return false;
	return true;
}

static uint64_t turn_bits(const float q[4])
{
	const unsigned largest = largest_of(q);
	double squared = 0, scale;
	uint64_t bits = (uint64_t)largest << 45;
	unsigned at = 0;

	for (unsigned i = 0; i < 4; i++)
		squared += (double)q[i] * (double)q[i];
	/* q and -q turn alike: the largest is told to be positive. */
	scale = (q[largest] < 0 ? -STEPS : STEPS) / (sqrt(squared) * (double)largest_small);
	for (unsigned i = 0; i < 4; i++) {
		long step;

		if (i == largest)
			continue;
		step = lrint((double)q[i] * scale);
		step = step > STEPS ? STEPS : step < -STEPS ? -STEPS : step;
		bits |= (uint64_t)(step + STEPS) << (BITS * at++);
	}
	return bits;
}

static bool turn_of_bits(uint64_t bits, float q[4])
{
	const unsigned largest = (unsigned)(bits >> 45 & 3);
	double rest = 1;
	unsigned at = 0;

	if (bits & SPARE)
		return false;
	for (unsigned i = 0; i < 4; i++) {
		unsigned step;

		if (i == largest)
			continue;
		step = (unsigned)(bits >> (BITS * at++)) & MASK;
		if (step > 2 * STEPS)
			return false;
		q[i] = (float)((int)step - STEPS) * (largest_small / STEPS);
		rest -= (double)q[i] * (double)q[i];
	}
	/* Three that leave the fourth less than it can be are of no quaternion. */
	if (rest < 0.25 - 1e-4)
		return false;
	q[largest] = (float)sqrt(rest);
	return true;
}

size_t fdp_joints_encode(const struct fdp_joint *joints, size_t count, uint8_t *bytes, size_t size)
{
	struct gr_writer w = gr_writer(bytes, size);
	uint8_t moved[FDP_JOINTS_MAX / 8 + 1] = { 0 };

	if (count > FDP_JOINTS_MAX)
		return 0;
	for (size_t i = 0; i < count; i++) {
		if (!is_joint(&joints[i]))
			return 0;
		if (joints[i].moved)
			moved[i / 8] = (uint8_t)(moved[i / 8] | 1u << i % 8);
	}
	gr_write_u8(&w, (uint8_t)count);
	for (size_t i = 0; i < (count + 7) / 8; i++)
		gr_write_u8(&w, moved[i]);
	for (size_t i = 0; i < count; i++) {
		const uint64_t bits = turn_bits(joints[i].rotation);

		gr_write_u32(&w, (uint32_t)bits);
		gr_write_u16(&w, (uint16_t)(bits >> 32));
	}
	for (size_t i = 0; i < count; i++)
		for (unsigned k = 0; joints[i].moved && k < 3; k++)
			gr_write_f32(&w, joints[i].position[k]);
	return w.ok ? w.len : 0;
}

static bool read_joints(struct gr_reader *r, const uint8_t *moved, struct fdp_joint *joints,
			size_t count)
{
	for (size_t i = 0; i < count; i++) {
		const uint64_t low = gr_read_u32(r), high = gr_read_u16(r);

		joints[i] = (struct fdp_joint){ .moved = moved[i / 8] >> i % 8 & 1 };
		if (!r->ok || !turn_of_bits(high << 32 | low, joints[i].rotation))
			return false;
	}
	for (size_t i = 0; i < count; i++) {
		for (unsigned k = 0; joints[i].moved && k < 3; k++)
			joints[i].position[k] = gr_read_f32(r);
		if (!r->ok || !is_joint(&joints[i]))
			return false;
	}
	return true;
}

int fdp_joints_decode(const uint8_t *bytes, size_t len, struct fdp_joint *joints, size_t most,
		      size_t *out_count)
{
	struct gr_reader r = gr_reader(bytes, len);
	const size_t count = gr_read_u8(&r);
	const uint8_t *moved = gr_read_bytes(&r, (count + 7) / 8);

	*out_count = 0;
	/* Bits past the last joint are of none. */
	if (!r.ok || count > most || (count % 8 && moved[count / 8] >> count % 8) ||
	    !read_joints(&r, moved, joints, count) || gr_reader_left(&r))
		return GR_ERR_FORMAT;
	*out_count = count;
	return GR_OK;
}
