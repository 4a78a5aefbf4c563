/* From scene.json to the text of a scene file. */
#ifndef GROTTO_TESTS_FOLDER_SCENE_TEXT_H
#define GROTTO_TESTS_FOLDER_SCENE_TEXT_H

#include "tests/accuracy/folder/folder.h"

/* Fills what struct folder says of the scene, and writes the file's text to out. */
int scene_text_write(struct folder *folder, const char *work, FILE *out, struct gr_diag *diag);

#endif
