# Tests. Each fragment adds to TESTS; a test that cannot run here exits 77 and says why.
TEST_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) $(CMOCKA_CFLAGS)

include $(top_srcdir)/tests/base.mk
include $(top_srcdir)/tests/config.mk
include $(top_srcdir)/tests/protocol.mk
include $(top_srcdir)/tests/tracking.mk
include $(top_srcdir)/tests/networks.mk
include $(top_srcdir)/tests/polhemus.mk
include $(top_srcdir)/tests/pads.mk
include $(top_srcdir)/tests/record.mk
include $(top_srcdir)/tests/gl.mk
include $(top_srcdir)/tests/gi.mk
include $(top_srcdir)/tests/trace.mk
include $(top_srcdir)/tests/view.mk
include $(top_srcdir)/tests/folder.mk
include $(top_srcdir)/tests/daemon.mk
include $(top_srcdir)/tests/tools.mk
include $(top_srcdir)/tests/doctor.mk
include $(top_srcdir)/tests/packaging.mk

# For scripts/check, which runs some kinds alone.
.PHONY: list-tests list-programs
list-tests:
	@echo $(TESTS)
list-programs:
	@echo $(check_PROGRAMS)
