# Own scenes. make-scenes.py wrote the models; building does not need it.
scenedir = $(pkgdatadir)/scenes
dist_scene_DATA = \
	scenes/box.gltf scenes/box.scene \
	scenes/box-closed.gltf scenes/box-closed.scene \
	scenes/cornell.gltf scenes/cornell.scene \
	scenes/cornell-mirror.scene \
	scenes/cornell-spot.gltf scenes/cornell-spot.scene \
	scenes/grotto.gltf scenes/grotto.scene
EXTRA_DIST += scenes/make-scenes.py
