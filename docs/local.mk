# What docs/ adds to the build.
dist_doc_DATA += docs/layout.md docs/scene.md
dist_doc_DATA += README.md CHANGELOG.md LICENSE docs/architecture.md docs/operating.md docs/tracking.md docs/trackers.md
include $(top_srcdir)/docs/man/local.mk
dist_doc_DATA += docs/protocol.md
dist_doc_DATA += docs/control.md docs/doctor.md docs/interaction.md docs/recording.md
dist_doc_DATA += docs/models.md
dist_doc_DATA += docs/light.md
dist_doc_DATA += docs/surfels.md
dist_doc_DATA += docs/reference.md
dist_doc_DATA += docs/bench.md docs/bench-box.svg docs/bench-box-closed.svg docs/bench-cornell-mirror.svg \
	docs/bench-cornell-spot.svg docs/bench-grotto.svg docs/bench-sponza.svg
dist_doc_DATA += docs/view.md
dist_doc_DATA += docs/results.md docs/goals.md docs/demo-room.png
dist_doc_DATA += docs/comparing.md docs/delivery.md
dist_doc_DATA += docs/baking.md docs/hard-cases.md
