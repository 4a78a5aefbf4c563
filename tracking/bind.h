/*
 * From what devices say of their sensors to where a visitor's head and wand
 * are. Pure: a layout's bindings and the reports are handed in.
 *
 * A binding says that a sensor of a device gives a part of a body: its
 * position, its orientation, its buttons and axes, or several of these. So a
 * wand may take its pose from one device and its buttons from another. The
 * part that leads makes the samples: position where something gives it, else
 * orientation, else buttons and axes; the other parts stand in it as they
 * were last, whenever that was.
 */
#ifndef GROTTO_TRACKING_BIND_H
#define GROTTO_TRACKING_BIND_H

#include "base/diag.h"
#include "tracking/report.h"
#include "tracking/source.h"

#define TRACK_BUTTONS_MAX 32

enum track_part {
	TRACK_PART_POSITION = 1 << 0,
	TRACK_PART_ORIENTATION = 1 << 1,
	TRACK_PART_INPUT = 1 << 2, /* buttons and axes */
};

/* Where a button of the wand comes from. */
struct track_button_from {
	enum { TRACK_FROM_NOTHING, TRACK_FROM_BUTTON, TRACK_FROM_AXIS } kind;
	uint8_t index; /* of the device's button or axis */
	bool negative; /* the axis below -0.5, not above 0.5 */
};

struct track_axis_from {
	bool given;
	uint8_t index;
	bool negative;
};

struct track_binding {
	enum track_body body;
	unsigned sensor;
	unsigned parts; /* enum track_part */
	/* T_room_base; lengths in the base's frame are `scale` times what the device says. */
	struct gr_pose T_room_base;
	float scale;
	struct gr_pose T_sensor_body; /* lever arm: the eyes' middle or the wand's tip, seen from
					 the sensor */
	int64_t latency_ns;	      /* of the device's quickest report */
	unsigned button_count, axis_count;
	struct track_button_from buttons[TRACK_BUTTONS_MAX];
	struct track_axis_from axes[TRACK_AXES];
	uint32_t held; /* buttons made of axes, for their hysteresis */
};

/* What is known of one body. */
struct track_assembly {
	unsigned parts;		    /* that some binding gives */
	unsigned known;		    /* that have come at least once */
	struct gr_pose T_room_body; /* what never came is the start pose's */
	uint32_t buttons;
	uint32_t axis_count;
	float axes[TRACK_AXES];
};

/* start: where the body is before its parts come. parts: of all bindings of this body. */
void track_assembly_init(struct track_assembly *assembly, const struct gr_pose *start,
			 unsigned parts);

/*
 * Takes a report of the binding's sensor into what is known of its body. True
 * with *out, the body's next sample, when the report has the part that leads,
 * or says that the device has lost it. The report's times must be in the scale
 * of samples already.
 */
bool track_bind(struct track_binding *binding, struct track_assembly *assembly,
		const struct track_report *report, struct track_sample *out);

/*
 * The buttons (axes) of a layout, as names of the device apart by blanks, the
 * first one for the body's button (axis) 0; "-" is none. An axis among the
 * buttons is a button that is pressed beyond half its way; a '-' before its
 * name turns an axis round. NULL is the device's own order. GR_OK, or
 * GR_ERR_CONFIG with a line in diag (file, line, key are for that).
 */
struct track_names {
	const char *const *buttons, *const *axes; /* ended by NULL; may be NULL */
};
struct track_place {
	const char *file, *key;
	int line;
};
int track_bind_buttons(struct track_binding *binding, const struct track_names *names,
		       const char *text, const struct track_place *place, struct gr_diag *diag);
int track_bind_axes(struct track_binding *binding, const struct track_names *names,
		    const char *text, const struct track_place *place, struct gr_diag *diag);
/* Index of a name in a list ended by NULL, or -1. */
int track_name_index(const char *const *names, const char *name, size_t len);

#endif
