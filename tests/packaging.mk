# What a package of grotto puts beside the programs: units, manual, scripts.
dist_check_SCRIPTS += tests/packaging/units.sh
TESTS += tests/packaging/units.sh

# The same tests with their slow sweeps.
check-long:
	GROTTO_LONG=1 $(MAKE) $(AM_MAKEFLAGS) check
.PHONY: check-long
