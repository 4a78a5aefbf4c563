#include "tools/bench/delivery.h"

#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>

#define RULES_MOST 640

extern char **environ;

static bool nft(char *rules)
{
	char *words[] = { (char *)"nft", rules, NULL };
	int status;
	pid_t pid;

	return !posix_spawnp(&pid, words[0], NULL, NULL, words, environ) &&
	       waitpid(pid, &status, 0) == pid && WIFEXITED(status) && !WEXITSTATUS(status);
}

/*
 * Bursts are Gilbert's model with a bad state of one length: a sender's address stays in
 * a set for so long, and all that comes from it is dropped while it does.
 */
bool delivery_lose(const struct delivery_loss *loss)
{
	char rules[RULES_MOST] = "add table netdev loss; delete table netdev loss";
	size_t len = strlen(rules);

	if (loss->run)
		return nft(rules);
	if (loss->permille)
		len += (size_t)snprintf(rules + len, sizeof rules - len,
					"; add table netdev loss; add set netdev loss bad { type ipv4_addr; "
					"flags dynamic,timeout; }; add chain netdev loss in { type filter hook "
					"ingress device \"eth0\" priority 0; }");
	if (loss->burst_ms)
		snprintf(rules + len, sizeof rules - len,
			 "; add rule netdev loss in ip saddr @bad drop; add rule netdev loss in meta protocol ip "
			 "numgen random mod 1000 < %u add @bad { ip saddr timeout %ums } drop",
			 loss->permille, loss->burst_ms);
	else if (loss->permille)
		snprintf(rules + len, sizeof rules - len,
			 "; add rule netdev loss in meta protocol ip numgen random mod 1000 < %u drop",
			 loss->permille);
	return nft(rules);
}

/* Uniform in [0, 1). */
static double draw(uint64_t *state)
{
	*state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
	return (double)(*state >> 11) * 0x1p-53;
}

bool delivery_lost(const struct delivery_loss *loss, struct delivery_runs *runs)
{
	const double share = loss->permille / 1000.0;

	if (!loss->run)
		return false;
	if (runs->bad)
		runs->bad = draw(&runs->random) >= 1.0 / loss->run;
	else
		runs->bad = draw(&runs->random) < share / (1 - share) / loss->run;
	return runs->bad;
}
