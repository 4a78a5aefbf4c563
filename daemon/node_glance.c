#include "daemon/node_glance.h"

#include "base/result.h"
#include "renderer/tone/adapt.h"

void node_glance_tell(struct renderer *renderer, struct fdp_node *fdp)
{
	struct adapt_sample sample;
	struct fdp_glance glance;
	uint64_t frame;

	if (renderer_glance(renderer, &sample, &frame) != GR_OK)
		return;
	glance = (struct fdp_glance){
		.log_sum = (float)sample.log_sum,
		.solid_angle = (float)sample.solid_angle,
		.max = (float)sample.max,
	};
	fdp_node_glance(fdp, &glance);
}
