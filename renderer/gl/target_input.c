/* Which key is which button of the hand; docs/interaction.md has the table. */
#include "renderer/gl/target_private.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <math.h>

static const struct {
	int key;
	uint32_t bit;
} keys[] = {
	{ GLFW_KEY_SPACE, 0 }, { GLFW_KEY_MINUS, 1 }, { GLFW_KEY_KP_SUBTRACT, 1 }, { GLFW_KEY_EQUAL, 2 },
	{ GLFW_KEY_KP_ADD, 2 }, { GLFW_KEY_TAB, 3 },  { GLFW_KEY_1, 0 },	   { GLFW_KEY_2, 1 },
	{ GLFW_KEY_3, 2 },	{ GLFW_KEY_4, 3 },    { GLFW_KEY_5, 4 },	   { GLFW_KEY_6, 5 },
	{ GLFW_KEY_7, 6 },	{ GLFW_KEY_8, 7 },    { GLFW_KEY_9, 8 },
};

static const struct {
	int button;
	uint32_t bit;
} mouse[] = { { GLFW_MOUSE_BUTTON_RIGHT, 0 }, { GLFW_MOUSE_BUTTON_LEFT, 4 } };

static float pair(GLFWwindow *window, int less, int more)
{
	return (float)(glfwGetKey(window, more) == GLFW_PRESS) - (float)(glfwGetKey(window, less) == GLFW_PRESS);
}

/* -1..1 of `size`; a pointer that has left the window stays at its edge. */
static float share(double at, int size)
{
	return size > 0 ? (float)fmin(fmax(2 * at / size - 1, -1), 1) : 0;
}

void target_input_watch(GLFWwindow *window)
{
	/* What was pressed and let go between two looks is seen once. */
	glfwSetInputMode(window, GLFW_STICKY_KEYS, GLFW_TRUE);
	glfwSetInputMode(window, GLFW_STICKY_MOUSE_BUTTONS, GLFW_TRUE);
}

void target_input_read(GLFWwindow *window, double wheel, struct target_input *out)
{
	double x, y;
	int width, height;

	*out = (struct target_input){ .wheel = (float)wheel };
	for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
		if (glfwGetKey(window, keys[i].key) == GLFW_PRESS)
			out->buttons |= 1u << keys[i].bit;
	for (size_t i = 0; i < sizeof mouse / sizeof *mouse; i++)
		if (glfwGetMouseButton(window, mouse[i].button) == GLFW_PRESS)
			out->buttons |= 1u << mouse[i].bit;
	out->axes[0] = pair(window, GLFW_KEY_LEFT, GLFW_KEY_RIGHT);
	out->axes[1] = pair(window, GLFW_KEY_DOWN, GLFW_KEY_UP);
	glfwGetCursorPos(window, &x, &y);
	glfwGetWindowSize(window, &width, &height);
	out->pointer[0] = share(x, width);
	out->pointer[1] = -share(y, height);
}
