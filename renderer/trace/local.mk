# renderer/trace: rays on the CPU, and the reference
RENDERER_SOURCES += \
	renderer/trace/bsdf.c renderer/trace/bsdf.h \
	renderer/trace/crew.c renderer/trace/crew.h \
	renderer/trace/emitters.c renderer/trace/emitters.h \
	renderer/trace/estimate.c renderer/trace/estimate.h \
	renderer/trace/film.c renderer/trace/film_file.c \
	renderer/trace/lamps.c renderer/trace/lamps.h \
	renderer/trace/medium.h \
	renderer/trace/path.c renderer/trace/path.h \
	renderer/trace/random.h renderer/trace/rays.c renderer/trace/rays.h \
	renderer/trace/reference.c renderer/trace/reference.h \
	renderer/trace/reference_key.c renderer/trace/reference_private.h \
	renderer/trace/reference_view.c \
	renderer/trace/sampler.h renderer/trace/vector.h \
	renderer/trace/world.c renderer/trace/world.h
