#include "config.h" /* _GNU_SOURCE */

#include "daemon/control.h"

#include "base/log.h"
#include "base/result.h"
#include "daemon/json.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

struct client {
	struct control *control;
	int fd; /* -1: free */
	char in[CONTROL_LINE_MAX];
	size_t in_len;
	char out[CONTROL_ANSWER_MAX + 1]; /* and the newline */
	size_t out_len, out_at;
	int64_t since_ns; /* start of what the client is waited for */
	bool shut;        /* the client sends nothing more */
};

struct control {
	struct loop *loop;
	int fd, timer;
	char path[sizeof((struct sockaddr_un *)0)->sun_path];
	control_answer_fn answer;
	void *ctx;
	struct client clients[CONTROL_CLIENTS];
};

int control_split(char *line, size_t len, char *words[CONTROL_WORDS])
{
	int count = 0;
	bool inside = false;

	for (size_t i = 0; i < len; i++) {
		unsigned char c = (unsigned char)line[i];

		if (c == ' ' || c == '\t') {
			line[i] = '\0';
			inside = false;
		} else if (c < 0x21 || c > 0x7e) {
			return GR_ERR_FORMAT;
		} else if (!inside) {
			if (count == CONTROL_WORDS)
				return GR_ERR_FORMAT;
			words[count++] = line + i;
			inside = true;
		}
	}
	line[len] = '\0';
	return count;
}

void control_refuse(char *answer, size_t size, const char *format, ...)
{
	struct json json = json_start(answer, size);
	char text[256];
	va_list args;

	va_start(args, format);
	vsnprintf(text, sizeof text, format, args);
	va_end(args);
	json_open(&json, NULL, '{');
	json_bool(&json, "ok", false);
	json_string(&json, "error", text);
	json_close(&json, '}');
}

static void drop(struct client *client)
{
	loop_remove(client->control->loop, client->fd);
	close(client->fd);
	client->fd = -1;
}

static void answer_line(struct client *client, char *line, size_t len)
{
	char *words[CONTROL_WORDS];
	int count;

	if (len > 0 && line[len - 1] == '\r')
		len--;
	count = control_split(line, len, words);
	if (count < 0)
		control_refuse(client->out, CONTROL_ANSWER_MAX,
			       "a request is one line of printable ASCII, at most %d words", CONTROL_WORDS);
	else if (count == 0)
		control_refuse(client->out, CONTROL_ANSWER_MAX, "the request is empty");
	else
		client->control->answer(client->control->ctx, words, count, client->out,
					CONTROL_ANSWER_MAX);
	client->out_len = strnlen(client->out, CONTROL_ANSWER_MAX);
	client->out[client->out_len++] = '\n';
	client->out_at = 0;
}

/* Sends what it can; false when the client is gone. */
static bool send_out(struct client *client)
{
	while (client->out_at < client->out_len) {
		ssize_t n = send(client->fd, client->out + client->out_at,
				 client->out_len - client->out_at, MSG_NOSIGNAL | MSG_DONTWAIT);
		if (n < 0 && errno == EINTR)
			continue;
		if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK))
			return true;
		if (n < 0)
			return false;
		client->out_at += (size_t)n;
	}
	client->out_len = client->out_at = 0;
	return true;
}

/* Answers whole lines while answers can be sent; false when the client must go. */
static bool serve(struct client *client)
{
	int64_t now_ns = gr_clock_now(&gr_clock_monotonic);

	for (;;) {
		char *end;

		if (client->out_len > 0) {
			if (!send_out(client))
				return false;
			if (client->out_len > 0)
				break;
			client->since_ns = now_ns;
		}
		end = memchr(client->in, '\n', client->in_len);
		if (!end) {
			if (client->in_len == sizeof client->in || client->shut)
				return false;
			break;
		}
		size_t len = (size_t)(end - client->in);
		answer_line(client, client->in, len);
		client->in_len -= len + 1;
		memmove(client->in, end + 1, client->in_len);
		client->since_ns = now_ns;
	}
	/* No further request is read before the answer is taken. */
	loop_modify(client->control->loop, client->fd, client->out_len > 0 ? EPOLLOUT : EPOLLIN);
	return true;
}

static void client_event(void *ctx, uint32_t events)
{
	struct client *client = ctx;

	if (events & EPOLLIN) {
		ssize_t n = recv(client->fd, client->in + client->in_len,
				 sizeof client->in - client->in_len, MSG_DONTWAIT);
		if (n == 0)
			client->shut = true;
		else if (n < 0 && errno != EINTR && errno != EAGAIN)
			client->shut = true;
		else if (n > 0) {
			if (client->in_len == 0)
				client->since_ns = gr_clock_now(&gr_clock_monotonic);
			client->in_len += (size_t)n;
		}
	} else if (events & (EPOLLHUP | EPOLLERR)) {
		drop(client);
		return;
	}
	if (!serve(client))
		drop(client);
}

static void drop_slow(void *ctx, int64_t now_ns)
{
	struct control *control = ctx;
	bool any = false;

	for (int i = 0; i < CONTROL_CLIENTS; i++) {
		struct client *client = &control->clients[i];
		if (client->fd < 0)
			continue;
		bool waited_for = client->out_len > 0 || client->in_len > 0;
		if (now_ns - client->since_ns > (waited_for ? CONTROL_SLOW_NS : CONTROL_IDLE_NS)) {
			gr_info("control: dropped a client that was too slow");
			drop(client);
		} else {
			any = true;
		}
	}
	loop_timer_set(control->loop, control->timer, any ? now_ns + GR_NS_PER_S : LOOP_NEVER);
}

static void accept_client(void *ctx, uint32_t events)
{
	struct control *control = ctx;
	struct client *client = NULL;
	int fd = accept4(control->fd, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);

	(void)events;
	if (fd < 0)
		return;
	for (int i = 0; i < CONTROL_CLIENTS && !client; i++)
		if (control->clients[i].fd < 0)
			client = &control->clients[i];
	if (!client || loop_add(control->loop, fd, EPOLLIN, client_event, client) < 0) {
		static const char full[] = "{\"ok\":false,\"error\":\"too many clients\"}\n";
		send(fd, full, sizeof full - 1, MSG_NOSIGNAL | MSG_DONTWAIT);
		close(fd);
		return;
	}
	client->control = control;
	client->fd = fd;
	client->in_len = client->out_len = client->out_at = 0;
	client->shut = false;
	client->since_ns = gr_clock_now(&gr_clock_monotonic);
	loop_timer_set(control->loop, control->timer, client->since_ns + GR_NS_PER_S);
}

/* Whether the path may be bound: free, or the leftover of a master that is gone. */
static int clear_path(const char *path, const struct sockaddr_un *address)
{
	struct stat st;
	int fd, r = GR_OK;

	if (lstat(path, &st) < 0)
		return GR_OK;
	if (!S_ISSOCK(st.st_mode)) {
		gr_error("control socket %s: is a file of another kind; remove it or choose another path", path);
		return GR_ERR_CONFIG;
	}
	fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (fd < 0)
		return GR_ERR_IO;
	if (connect(fd, (const struct sockaddr *)address, sizeof *address) == 0 || errno == EAGAIN) {
		gr_error("control socket %s: another master listens there", path);
		r = GR_ERR_STATE;
	} else {
		unlink(path);
	}
	close(fd);
	return r;
}

static int open_listener(struct control *control, const char *path)
{
	struct sockaddr_un address = { .sun_family = AF_UNIX };
	mode_t before;
	int r;

	if (strlen(path) >= sizeof address.sun_path) {
		gr_error("control socket %s: the path is too long, at most %zu bytes", path,
			 sizeof address.sun_path - 1);
		return GR_ERR_CONFIG;
	}
	strcpy(address.sun_path, path);
	r = clear_path(path, &address);
	if (r < 0)
		return r;
	control->fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (control->fd < 0)
		return GR_ERR_IO;
	/* The mode must be right from the first moment, so umask and not chmod. */
	before = umask(0117);
	r = bind(control->fd, (const struct sockaddr *)&address, sizeof address);
	umask(before);
	if (r < 0 || listen(control->fd, CONTROL_CLIENTS) < 0) {
		gr_error("control socket %s: %s; --control PATH chooses another, --control none does without",
			 path, strerror(errno));
		return GR_ERR_IO;
	}
	strcpy(control->path, path);
	return GR_OK;
}

int control_create(struct control **out, struct loop *loop, const char *path,
		   control_answer_fn answer, void *ctx)
{
	struct control *control = calloc(1, sizeof *control);
	int r;

	*out = NULL;
	if (!control)
		return GR_ERR_NOMEM;
	control->loop = loop;
	control->answer = answer;
	control->ctx = ctx;
	control->fd = -1;
	for (int i = 0; i < CONTROL_CLIENTS; i++)
		control->clients[i].fd = -1;
	r = control->timer = loop_timer_create(loop, drop_slow, control);
	if (r >= 0)
		r = open_listener(control, path);
	if (r >= 0)
		r = loop_add(loop, control->fd, EPOLLIN, accept_client, control);
	if (r < 0)
		control_destroy(&control);
	*out = control;
	return r < 0 ? r : GR_OK;
}

void control_destroy(struct control **control)
{
	struct control *c = *control;

	if (!c)
		return;
	for (int i = 0; i < CONTROL_CLIENTS; i++)
		if (c->clients[i].fd >= 0)
			drop(&c->clients[i]);
	if (c->fd >= 0) {
		loop_remove(c->loop, c->fd);
		close(c->fd);
	}
	if (c->timer >= 0)
		loop_timer_set(c->loop, c->timer, LOOP_NEVER);
	if (c->path[0])
		unlink(c->path);
	free(c);
	*control = NULL;
}

int control_clients(const struct control *control)
{
	int n = 0;

	for (int i = 0; i < CONTROL_CLIENTS; i++)
		n += control->clients[i].fd >= 0;
	return n;
}
