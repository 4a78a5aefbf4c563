#include "tools/trackers_print.h"

#include "tools/report.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#define DEG_PER_RAD 57.29577951308232

static size_t length(struct json_object *array)
{
	return json_object_is_type(array, json_type_array) ? json_object_array_length(array) : 0;
}

static double element(struct json_object *array, size_t i)
{
	return i < length(array) ? json_object_get_double(json_object_array_get_idx(array, i)) : 0;
}

static void print_battery(struct json_object *tracker)
{
	if (report_member(tracker, "battery"))
		printf(" %5.0f %%", 100 * report_number(tracker, "battery"));
	else
		printf(" %7s", "-");
}

/* Why it is not running, since when; what was refused. */
static void print_trouble(struct json_object *tracker)
{
	struct json_object *faults = report_member(tracker, "faults");
	bool any = false;

	if (strcmp(report_text(tracker, "state"), "running") != 0)
		printf("    %s for %.0f s: %s\n", report_text(tracker, "state"),
		       report_number(tracker, "since_s"), report_text(tracker, "why"));
	if (!json_object_is_type(faults, json_type_object))
		return;
	json_object_object_foreach(faults, fault, count)
	{
		printf("%s%lld %s",
		       any ? ", " : "    refused: ", (long long)json_object_get_int64(count),
		       fault);
		any = true;
	}
	if (any)
		printf("\n");
}

/*
 * Heading, pitch and roll of a quaternion x y z w, in the order of a layout's
 * angles: about +Y, then about the turned X, then about the line of sight.
 */
static void angles_of(struct json_object *q, double deg[3])
{
	const double x = element(q, 0), y = element(q, 1), z = element(q, 2), w = element(q, 3);
	const double sine = 2 * (w * x - y * z);

	deg[0] = atan2(2 * (x * z + w * y), 1 - 2 * (x * x + y * y)) * DEG_PER_RAD;
	deg[1] = asin(fmin(fmax(sine, -1), 1)) * DEG_PER_RAD;
	deg[2] = atan2(2 * (x * y + w * z), 1 - 2 * (x * x + z * z)) * DEG_PER_RAD;
}

static void print_pose(struct json_object *pose)
{
	struct json_object *p = report_member(pose, "position_m"),
			   *axes = report_member(pose, "axes");
	double deg[3];

	angles_of(report_member(pose, "orientation"), deg);
	printf("    %-5s", report_text(pose, "body"));
	if (json_object_get_boolean(report_member(pose, "tracked")))
		printf(" %8.3f %7.3f %7.3f m, heading %6.1f pitch %5.1f roll %6.1f deg",
		       element(p, 0), element(p, 1), element(p, 2), deg[0], deg[1], deg[2]);
	else
		printf(" lost");
	if (!strcmp(report_text(pose, "body"), "wand"))
		printf(", buttons %#llx", (unsigned long long)report_count(pose, "buttons"));
	for (size_t i = 0; i < length(axes); i++)
		printf("%s%+.2f", i ? " " : ", axes ", element(axes, i));
	printf("\n");
}

static void print_one(struct json_object *tracker, bool poses)
{
	struct json_object *bodies = report_member(tracker, "poses");

	printf("%-14s %-9s %-8s %8.1f %9.2f", report_text(tracker, "name"),
	       report_text(tracker, "kind"), report_text(tracker, "state"),
	       report_number(tracker, "rate_hz"), report_number(tracker, "jitter_ms"));
	if (report_member(tracker, "age_ms"))
		printf(" %8.1f", report_number(tracker, "age_ms"));
	else
		printf(" %8s", "never");
	printf(" %9lld %8lld", (long long)report_count(tracker, "dropouts"),
	       (long long)report_count(tracker, "missed"));
	print_battery(tracker);
	printf("\n");
	print_trouble(tracker);
	for (size_t i = 0; poses && i < length(bodies); i++)
		print_pose(json_object_array_get_idx(bodies, i));
}

static void print_all(struct json_object *trackers, bool poses)
{
	if (!length(trackers))
		return;
	printf("%-14s %-9s %-8s %8s %9s %8s %9s %8s %7s\n", "tracker", "kind", "state", "rate Hz",
	       "jitter ms", "age ms", "drop-outs", "missed", "battery");
	for (size_t i = 0; i < length(trackers); i++)
		print_one(json_object_array_get_idx(trackers, i), poses);
}

void trackers_print(struct json_object *trackers)
{
	print_all(trackers, false);
}

void trackers_print_poses(struct json_object *trackers)
{
	print_all(trackers, true);
}
