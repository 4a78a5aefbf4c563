# Example layouts, installed to $(pkgdatadir)/layouts.
layoutsdir = $(pkgdatadir)/layouts
dist_layouts_DATA = layouts/cave4.cave
