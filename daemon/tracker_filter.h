/* What the layout says about the filter of head and wand. */
#ifndef GROTTO_DAEMON_TRACKER_FILTER_H
#define GROTTO_DAEMON_TRACKER_FILTER_H

#include "config/layout.h"
#include "tracking/filter.h"
#include "tracking/source.h"

/* Of the tracker that gives the body's position, else of that of its orientation; of none: no filter and no gate. */
struct track_filter_params tracker_filter_of(const struct layout *layout, enum track_body body);

#endif
