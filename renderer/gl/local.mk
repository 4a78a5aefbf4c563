# renderer/gl, renderer/scene, renderer/image
RENDERER_SOURCES += \
	renderer/gl/mesh.h renderer/gl/program.h renderer/gl/target.h renderer/gl/timer.h \
	renderer/image/image.h \
	renderer/scene/scene.h
