# Foreign pictures of foreign scenes (tests/accuracy/folder), and who reads them.
FOLDER_SOURCES = \
	tests/accuracy/folder/agreement.c tests/accuracy/folder/agreement.h \
	tests/accuracy/folder/folder.c tests/accuracy/folder/folder.h \
	tests/accuracy/folder/json_walk.c tests/accuracy/folder/json_walk.h \
	tests/accuracy/folder/methods.c tests/accuracy/folder/methods.h \
	tests/accuracy/folder/model.c tests/accuracy/folder/model.h \
	tests/accuracy/folder/scene_text.c tests/accuracy/folder/scene_text.h \
	tests/accuracy/folder/work.h
FOLDER_CFLAGS = $(TEST_CFLAGS) $(EPOXY_CFLAGS) $(OPENEXR_CFLAGS) $(JSONC_CFLAGS) -D_GNU_SOURCE

# By hand: tests/accuracy/run-folder DIR
check_PROGRAMS += tests/accuracy/run-folder
tests_accuracy_run_folder_SOURCES = tests/accuracy/run_folder.c $(FOLDER_SOURCES)
tests_accuracy_run_folder_CFLAGS = $(FOLDER_CFLAGS)
tests_accuracy_run_folder_LDADD = $(RENDERER_LIBS) -lm

check_PROGRAMS += tests/unit/test_folder tests/accuracy/test_cycles
TESTS += tests/unit/test_folder tests/accuracy/test_cycles
tests_unit_test_folder_SOURCES = tests/unit/test_folder.c tests/unit/unit.h tests/unit/shared.h \
	$(FOLDER_SOURCES)
tests_unit_test_folder_CFLAGS = $(FOLDER_CFLAGS)
tests_unit_test_folder_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS) -lm
tests_accuracy_test_cycles_SOURCES = tests/accuracy/test_cycles.c tests/unit/unit.h \
	tests/unit/shared.h $(FOLDER_SOURCES)
tests_accuracy_test_cycles_CFLAGS = $(FOLDER_CFLAGS)
tests_accuracy_test_cycles_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS) -lm
