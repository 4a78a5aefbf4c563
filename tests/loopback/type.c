/*
 * type WINDOW down|up|tap KEY, type WINDOW point X Y (0..1 across the window), type WINDOW
 * button down|up N: as a person would in the window of that name, on the display of DISPLAY.
 */
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static Window find(Display *display, Window at, const char *name)
{
	Window root, parent, *children = NULL, found = 0;
	unsigned count = 0;
	char *is = NULL;

	if (XFetchName(display, at, &is) && is) {
		if (!strcmp(is, name))
			found = at;
		XFree(is);
	}
	if (found || !XQueryTree(display, at, &root, &parent, &children, &count))
		return found;
	for (unsigned i = 0; i < count && !found; i++)
		found = find(display, children[i], name);
	XFree(children);
	return found;
}

/* Rises from call to call, as an X server's time does. */
static Time now(void)
{
	struct timespec ts;

	clock_gettime(CLOCK_MONOTONIC, &ts);
	return (Time)(ts.tv_sec * 1000 + ts.tv_nsec / 1000000);
}

static void send(Display *display, Window window, int type, unsigned code)
{
	const long mask = type == KeyPress ? KeyPressMask : type == KeyRelease ? KeyReleaseMask :
			  type == ButtonPress ? ButtonPressMask : ButtonReleaseMask;
	XEvent event = { .type = type };

	if (type == KeyPress || type == KeyRelease) {
		event.xkey = (XKeyEvent){ .type = type, .display = display, .window = window,
					  .root = DefaultRootWindow(display), .time = now(), .keycode = code,
					  .same_screen = True };
	} else {
		event.xbutton = (XButtonEvent){ .type = type, .display = display, .window = window,
						.root = DefaultRootWindow(display), .time = now(),
						.button = code, .same_screen = True };
	}
	XSendEvent(display, window, True, mask, &event);
	XFlush(display);
}

static int act(Display *display, Window window, int count, char **words)
{
	XWindowAttributes attributes;
	KeySym key;
	unsigned code;

	if (count == 3 && !strcmp(words[0], "point")) {
		XGetWindowAttributes(display, window, &attributes);
		XWarpPointer(display, None, window, 0, 0, 0, 0, (int)(strtod(words[1], NULL) * attributes.width),
			     (int)(strtod(words[2], NULL) * attributes.height));
		return 0;
	}
	if (count == 3 && !strcmp(words[0], "button")) {
		send(display, window, strcmp(words[1], "down") ? ButtonRelease : ButtonPress,
		     (unsigned)strtoul(words[2], NULL, 10));
		return 0;
	}
	key = count == 2 ? XStringToKeysym(words[1]) : NoSymbol;
	code = key != NoSymbol ? XKeysymToKeycode(display, key) : 0;
	if (!code)
		return 2;
	if (strcmp(words[0], "up"))
		send(display, window, KeyPress, code);
	if (!strcmp(words[0], "tap"))
		nanosleep(&(struct timespec){ .tv_nsec = 30000000 }, NULL);
	if (strcmp(words[0], "down"))
		send(display, window, KeyRelease, code);
	return 0;
}

int main(int argc, char **argv)
{
	Display *display = XOpenDisplay(NULL);
	Window window = display && argc > 2 ? find(display, DefaultRootWindow(display), argv[1]) : 0;
	int status = 1;

	if (!window) {
		fprintf(stderr, "type: no window \"%s\"\n", argc > 1 ? argv[1] : "");
	} else {
		status = act(display, window, argc - 2, argv + 2);
		XSync(display, False);
	}
	if (display)
		XCloseDisplay(display);
	return status;
}
