# renderer/gl, renderer/scene, renderer/image
RENDERER_SOURCES += \
	renderer/gl/mesh.c renderer/gl/mesh.h renderer/gl/pattern.c renderer/gl/pattern.h \
	renderer/gl/swap_group.c renderer/gl/swap_group.h renderer/gl/program.c renderer/gl/program.h \
	renderer/gl/shader_text.c renderer/gl/shader_text.h renderer/gl/shaders.h \
	renderer/gl/target.c renderer/gl/target.h renderer/gl/target_egl.c \
	renderer/gl/target_glfw.c renderer/gl/target_input.c renderer/gl/target_private.h \
	renderer/gl/timer.c renderer/gl/timer.h \
	renderer/image/compare.c renderer/image/compare.h renderer/image/compare_flip.c \
	renderer/image/compare_ssim.c renderer/image/convolve.c renderer/image/convolve.h \
	renderer/image/exr_private.h renderer/image/exr_read.c renderer/image/exr_write.c \
	renderer/image/hdr.c renderer/image/image.c renderer/image/image.h renderer/image/png.c \
	renderer/image/read_file.c renderer/image/read_file.h \
	renderer/scene/brdf_color.c renderer/scene/brdf_private.h \
	renderer/scene/brdf_read.c renderer/scene/brdf_read.h \
	renderer/scene/brdf_sampling.c renderer/scene/brdf_table.c renderer/scene/brdf_table.h \
	renderer/scene/environment.c renderer/scene/environment.h \
	renderer/scene/environment_cube.c renderer/scene/environment_cube.h \
	renderer/scene/environment_load.c renderer/scene/environment_private.h \
	renderer/scene/environment_sample.c \
	renderer/scene/gltf.c renderer/scene/gltf.h renderer/scene/gltf_pack.c \
	renderer/scene/gltf_schema.c renderer/scene/import.c renderer/scene/import.h \
	renderer/scene/import_geometry.c renderer/scene/import_image.c \
	renderer/scene/import_material.c renderer/scene/isolate.c renderer/scene/isolate.h \
	renderer/scene/scene.c renderer/scene/scene.h \
	renderer/scene/scene_block.c renderer/scene/scene_block.h \
	renderer/scene/scene_hash.c renderer/scene/scene_import.c \
	renderer/scene/scene_surface.c renderer/scene/scene_surface.h \
	renderer/scene/sh.c renderer/scene/sh.h \
	renderer/scene/sky.c renderer/scene/sky.h \
	renderer/scene/texel.c renderer/scene/texel.h renderer/scene/texture.c

SHADERS += renderer/shaders/material.glsl
EXTRA_DIST += renderer/shaders/embed.awk renderer/shaders/resolve.awk renderer/shaders/check.sh

# All SHADERS become one C file; before that they are compiled offline where
# there is a validator. The paths are put together by the shell since SHADERS
# are relative to the source tree.
if HAVE_GLSLANG
SHADERS_CHECKED = renderer/shaders/checked.stamp
endif
renderer/shaders/checked.stamp: $(SHADERS) renderer/shaders/resolve.awk renderer/shaders/check.sh Makefile
	$(AM_V_GEN)$(MKDIR_P) renderer/shaders && stamp=`pwd`/$@ && cd $(srcdir) && \
	$(SHELL) renderer/shaders/check.sh "$(AWK)" "$(GLSLANG)" $(SHADERS) && echo ok >$$stamp
renderer/shaders/embedded.c: $(SHADERS) renderer/shaders/embed.awk Makefile $(SHADERS_CHECKED)
	$(AM_V_GEN)$(MKDIR_P) renderer/shaders && out=`pwd`/$@ && cd $(srcdir) && \
	$(AWK) -f renderer/shaders/embed.awk $(SHADERS) >$$out.tmp && mv $$out.tmp $$out
CLEANFILES += renderer/shaders/embedded.c renderer/shaders/embedded.c.tmp \
	renderer/shaders/checked.stamp
