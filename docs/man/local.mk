# The manual. Pages name the configured folders, and those of files have the
# option tables of docs/layout.md and docs/scene.md.
nodist_man_MANS = \
	docs/man/grotto.1 \
	docs/man/grotto-layout.5 \
	docs/man/grotto-scene.5 \
	docs/man/grotto-master.8 \
	docs/man/grotto-node.8
EXTRA_DIST += \
	docs/man/options.awk \
	docs/man/grotto.1.in \
	docs/man/grotto-layout.5.in \
	docs/man/grotto-scene.5.in \
	docs/man/grotto-master.8.in \
	docs/man/grotto-node.8.in
CLEANFILES += $(nodist_man_MANS)

MAN_SED = $(SED) -e 's|@confdir[@]|$(sysconfdir)/grotto|g' \
	-e 's|@sysconfdir[@]|$(sysconfdir)|g' -e 's|@pkgdatadir[@]|$(pkgdatadir)|g'

docs/man/grotto.1: docs/man/grotto.1.in Makefile
	$(AM_V_GEN)$(MKDIR_P) docs/man && $(MAN_SED) $(srcdir)/docs/man/grotto.1.in > $@.tmp && mv $@.tmp $@
docs/man/grotto-master.8: docs/man/grotto-master.8.in Makefile
	$(AM_V_GEN)$(MKDIR_P) docs/man && $(MAN_SED) $(srcdir)/docs/man/grotto-master.8.in > $@.tmp && mv $@.tmp $@
docs/man/grotto-node.8: docs/man/grotto-node.8.in Makefile
	$(AM_V_GEN)$(MKDIR_P) docs/man && $(MAN_SED) $(srcdir)/docs/man/grotto-node.8.in > $@.tmp && mv $@.tmp $@

MAN_OPTIONS = $(AWK) -f $(srcdir)/docs/man/options.awk
docs/man/grotto-layout.5: docs/man/grotto-layout.5.in docs/man/options.awk docs/layout.md Makefile
	$(AM_V_GEN)$(MKDIR_P) docs/man && $(MAN_OPTIONS) -v tables=$(srcdir)/docs/layout.md \
		$(srcdir)/docs/man/grotto-layout.5.in | $(MAN_SED) > $@.tmp && mv $@.tmp $@
docs/man/grotto-scene.5: docs/man/grotto-scene.5.in docs/man/options.awk docs/scene.md Makefile
	$(AM_V_GEN)$(MKDIR_P) docs/man && $(MAN_OPTIONS) -v tables=$(srcdir)/docs/scene.md \
		$(srcdir)/docs/man/grotto-scene.5.in | $(MAN_SED) > $@.tmp && mv $@.tmp $@
