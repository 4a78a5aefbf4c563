# renderer/view, renderer/tone
RENDERER_SOURCES += renderer/view/projection.c renderer/view/projection.h
