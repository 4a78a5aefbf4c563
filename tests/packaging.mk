# What a package of grotto puts beside the programs: units, manual, scripts.
dist_check_SCRIPTS += tests/packaging/manual.sh tests/packaging/units.sh
TESTS += tests/packaging/manual.sh tests/packaging/units.sh

# The same tests with their slow sweeps.
check-long:
	GROTTO_LONG=1 $(MAKE) $(AM_MAKEFLAGS) check
.PHONY: check-long

# Static analysis, see scripts/lint.
LINT_FLAGS = -std=gnu17 $(DEFS) $(DEFAULT_INCLUDES) $(AM_CPPFLAGS) \
	$(CGLM_CFLAGS) $(LIBCONFIG_CFLAGS) $(SODIUM_CFLAGS) $(LZO_CFLAGS) $(ISAL_CFLAGS) $(XXHASH_CFLAGS) \
	$(SYSTEMD_CFLAGS) $(EPOXY_CFLAGS) $(GLFW_CFLAGS) $(ASSIMP_CFLAGS) \
	$(HIDAPI_CFLAGS) $(LIBUSB_CFLAGS) $(UDEV_CFLAGS) $(UMOCKDEV_CFLAGS) \
	$(OPENEXR_CFLAGS) $(PNG_CFLAGS) $(JPEG_CFLAGS) $(JSONC_CFLAGS) $(PEER_CFLAGS) $(CODEC_CFLAGS) \
	-DGROTTO_SBINDIR='"$(sbindir)"' -DGROTTO_PKGLIBEXECDIR='"$(pkglibexecdir)"'
clang-tidy cppcheck: $(BUILT_SOURCES)
	$(AM_V_GEN)$(top_srcdir)/scripts/lint $@ $(top_srcdir) $(LINT_FLAGS)
.PHONY: clang-tidy cppcheck

EXTRA_DIST += \
	.clang-format .clang-tidy .editorconfig .ci/run \
	scripts/check scripts/count.sh scripts/cppcheck.supp scripts/demo \
	scripts/lib.sh scripts/lint scripts/results scripts/lsan.supp \
	scripts/packages scripts/packages.bench scripts/packages.check
