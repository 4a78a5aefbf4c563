/* The layout's keys about the hand: which button and axis of the wand does what. */
#include "config/layout_check.h"

#include <stddef.h>

#define BUTTONS_LAST 31
#define AXES_LAST 7

#define AT(member) .offset = offsetof(struct layout_file_hand, hand.member)
#define BUTTON(key_, standard_, help_)                                                            \
	{ .key = #key_, .type = OPTION_INT, .min = -1, .max = BUTTONS_LAST, .standard = standard_, \
	  AT(key_), .help = help_ }
#define AXIS(key_, standard_, help_)                                                           \
	{ .key = #key_, .type = OPTION_INT, .min = -1, .max = AXES_LAST, .standard = standard_, \
	  AT(key_), .help = help_ }

static const char *const turn_choices[] = { "level", "free", NULL };

const struct option layout_hand_options[] = {
	BUTTON(next, "3", "button that goes on to the next input layout; buttons are counted from 0, -1 is none"),
	BUTTON(fly, "0", "navigation: held, the room moves where the wand points"),
	BUTTON(drag, "4", "navigation: held, the scene turns with the wand"),
	BUTTON(reset, "2", "navigation: the room goes back to where the scene file puts it"),
	BUTTON(lamps, "1", "navigation: switches the lamps that the wand carries"),
	BUTTON(torch, "0", "lighting: held, the torch goes with the wand; let go, it stays there"),
	BUTTON(dimmer, "1", "lighting: held, the torch loses intensity"),
	BUTTON(brighter, "2", "lighting: held, the torch gains intensity"),
	BUTTON(quality, "0", "settings: switches the work that is done while the light rests"),
	BUTTON(fewer, "1", "settings: one propagation step, or gather, fewer a frame"),
	BUTTON(more, "2", "settings: one more"),
	AXIS(saturation, "0", "lighting: axis that changes the torch's saturation; axes are counted from 0, -1 is none"),
	AXIS(hue, "1", "lighting: axis that changes its hue"),
	AXIS(absorption, "0", "settings: axis that changes the medium's absorption"),
	AXIS(scattering, "1", "settings: axis that changes its scattering"),
	{ .key = "turn", .type = OPTION_CHOICE, .choices = turn_choices, .standard = "level", AT(turn),
	  .help = "what drag turns: level keeps the floor level, free turns as the wand does" },
	{ .key = "hud", .type = OPTION_BOOL, .standard = "true", AT(hud),
	  .help = "whether symbols and bars are shown beside a wand that is tracked" },
	{ .key = "hud_scale", .type = OPTION_FLOAT, .min = 0.1, .max = 10, .standard = "1",
	  AT(hud_scale), .help = "their size; at 1 a symbol has 3 cm" },
	{ .key = NULL },
};

struct action {
	const char *key;
	size_t offset;
};

#define ACTION(key) { #key, offsetof(struct layout_hand, key) }
#define ACTIONS_MOST 5

/* What stands beside each other in one input layout. */
static const struct {
	const char *name;
	struct action buttons[ACTIONS_MOST + 1], axes[3];
} modes[] = {
	{ "navigation", { ACTION(next), ACTION(fly), ACTION(drag), ACTION(reset), ACTION(lamps) }, { { 0 } } },
	{ "lighting", { ACTION(next), ACTION(torch), ACTION(dimmer), ACTION(brighter) },
	  { ACTION(saturation), ACTION(hue) } },
	{ "settings", { ACTION(next), ACTION(quality), ACTION(fewer), ACTION(more) },
	  { ACTION(absorption), ACTION(scattering) } },
};

static int value_of(const struct layout_hand *hand, const struct action *action)
{
	return *(const int *)((const char *)hand + action->offset);
}

static void check_apart(struct options_reader *reader, const struct layout_file_hand *file,
			const struct action *actions, const char *what, const char *mode)
{
	for (const struct action *a = actions; a->key; a++)
		for (const struct action *b = actions; b != a; b++)
			if (value_of(&file->hand, a) >= 0 &&
			    value_of(&file->hand, a) == value_of(&file->hand, b))
				options_fault(reader, GR_DIAG_ERROR, file->at, a->key,
					      "%s %d is %s already in %s; give it another, or -1 for none",
					      what, value_of(&file->hand, a), b->key, mode);
}

void layout_check_hand(struct options_reader *reader, const struct layout_file *file)
{
	for (size_t i = 0; i < sizeof modes / sizeof *modes; i++) {
		check_apart(reader, &file->hand, modes[i].buttons, "button", modes[i].name);
		check_apart(reader, &file->hand, modes[i].axes, "axis", modes[i].name);
	}
}
