/* The context that the node would draw with. */
#include "tools/doctor/doctor.h"

#include "base/result.h"
#include "renderer/gl/target.h"

#include <epoxy/gl.h>
#include <epoxy/glx.h>
#include <string.h>

static enum target_kind kind_of(enum layout_target target)
{
	switch (target) {
	case LAYOUT_TARGET_HEADLESS: return TARGET_HEADLESS;
	case LAYOUT_TARGET_WINDOW: return TARGET_WINDOW;
	case LAYOUT_TARGET_FULLSCREEN: return TARGET_FULLSCREEN;
	}
	return TARGET_HEADLESS;
}

static struct finding judge_renderer(const char *name)
{
	static const char *const software[] = { "llvmpipe", "softpipe", "swrast" };

	for (size_t i = 0; i < sizeof software / sizeof *software; i++)
		if (strstr(name, software[i]))
			return finding_do(finding(FINDING_WARN, "draws with %s: OpenGL in software", name),
					  "install the GPU's driver; is user grotto in groups video and render? "
					  "gpu = N in the layout chooses another device");
	return finding(FINDING_OK, "draws with %s", name);
}

static struct finding judge_swap_group(const struct layout *layout, bool window)
{
	Display *display = window ? glXGetCurrentDisplay() : NULL;
	bool there = display && epoxy_has_glx_extension(display, 0, "GLX_NV_swap_group");

	if (there)
		return finding(FINDING_OK, "GLX_NV_swap_group is there; whether its cables are the log of the node "
			       "says when it joins");
	if (layout->swap.mode == LAYOUT_SWAP_HARDWARE)
		return finding_do(finding(FINDING_FAIL, "swap.mode = \"hardware\", and there is no GLX_NV_swap_group"),
				  "a Quadro Sync board and target = \"fullscreen\" or \"window\", or swap.mode = "
				  "\"auto\": nodes then swap at a time");
	return finding(FINDING_OK, "no GLX_NV_swap_group%s: nodes swap at a time or when told",
		       window ? "" : " (headless)");
}

void check_gl(struct doctor *d)
{
	const struct layout_node *node = d->node >= 0 ? &d->layout->nodes[d->node] : NULL;
	struct target_params params = { .title = "grotto doctor", .width = 64, .height = 64 };
	struct target *target = NULL;

	if (!node || !d->gl) {
		findings_add(&d->found, finding(FINDING_SKIP, node ? "--no-gl" : "a master draws nothing"));
		return;
	}
	params.kind = kind_of(node->target);
	params.display = node->display;
	params.gpu = node->gpu;
	params.monitor = node->monitor;
	params.quad_buffer = node->eyes == LAYOUT_EYES_QUAD_BUFFER;
	if (params.kind != TARGET_HEADLESS && d->port.held) {
		findings_add(&d->found, finding_do(finding(FINDING_SKIP, "the node runs: a second window would cover its "
							   "wall"), "its log says what it draws with"));
		return;
	}
	if (target_create(&target, &params) < 0) {
		findings_add(&d->found, finding_do(finding(FINDING_FAIL, "no context as the node needs it; the lines on "
							   "standard error say why"),
						   "OpenGL 4.5: the GPU's driver, rights of /dev/dri (groups video, "
						   "render), for a window DISPLAY and XAUTHORITY"));
		return;
	}
	findings_add(&d->found, judge_renderer(target_renderer_name(target)));
	findings_add(&d->found, finding(FINDING_OK, "OpenGL %s (%s)", (const char *)glGetString(GL_VERSION),
					target_platform_name(target)));
	findings_add(&d->found, judge_swap_group(d->layout, params.kind != TARGET_HEADLESS));
	target_destroy(&target);
}
