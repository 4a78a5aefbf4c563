# renderer/view, renderer/tone
RENDERER_SOURCES += renderer/view/projection.h
