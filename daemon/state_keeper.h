/*
 * Writes a small file again and again, off the caller's thread: a disk may
 * take its time, a frame may not. Each is written beside the old one and takes
 * its place whole (fsync, rename): who reads has one or the other.
 */
#ifndef GROTTO_DAEMON_STATE_KEEPER_H
#define GROTTO_DAEMON_STATE_KEEPER_H

#include <stddef.h>
#include <stdint.h>

struct state_keeper;
/* Copies path. Files have at most `room` bytes. GR_ERR_NOMEM, GR_ERR_IO (no thread). */
int state_keeper_create(struct state_keeper **out, const char *path, size_t room);
/* Takes a copy and returns; one that was not written yet is forgotten for it. */
void state_keeper_put(struct state_keeper *keeper, const uint8_t *bytes, size_t len);
/* Writes what was put last, then ends. */
void state_keeper_destroy(struct state_keeper **keeper);

#endif
