# Units, users and device rules. The units name the daemons by their full path,
# which only make knows: see "Installation Directory Variables" in autoconf's manual.
systemdsystemunit_DATA = \
	systemd/grotto-master.service \
	systemd/grotto-node@.service
dist_sysusers_DATA = systemd/sysusers.d/grotto.conf
dist_udevrules_DATA = systemd/udev/70-grotto.rules
examplesdir = $(docdir)/examples
dist_examples_DATA = systemd/grotto.default

EXTRA_DIST += \
	systemd/grotto-master.service.in \
	systemd/grotto-node@.service.in
CLEANFILES += $(systemdsystemunit_DATA)

UNIT_SED = $(SED) -e 's|@sbindir[@]|$(sbindir)|g' \
	-e 's|@confdir[@]|$(sysconfdir)/grotto|g' \
	-e 's|@sysconfdir[@]|$(sysconfdir)|g'

systemd/grotto-master.service: $(srcdir)/systemd/grotto-master.service.in Makefile
	$(AM_V_at)$(MKDIR_P) systemd
	$(AM_V_GEN)$(UNIT_SED) '$(srcdir)/systemd/grotto-master.service.in' > $@.tmp && mv $@.tmp $@

systemd/grotto-node@.service: $(srcdir)/systemd/grotto-node@.service.in Makefile
	$(AM_V_at)$(MKDIR_P) systemd
	$(AM_V_GEN)$(UNIT_SED) '$(srcdir)/systemd/grotto-node@.service.in' > $@.tmp && mv $@.tmp $@
