# renderer/gi
RENDERER_SOURCES += \
	renderer/gi/dispatch.c renderer/gi/dispatch.h \
	renderer/gi/front.c renderer/gi/front.h \
	renderer/gi/gi.h \
	renderer/gi/lattice.c renderer/gi/lattice.h \
	renderer/gi/link.c renderer/gi/link.h \
	renderer/gi/lpv.c renderer/gi/lpv_check.c renderer/gi/lpv_private.h renderer/gi/lpv_splat.c renderer/gi/lpv_start.c \
	renderer/gi/lpv_cpu.c renderer/gi/lpv_cpu.h renderer/gi/lpv_thesis.c \
	renderer/gi/choose.c renderer/gi/choose.h \
	renderer/gi/costs_file.c renderer/gi/costs_file.h \
	renderer/gi/plan.c renderer/gi/plan.h renderer/gi/plan_private.h \
	renderer/gi/plan_adopt.c renderer/gi/plan_code.c renderer/gi/plan_cost.c renderer/gi/plan_error.c renderer/gi/plan_facts.c renderer/gi/plan_say.c \
	renderer/gi/sectors.c renderer/gi/sectors.h \
	renderer/gi/surface.c renderer/gi/surface.h \
	renderer/gi/surfel_bake.c renderer/gi/surfel_bake.h renderer/gi/surfel_bake_private.h \
	renderer/gi/surfel_cells.c renderer/gi/surfel_count.c renderer/gi/surfel_count.h renderer/gi/surfel_fixed.c renderer/gi/surfel_links.c \
	renderer/gi/surfel_map.c renderer/gi/surfel_map.h renderer/gi/surfel_map_cells.c \
	renderer/gi/surfel_material.c renderer/gi/surfel_owner.c \
	renderer/gi/surfel_patch_data.c renderer/gi/surfel_patches.c renderer/gi/surfel_points.c renderer/gi/surfel_probes.c \
	renderer/gi/surfel_file.c renderer/gi/surfel_file.h renderer/gi/surfel_file_check.c renderer/gi/surfel_file_private.h \
	renderer/gi/surfel_lock.c renderer/gi/surfel_lock.h \
	renderer/gi/surfel_store.c renderer/gi/surfel_store.h \
	renderer/gi/surfel_random.h renderer/gi/surfel_reach.c renderer/gi/surfel_surface.c \
	renderer/gi/surfel_grid.c renderer/gi/surfel_set.c renderer/gi/surfel_set.h renderer/gi/surfel_start.c \
	renderer/gi/surfels.c renderer/gi/surfels.h renderer/gi/surfels_private.h \
	renderer/gi/surfels_air.c renderer/gi/surfels_check.c renderer/gi/surfels_probes.c renderer/gi/surfels_share.c renderer/gi/surfels_smooth.c renderer/gi/surfels_upload.c \
	renderer/gi/transfer.c renderer/gi/transfer.h

SHADERS += \
	renderer/shaders/gi_lpv.glsl renderer/shaders/gi_probe.comp renderer/shaders/gi_lpv_thesis.glsl renderer/shaders/lpv_check.comp \
	renderer/shaders/lpv_front.glsl renderer/shaders/lpv_leap.comp renderer/shaders/lpv_lattice.glsl renderer/shaders/lpv_reflect.comp renderer/shaders/lpv_splat.glsl \
	renderer/shaders/lpv_splat_peak.comp renderer/shaders/lpv_splat_resolve.comp \
	renderer/shaders/lpv_splat_sum.comp renderer/shaders/lpv_step.comp \
	renderer/shaders/lpv_thesis_start.comp renderer/shaders/lpv_thesis_step.comp \
	renderer/shaders/lpv_thesis_store.comp \
	renderer/shaders/gi_probes.glsl renderer/shaders/gi_surfels.glsl renderer/shaders/probe_check.comp renderer/shaders/probe_gather.comp \
	renderer/shaders/probe_grid.glsl renderer/shaders/surfel_air.glsl renderer/shaders/surfel_block.glsl renderer/shaders/surfel_check.comp \
	renderer/shaders/surfel_gather.comp renderer/shaders/surfel_light.comp renderer/shaders/surfel_pack.comp \
	renderer/shaders/surfel_packed.glsl renderer/shaders/surfel_slice.glsl renderer/shaders/surfel_smooth.comp renderer/shaders/surfel_thin.comp \
	renderer/shaders/surfel_unpack.comp
