# What docs/ adds to the build.
dist_doc_DATA += docs/layout.md docs/scene.md
