/*
 * NV_swap_group and its barrier (GLX_NV_swap_group): windows of several
 * machines whose graphics boards are wired together swap in the same refresh,
 * by hardware. A member that draws nothing holds the others up, so whoever
 * has nothing to show must leave.
 */
#ifndef GROTTO_RENDERER_GL_SWAP_GROUP_H
#define GROTTO_RENDERER_GL_SWAP_GROUP_H

#include <stdbool.h>
#include <stddef.h>

/*
 * The current context's window joins group 1 and that group barrier 1.
 * GR_OK; GR_ERR_UNSUPPORTED with the reason in `why`, and nothing joined.
 */
int swap_group_join(char *why, size_t size);
/* Leaves both; harmless where nothing was joined. */
void swap_group_leave(void);

#endif
