/*
 * Giving up root. Order of a daemon's start: read configuration and key, open
 * ports and devices, drop, then READY. Under the shipped units systemd has
 * dropped already and this changes nothing but no_new_privs.
 */
#ifndef GROTTO_DAEMON_PRIVILEGES_H
#define GROTTO_DAEMON_PRIVILEGES_H

/*
 * Started as root with a user's name: takes that user's ids and all of the
 * user's groups, for good, and makes `give` (a path such as the control
 * socket, or NULL) the user's. Without a name, or not as root, the ids stay.
 * Always sets no_new_privs. GR_OK, GR_ERR_CONFIG (no such user), GR_ERR_IO;
 * the log says what failed.
 */
int privileges_drop(const char *user, const char *give);

#endif
