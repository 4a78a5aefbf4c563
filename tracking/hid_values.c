/* Input reports by what the descriptor said of them. Pure. */
#include "tracking/hid_descriptor.h"

#include <string.h>

void track_hid_rest(struct track_hid_values *values)
{
	memset(values, 0, sizeof *values);
}

/* The field's value; its bits are inside of the report, which the caller saw to. */
static int64_t read_field(const struct track_hid_field *field, const uint8_t *bytes)
{
	const unsigned shift = field->bit % 8, count = (shift + field->bits + 7) / 8; /* 1..5 */
	const uint64_t mask = (UINT64_C(1) << field->bits) - 1;
	uint64_t raw = 0;

	for (unsigned i = 0; i < count; i++)
		raw |= (uint64_t)bytes[field->bit / 8 + i] << 8 * i;
	raw = raw >> shift & mask;
	if (field->min < 0 && raw >> (field->bits - 1u))
		return (int64_t)raw - (int64_t)mask - 1;
	return (int64_t)raw;
}

/*
 * -1 .. 1 with the middle at 0: of 0 .. 255 that is 128, at which sticks rest,
 * so each half has a scale of its own. From 0 to 1 where from_zero.
 */
static float axis_of(const struct track_hid_field *field, int64_t value, bool from_zero)
{
	const int64_t min = field->min, max = field->max, sum = min + max + 1;
	const int64_t middle = sum >= 0 ? sum / 2 : -((1 - sum) / 2);
	double part;

	if (from_zero)
		return (float)((double)(value - min) / (double)(max - min));
	if (middle == max) /* it has two values */
		part = value == min ? -1 : 1;
	else
		part = value < middle ? (double)(value - middle) / (double)(middle - min)
				      : (double)(value - middle) / (double)(max - middle);
	return (float)(field->turned ? 0 - part : part);
}

/* Of up, right, down, left: one or two neighbours; eight steps, or any number, clockwise from up.
 */
static uint32_t hat_of(const struct track_hid_field *field, int64_t value)
{
	static const uint32_t directions[] = { 1, 3, 2, 6, 4, 12, 8, 9 };
	const int64_t steps = field->max - field->min + 1;

	return directions[(16 * (value - field->min) + steps) / (2 * steps) % 8]
	       << TRACK_HID_HAT_UP;
}

struct change {
	uint32_t clear[TRACK_HID_PADS], set[TRACK_HID_PADS];
};

/* The buttons of an array that may be one of them. */
static uint32_t array_buttons(const struct track_hid_field *field)
{
	return (uint32_t)((UINT64_C(1) << (field->last - field->first + 1)) - 1)
	       << field->first_button;
}

static void take_field(const struct track_hid_field *field, int64_t value, uint8_t triggers,
		       struct change *change, float axes[TRACK_HID_AXES])
{
	const bool inside = value >= field->min && value <= field->max;
	uint32_t *clear = &change->clear[field->pad], *set = &change->set[field->pad];

	switch ((enum track_hid_kind)field->kind) {
	case TRACK_HID_BUTTON_FIELD:
		*clear |= UINT32_C(1) << field->index;
		/* One that measures how hard it is pressed counts from half its way. */
		if (field->bits == 1 ? value != 0 : 2 * value > field->min + field->max)
			*set |= UINT32_C(1) << field->index;
		break;
	case TRACK_HID_ARRAY_FIELD:
		*clear |= array_buttons(field);
		if (inside && value >= field->first && value <= field->last)
			*set |= UINT32_C(1) << (field->first_button + (value - field->first));
		break;
	case TRACK_HID_HAT_FIELD:
		*clear |= UINT32_C(15) << TRACK_HID_HAT_UP;
		if (inside)
			*set |= hat_of(field, value);
		break;
	case TRACK_HID_AXIS_FIELD:
		if (inside)
			axes[field->index] = axis_of(field, value,
						     field->index >= TRACK_HID_SLIDER ||
							     triggers >> field->index & 1);
		break;
	}
}

int track_hid_take(const struct track_hid_pads *pads, const uint8_t *bytes, size_t len,
		   uint8_t triggers, struct track_hid_values *values)
{
	struct change change = { 0 };
	unsigned which = 0;
	uint8_t number;

	if (len < 1)
		return -TRACK_FAULT_LENGTH;
	number = pads->numbered ? bytes[0] : 0;
	if (!pads->bytes[number])
		return -TRACK_FAULT_FORMAT;
	if (len < pads->bytes[number])
		return -TRACK_FAULT_LENGTH;
	for (unsigned i = 0; i < pads->field_count; i++) {
		const struct track_hid_field *field = &pads->fields[i];

		if (field->report != number)
			continue;
		take_field(field, read_field(field, bytes + pads->numbered), triggers, &change,
			   values->axes[field->pad]);
		which |= 1u << field->pad;
	}
	for (unsigned i = 0; i < pads->pad_count; i++)
		values->buttons[i] = (values->buttons[i] & ~change.clear[i]) | change.set[i];
	return (int)which;
}

void track_hid_report(const struct track_hid_values *values, unsigned pad, struct track_report *out)
{
	_Static_assert(TRACK_HID_AXES <= TRACK_AXES, "a report has room for all");
	*out = (struct track_report){
		.has = TRACK_BUTTONS | TRACK_AXIS_VALUES,
		.sensor = pad,
		.buttons = values->buttons[pad],
		.axis_count = TRACK_HID_AXES,
	};
	memcpy(out->axes, values->axes[pad], sizeof values->axes[pad]);
}
