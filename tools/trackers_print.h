/* What a master, or this program itself, says of trackers, for a person. */
#ifndef GROTTO_TOOLS_TRACKERS_PRINT_H
#define GROTTO_TOOLS_TRACKERS_PRINT_H

#include <json-c/json.h>

/* One line for each element of the array (docs/control.md, "trackers"), and what is wrong with it.
 */
void trackers_print(struct json_object *trackers);
/* The same with the pose of each body below its tracker. */
void trackers_print_poses(struct json_object *trackers);

#endif
