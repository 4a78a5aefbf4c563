# Example layouts, installed to $(pkgdatadir)/layouts.
layoutsdir = $(pkgdatadir)/layouts
dist_layouts_DATA = \
	layouts/cave4.cave \
	layouts/cave5-stereo.cave \
	layouts/desk.cave \
	layouts/powerwall.cave
