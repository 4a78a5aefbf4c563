# renderer/view, renderer/tone
RENDERER_SOURCES += \
	renderer/tone/adapt.c renderer/tone/adapt.h renderer/tone/curve.c renderer/tone/curve.h \
	renderer/tone/encode.c renderer/tone/encode.h renderer/tone/srgb.h \
	renderer/tone/gaze.c renderer/tone/gaze.h \
	renderer/tone/projector.c renderer/tone/projector.h \
	renderer/tone/tone.c renderer/tone/tone.h \
	renderer/view/backdrop.c renderer/view/backdrop.h \
	renderer/view/blocks.h \
	renderer/view/emissive.c renderer/view/emissive.h \
	renderer/view/env_sh.c renderer/view/env_sh.h \
	renderer/view/eyes.c renderer/view/eyes.h \
	renderer/view/gbuffer.c renderer/view/gbuffer.h \
	renderer/view/hud.c renderer/view/hud.h renderer/view/hud_bars.c \
	renderer/view/hud_parts.c renderer/view/hud_parts.h renderer/view/hud_private.h \
	renderer/view/maps.c renderer/view/maps.h \
	renderer/view/patches.c renderer/view/patches.h \
	renderer/view/projection.c renderer/view/projection.h \
	renderer/view/rsm.c renderer/view/rsm.h \
	renderer/view/shade.c renderer/view/shade.h \
	renderer/view/shadow.c renderer/view/shadow.h
SHADERS += \
	renderer/shaders/backdrop.glsl \
	renderer/shaders/env_sh.glsl renderer/shaders/env_sh_bands.comp \
	renderer/shaders/env_sh_rows.comp renderer/shaders/env_sh_turn.comp \
	renderer/shaders/depth.vert renderer/shaders/gbuffer.frag \
	renderer/shaders/gaze.comp renderer/shaders/gi_none.glsl renderer/shaders/hud.frag renderer/shaders/hud.vert \
	renderer/shaders/lamp.glsl \
	renderer/shaders/lamp_shadow.glsl renderer/shaders/medium.glsl \
	renderer/shaders/patch.glsl renderer/shaders/patch_shadow.glsl \
	renderer/shaders/rsm.frag renderer/shaders/screen.vert renderer/shaders/shade.frag \
	renderer/shaders/shadow.glsl renderer/shaders/surface.vert renderer/shaders/tone.frag
