/* Input items as buttons, axes and hats of a pad. Usages: HID Usage Tables 1.12, pages 1, 2, 9. */
#include "tracking/hid_fields.h"

#include "tracking/hid.h"

enum page { DESKTOP = 1, SIMULATION = 2, BUTTON = 9 };
enum input { CONSTANT = 1, VARIABLE = 2, RELATIVE = 4 };

#define X TRACK_HID_USAGE(DESKTOP, 0x30) /* then y z rx ry rz */
#define RZ TRACK_HID_USAGE(DESKTOP, 0x35)
#define SLIDER TRACK_HID_USAGE(DESKTOP, 0x36)
#define DIAL TRACK_HID_USAGE(DESKTOP, 0x37)
#define WHEEL TRACK_HID_USAGE(DESKTOP, 0x38)
#define HAT TRACK_HID_USAGE(DESKTOP, 0x39)
#define DPAD_UP TRACK_HID_USAGE(DESKTOP, 0x90)
#define DPAD_DOWN TRACK_HID_USAGE(DESKTOP, 0x91)
#define DPAD_RIGHT TRACK_HID_USAGE(DESKTOP, 0x92)
#define DPAD_LEFT TRACK_HID_USAGE(DESKTOP, 0x93)
#define RUDDER TRACK_HID_USAGE(SIMULATION, 0xba)
#define THROTTLE TRACK_HID_USAGE(SIMULATION, 0xbb)
#define ACCELERATOR TRACK_HID_USAGE(SIMULATION, 0xc4)
#define BRAKE TRACK_HID_USAGE(SIMULATION, 0xc5)
#define STEERING TRACK_HID_USAGE(SIMULATION, 0xc8)

#define HAT_BUTTONS (UINT32_C(15) << TRACK_HID_HAT_UP)

bool hid_is_pad(uint32_t usage)
{
	return usage == TRACK_HID_GAMEPAD || usage == TRACK_HID_JOYSTICK;
}

static uint64_t length_of(const struct hid_range *range)
{
	return (uint64_t)range->last - range->first.value + 1;
}

/* How many usages an item has. */
static uint64_t total_of(const struct hid_locals *l)
{
	uint64_t total = 0;

	for (unsigned i = 0; i < l->count; i++)
		total += length_of(&l->ranges[i]);
	return total;
}

static uint32_t paged(const struct hid_range *range, uint64_t nth, uint32_t page)
{
	const uint32_t value = (uint32_t)(range->first.value + nth);

	return range->first.paged ? value : TRACK_HID_USAGE(page, value & 0xffff);
}

uint32_t hid_usage_at(const struct hid_locals *l, uint32_t page, uint32_t n)
{
	uint64_t left = n;

	for (unsigned i = 0; i < l->count; i++) {
		const uint64_t length = length_of(&l->ranges[i]);

		if (left < length)
			return paged(&l->ranges[i], left, page);
		left -= length;
	}
	return 0;
}

/* One more field of this item's form, at its n-th place; NULL when there is no room. */
static struct track_hid_field *add(struct track_hid_pads *out, const struct hid_globals *g,
				   unsigned pad, uint32_t bit)
{
	struct track_hid_field *field = &out->fields[out->field_count];

	if (out->field_count == TRACK_HID_FIELDS)
		return NULL;
	out->field_count++;
	*field = (struct track_hid_field){
		.bit = (uint16_t)bit,
		.bits = (uint8_t)g->size,
		.report = g->report,
		.pad = (uint8_t)pad,
		.min = g->min,
		/* 25 FF after a minimum of 0 means 255, though it is written -1. */
		.max = g->max < g->min ? (int64_t)g->max_unsigned : g->max,
	};
	return field;
}

static const char no_room[] = "more buttons and axes than 256";
static const char too_wide[] = "a button or axis of more than 32 bits";
static const char no_range[] = "an axis whose logical maximum is not above its minimum";

static const char *add_button(struct track_hid_pads *out, const struct hid_globals *g, unsigned pad,
			      uint32_t bit, unsigned index)
{
	const uint32_t mask = UINT32_C(1) << index;
	struct track_hid_field *field;

	if (out->has_buttons[pad] & mask)
		return NULL; /* the first one counts */
	field = add(out, g, pad, bit);
	if (!field)
		return no_room;
	field->kind = TRACK_HID_BUTTON_FIELD;
	field->index = (uint8_t)index;
	out->has_buttons[pad] |= mask;
	return NULL;
}

static const char *add_axis(struct track_hid_pads *out, const struct hid_globals *g, unsigned pad,
			    uint32_t bit, enum track_hid_axis axis)
{
	const bool game = out->usages[pad] == TRACK_HID_GAMEPAD;
	struct track_hid_field *field;

	if (axis == TRACK_HID_SLIDER && out->has_axes[pad] >> TRACK_HID_SLIDER & 1)
		axis = TRACK_HID_SLIDER2;
	if (out->has_axes[pad] >> axis & 1)
		return NULL;
	field = add(out, g, pad, bit);
	if (!field)
		return no_room;
	if (field->max <= field->min)
		return no_range;
	field->kind = TRACK_HID_AXIS_FIELD;
	field->index = (uint8_t)axis;
	/* Down and towards the hand is plus in HID; a gamepad's second stick is z rz or rx ry. */
	field->turned =
		axis == TRACK_HID_Y || (game && (axis == TRACK_HID_RY || axis == TRACK_HID_RZ));
	out->has_axes[pad] |= (uint8_t)(1u << axis);
	return NULL;
}

static const char *add_hat(struct track_hid_pads *out, const struct hid_globals *g, unsigned pad,
			   uint32_t bit)
{
	struct track_hid_field *field;

	if (out->has_buttons[pad] & HAT_BUTTONS)
		return NULL;
	field = add(out, g, pad, bit);
	if (!field)
		return no_room;
	if (field->max <= field->min)
		return no_range;
	field->kind = TRACK_HID_HAT_FIELD;
	out->has_buttons[pad] |= HAT_BUTTONS;
	return NULL;
}

static const char *add_variable(struct track_hid_pads *out, const struct hid_globals *g,
				unsigned pad, uint32_t bit, uint32_t usage)
{
	const uint32_t id = usage & 0xffff;

	if (usage >> 16 == BUTTON)
		return id >= 1 && id <= TRACK_HID_BUTTONS ? add_button(out, g, pad, bit, id - 1)
							  : NULL;
	if (usage >= X && usage <= RZ)
		return add_axis(out, g, pad, bit, (enum track_hid_axis)(usage - X));
	switch (usage) {
	case SLIDER:
	case DIAL:
	case WHEEL:
	case THROTTLE:
	case ACCELERATOR:
	case BRAKE: return add_axis(out, g, pad, bit, TRACK_HID_SLIDER);
	case STEERING: return add_axis(out, g, pad, bit, TRACK_HID_X);
	case RUDDER: return add_axis(out, g, pad, bit, TRACK_HID_RZ);
	case HAT: return add_hat(out, g, pad, bit);
	case DPAD_UP: return add_button(out, g, pad, bit, TRACK_HID_HAT_UP);
	case DPAD_RIGHT: return add_button(out, g, pad, bit, TRACK_HID_HAT_UP + 1);
	case DPAD_DOWN: return add_button(out, g, pad, bit, TRACK_HID_HAT_UP + 2);
	case DPAD_LEFT: return add_button(out, g, pad, bit, TRACK_HID_HAT_UP + 3);
	default: return NULL;
	}
}

/* Whether an array's usages are buttons that follow on one another, as all known ones do. */
static bool are_buttons(const struct hid_locals *l, uint32_t page)
{
	for (unsigned i = 0; i < l->count; i++) {
		const uint32_t first = paged(&l->ranges[i], 0, page);

		if (first >> 16 != BUTTON ||
		    (i && first != paged(&l->ranges[i - 1], length_of(&l->ranges[i - 1]), page)))
			return false;
	}
	return l->count > 0;
}

static const char *add_array(struct track_hid_pads *out, const struct hid_globals *g,
			     const struct hid_locals *l, unsigned pad, uint32_t bit)
{
	const uint32_t id = hid_usage_at(l, g->page, 0) & 0xffff;
	const uint32_t none = id == 0; /* "no button" is a usage, too */
	const uint32_t button = id - 1 + none;
	uint64_t count = total_of(l) - none;

	if (button >= TRACK_HID_BUTTONS || count == 0)
		return NULL;
	if (count > TRACK_HID_BUTTONS - button)
		count = TRACK_HID_BUTTONS - button;
	for (uint32_t i = 0; i < g->count; i++) {
		struct track_hid_field *field = add(out, g, pad, bit + i * g->size);

		if (!field)
			return no_room;
		field->kind = TRACK_HID_ARRAY_FIELD;
		field->first_button = (uint8_t)button;
		field->first = field->min + none;
		field->last = field->first + (int64_t)count - 1;
	}
	out->has_buttons[pad] |= (uint32_t)((UINT64_C(1) << count) - 1) << button;
	return NULL;
}

const char *hid_add_fields(struct track_hid_pads *out, const struct hid_globals *g,
			   const struct hid_locals *l, unsigned pad, uint32_t flags, uint32_t bit)
{
	const uint64_t total = total_of(l);
	const char *wrong = NULL;

	/* What is relative is a mouse's. More fields than usages: all of the last one, whose first
	 * counts. */
	if ((flags & (CONSTANT | RELATIVE)) || !g->size || !total)
		return NULL;
	if (!(flags & VARIABLE)) {
		if (!are_buttons(l, g->page))
			return NULL;
		return g->size > 32 ? too_wide : add_array(out, g, l, pad, bit);
	}
	for (uint32_t i = 0; !wrong && i < g->count && i < total; i++) {
		const unsigned before = out->field_count;

		wrong = add_variable(out, g, pad, bit + i * g->size, hid_usage_at(l, g->page, i));
		if (!wrong && out->field_count > before && g->size > 32)
			wrong = too_wide;
	}
	return wrong;
}
