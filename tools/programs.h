/*
 * Where this command's companions are: the daemons and the shipped layouts
 * and scenes, in the build tree that it was built in or where it is installed.
 */
#ifndef GROTTO_TOOLS_PROGRAMS_H
#define GROTTO_TOOLS_PROGRAMS_H

/*
 * Path of a daemon ("grotto-node"): beside this program, in the build tree's
 * daemon/, in ../sbin, in the configured sbindir. NULL when it is in none of
 * them. Caller frees.
 */
char *programs_find(const char *name);
/*
 * Path of a program that is not for the command line ("bench-lattice"): beside
 * this program, in ../libexec/grotto, in the configured pkglibexecdir. NULL when
 * it is in none of them. Caller frees.
 */
char *programs_own(const char *name);
/*
 * Path of a data file ("layouts/desk.cave"): in the source tree around the
 * build tree, in ../share/grotto, in the configured data directory. NULL when
 * it is in none of them. Caller frees.
 */
char *programs_data(const char *relative);

#endif
