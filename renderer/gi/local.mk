# renderer/gi, renderer/trace
RENDERER_SOURCES += renderer/gi/gi.h renderer/trace/rays.h
