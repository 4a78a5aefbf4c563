/*
 * The way to another machine of the room. Where `grotto doctor --listen` runs on
 * the other side a datagram comes back; else the kernel over there says that
 * nobody listens, which too shows that the datagram arrived, or says nothing.
 *
 * An echo is a datagram that says what it is, with a nonce; the answer is as
 * long as the question. Nothing of the cluster's key is in it, and nobody
 * answers it but a doctor that was told to.
 */
#ifndef GROTTO_TOOLS_DOCTOR_WAY_H
#define GROTTO_TOOLS_DOCTOR_WAY_H

#include "daemon/socket.h"
#include "tools/doctor/finding.h"

#include <stdint.h>

#define ECHO_LEAST 24 /* bytes of the shortest echo */
#define ECHO_NONCE 8

/* Fills bytes[0..len-1], len >= ECHO_LEAST. */
void echo_make(uint8_t *bytes, size_t len, const uint8_t nonce[ECHO_NONCE]);
/* Turns a question into its answer, in place; false where it is none. */
bool echo_turn(uint8_t *bytes, size_t len);
/* Is it the answer to that question? */
bool echo_answers(const uint8_t *bytes, size_t len, const uint8_t nonce[ECHO_NONCE]);

enum way_answer {
	WAY_SILENT, /* nothing came back */
	WAY_ECHO,   /* a doctor answered */
	WAY_CLOSED, /* the machine said that nobody listens on that port */
	WAY_ERROR,  /* see error */
};

struct way_probe {
	enum way_answer answer;
	int error;       /* errno of WAY_ERROR: EPERM, EHOSTUNREACH, EMSGSIZE, ... */
	int mtu;         /* of the path as the kernel knows it, 0 unknown */
	int64_t trip_ns; /* of WAY_ECHO and WAY_CLOSED */
};

/*
 * Sends a datagram of len bytes that may not be cut up from `from` (its port is
 * left to the system) to `to`, and waits at most patience_ns; a second one after half of it.
 */
void way_send(const struct net_address *from, const struct net_address *to, size_t len,
	      int64_t patience_ns, struct way_probe *out);

struct way {
	struct way_probe port;  /* a short one, to the port of the layout */
	struct way_probe other; /* a short one to a port that nobody uses, where that one was silent */
	struct way_probe whole; /* as long as the layout's datagrams */
	bool no_neighbour;      /* nobody on this net has the address */
};

/* live: the daemon over there is known to be heard, its port is left alone. */
void way_look(const char *root, const struct net_address *from, const struct net_address *to,
	      size_t datagram_max, bool live, struct way *out);

/* who: "node left"; where: its address and port as text. */
struct finding way_judge(const char *who, const char *where, const struct way *way, bool live);
struct finding way_judge_whole(const char *who, const struct way *way, size_t datagram_max);
/* /proc/net/arp: is the entry of that IPv4 address there, and nobody answered for it? */
bool way_no_neighbour(const char *arp, const char *address);

#endif
