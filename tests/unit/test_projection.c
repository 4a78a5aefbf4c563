/* Off-axis projection: corner rays, refusals, and the reference frusta. */
#include "base/result.h"
#include "renderer/view/projection.h"
#include "tests/unit/shared.h"
#include "tests/unit/unit.h"

#include <math.h>

#define HEADS 10000

struct frame3 {
	double right[3], up[3], normal[3];
};

static void random_frame(struct unit_random *rng, struct frame3 *f)
{
	versor q;
	mat4 m;

	do {
		for (int i = 0; i < 4; i++)
			q[i] = (float)unit_random_range(rng, -1, 1);
	} while (glm_quat_norm(q) < 0.1f || glm_quat_norm(q) > 1.0f);
	glm_quat_normalize(q);
	glm_quat_mat4(q, m);
	for (int i = 0; i < 3; i++) {
		f->right[i] = m[0][i];
		f->up[i] = m[1][i];
		f->normal[i] = m[2][i];
	}
}

static void point_on(const struct frame3 *f, const double origin[3], double x, double y, double z,
		     vec3 out)
{
	for (int i = 0; i < 3; i++)
		out[i] = (float)(origin[i] + x * f->right[i] + y * f->up[i] + z * f->normal[i]);
}

/* A wall as measured: 0.3 to 6 m, anywhere within 10 m, any way round. */
static void random_wall(struct unit_random *rng, struct frame3 *f, double origin[3],
			double size[2], struct projection_wall *wall)
{
	random_frame(rng, f);
	for (int i = 0; i < 3; i++)
		origin[i] = unit_random_range(rng, -5, 5);
	size[0] = unit_random_range(rng, 0.3, 6);
	size[1] = unit_random_range(rng, 0.3, 4);
	point_on(f, origin, 0, 0, 0, wall->lower_left);
	point_on(f, origin, size[0], 0, 0, wall->lower_right);
	point_on(f, origin, 0, size[1], 0, wall->upper_left);
}

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void corner(const struct projection_wall *wall, int which, double out[3])
{
	for (int i = 0; i < 3; i++) {
		out[i] = wall->lower_left[i];
		if (which & 1)
			out[i] += (double)wall->lower_right[i] - wall->lower_left[i];
		if (which & 2)
			out[i] += (double)wall->upper_left[i] - wall->lower_left[i];
	}
}

/* Distance from the wall's corner to where the ray of the picture's corner meets the wall. */
static double corner_miss(const struct projection_wall *wall, const vec3 eye, const double ray[3],
			  int which)
{
	double a[3], b[3], n[3], to[3], want[3], miss = 0, t;

	for (int i = 0; i < 3; i++) {
		a[i] = (double)wall->lower_right[i] - wall->lower_left[i];
		b[i] = (double)wall->upper_left[i] - wall->lower_left[i];
		to[i] = (double)wall->lower_left[i] - eye[i];
	}
	n[0] = a[1] * b[2] - a[2] * b[1];
	n[1] = a[2] * b[0] - a[0] * b[2];
	n[2] = a[0] * b[1] - a[1] * b[0];
	t = dot(n, to) / dot(n, ray);
	corner(wall, which, want);
	for (int i = 0; i < 3; i++)
		miss += pow(eye[i] + t * ray[i] - want[i], 2);
	return sqrt(miss);
}

static double worst_miss(const struct projection_wall *wall, const vec3 eye,
			 const struct projection *p)
{
	double worst = 0;

	for (int which = 0; which < 4; which++) {
		double x = which & 1 ? p->r : p->l, y = which & 2 ? p->t : p->b, ray[3];

		for (int i = 0; i < 3; i++)
			ray[i] = x * p->right[i] + y * p->up[i] - p->near_m * p->back[i];
		worst = fmax(worst, corner_miss(wall, eye, ray, which));
	}
	return worst;
}

/* The same from the float matrices: metres on the wall that a corner lands off the picture's. */
static double matrix_miss(const struct projection_wall *wall, const double size[2],
			  struct projection *p)
{
	double worst = 0;

	for (int which = 0; which < 4; which++) {
		double c[3], clip[4];

		corner(wall, which, c);
		for (int row = 0; row < 4; row++)
			clip[row] = p->view_projection[0][row] * c[0] +
				    p->view_projection[1][row] * c[1] +
				    p->view_projection[2][row] * c[2] + p->view_projection[3][row];
		worst = fmax(worst, hypot((clip[0] / clip[3] - (which & 1 ? 1 : -1)) * size[0] / 2,
					  (clip[1] / clip[3] - (which & 2 ? 1 : -1)) * size[1] / 2));
	}
	return worst;
}

static bool matrices_finite(struct projection *p)
{
	for (int col = 0; col < 4; col++)
		for (int row = 0; row < 4; row++)
			if (!isfinite(p->view[col][row]) || !isfinite(p->projection[col][row]) ||
			    !isfinite(p->view_projection[col][row]))
				return false;
	return true;
}

static void corner_rays(void **state)
{
	struct unit_random rng = unit_random_start("corner_rays");
	double worst = 0, worst_near = 0, worst_matrix = 0, worst_matrix_near = 0;

	(void)state;
	for (int k = 0; k < HEADS; k++) {
		struct frame3 f;
		struct projection_wall wall;
		struct projection p;
		double origin[3], size[2];
		bool close = k % 10 == 0;
		double away = close ? 1e-3 : unit_random_range(&rng, 0.1, 4);
		vec3 eye;

		random_wall(&rng, &f, origin, size, &wall);
		point_on(&f, origin, unit_random_range(&rng, -1, size[0] + 1),
			 unit_random_range(&rng, -1, size[1] + 1), away, eye);
		assert_int_equal(projection_off_axis(&wall, eye, 0.05f, 100, &p), GR_OK);
		assert_true(matrices_finite(&p));
		if (close) {
			worst_near = fmax(worst_near, worst_miss(&wall, eye, &p));
			worst_matrix_near = fmax(worst_matrix_near, matrix_miss(&wall, size, &p));
		} else {
			worst = fmax(worst, worst_miss(&wall, eye, &p));
			worst_matrix = fmax(worst_matrix, matrix_miss(&wall, size, &p));
		}
	}
	printf("# corner rays, worst miss: %.2g m (0.1..4 m off the wall), %.2g m (1 mm off)\n",
	       worst, worst_near);
	printf("# float matrices: %.2g m (0.1..4 m), %.2g m (1 mm)\n", worst_matrix,
	       worst_matrix_near);
	/* The corners are floats, so the wall is a rectangle to 1e-6 only. */
	assert_true(worst < 1e-5);
	assert_true(worst_near < 1e-5);
	assert_true(worst_matrix < 2e-5);
	assert_true(worst_matrix_near < 1e-2);
}

static void refused_behind(void **state)
{
	struct unit_random rng = unit_random_start("refused_behind");

	(void)state;
	for (int k = 0; k < HEADS; k++) {
		struct frame3 f;
		struct projection_wall wall;
		struct projection p, before;
		double origin[3], size[2];
		double away = k % 4 == 0 ? -1e-3 : k % 4 == 1 ? 5e-5 : -unit_random_range(&rng, 0, 5);
		vec3 eye;

		memset(&p, 0x5a, sizeof(p));
		before = p;
		random_wall(&rng, &f, origin, size, &wall);
		point_on(&f, origin, unit_random_range(&rng, -1, size[0] + 1),
			 unit_random_range(&rng, -1, size[1] + 1), away, eye);
		assert_int_equal(projection_off_axis(&wall, eye, 0.05f, 100, &p), GR_ERR_RANGE);
		assert_memory_equal(&p, &before, sizeof(p));
	}
}

static void refused_arguments(void **state)
{
	struct projection_wall wall = { { -1, 0, -1 }, { 1, 0, -1 }, { -1, 2, -1 } };
	struct projection_wall line = { { -1, 0, -1 }, { 1, 0, -1 }, { 2, 0, -1 } };
	struct projection_wall dot_wall = { { 0, 0, -1 }, { 0, 0, -1 }, { 0, 1, -1 } };
	vec3 eye = { 0, 1, 0 }, nan_eye = { 0, NAN, 0 }, inf_eye = { INFINITY, 1, 0 };
	struct projection p;

	(void)state;
	assert_int_equal(projection_off_axis(&wall, eye, 0.1f, 10, &p), GR_OK);
	assert_int_equal(projection_off_axis(&wall, nan_eye, 0.1f, 10, &p), GR_ERR_RANGE);
	assert_int_equal(projection_off_axis(&wall, inf_eye, 0.1f, 10, &p), GR_ERR_RANGE);
	assert_int_equal(projection_off_axis(&line, eye, 0.1f, 10, &p), GR_ERR_RANGE);
	assert_int_equal(projection_off_axis(&dot_wall, eye, 0.1f, 10, &p), GR_ERR_RANGE);
	assert_int_equal(projection_off_axis(&wall, eye, 0, 10, &p), GR_ERR_RANGE);
	assert_int_equal(projection_off_axis(&wall, eye, 1, 1, &p), GR_ERR_RANGE);
	assert_int_equal(projection_off_axis(&wall, eye, NAN, 1, &p), GR_ERR_RANGE);
	wall.upper_left[1] = NAN;
	assert_int_equal(projection_off_axis(&wall, eye, 0.1f, 10, &p), GR_ERR_RANGE);
}

/* A camera is the wall at distance 1 that its frustum cuts. */
static void camera_is_a_wall(void **state)
{
	vec3 position = { 1, 2, 3 }, target = { 1, 2, 2 }, up = { 0, 1, 0 }, along = { 0, 0, 1 };
	float half = tanf(0.35f);
	struct projection_wall wall = { { 1 - 2 * half, 2 - half, 2 },
					{ 1 + 2 * half, 2 - half, 2 },
					{ 1 - 2 * half, 2 + half, 2 } };
	struct projection camera, window;

	(void)state;
	assert_int_equal(projection_camera(position, target, up, 0.7f, 2, 0.1f, 50, &camera), GR_OK);
	assert_int_equal(projection_off_axis(&wall, position, 0.1f, 50, &window), GR_OK);
	for (int i = 0; i < 4; i++)
		for (int j = 0; j < 4; j++)
			assert_true(fabsf(camera.view_projection[i][j] -
					  window.view_projection[i][j]) < 2e-5f);
	assert_int_equal(projection_camera(position, target, along, 0.7f, 2, 0.1f, 50, &camera),
			 GR_ERR_RANGE);
	assert_int_equal(projection_camera(position, position, up, 0.7f, 2, 0.1f, 50, &camera),
			 GR_ERR_RANGE);
	assert_int_equal(projection_camera(position, target, up, 3.2f, 2, 0.1f, 50, &camera),
			 GR_ERR_RANGE);
}

/* Numbers of a line of cave_offaxis.csv after the wall's name, quotes and brackets dropped. */
static int numbers(const char *line, double *out, int max)
{
	int n = 0;

	line = strchr(line, ',');
	while (line && *line && n < max) {
		char *end;

		line += strspn(line, " ,()\"\r\n");
		out[n] = strtod(line, &end);
		if (end == line)
			break;
		n++;
		line = end;
	}
	return n;
}

static void reference_frusta(void **state)
{
	char path[1024], line[4096];
	double worst = 0;
	int lines = 0;
	FILE *f = NULL;

	(void)state;
	if (shared_file("reference/analytic/cave_offaxis.csv", path))
		f = fopen(path, "r");
	if (!f)
		skip();
	while (fgets(line, sizeof(line), f)) {
		double v[34];
		struct projection_wall wall;
		struct projection p;
		vec3 eye;

		if (numbers(line, v, 34) != 34)
			continue; /* the heading */
		for (int i = 0; i < 3; i++) {
			wall.lower_left[i] = (float)v[i];
			wall.lower_right[i] = (float)v[3 + i];
			wall.upper_left[i] = (float)v[6 + i];
			eye[i] = (float)v[9 + i];
		}
		assert_int_equal(projection_off_axis(&wall, eye, (float)v[12], (float)v[13], &p),
				 GR_OK);
		worst = fmax(worst, fmax(fmax(fabs(p.l - v[14]), fabs(p.r - v[15])),
					 fmax(fabs(p.b - v[16]), fabs(p.t - v[17]))));
		for (int row = 0; row < 4; row++)
			for (int col = 0; col < 4; col++)
				worst = fmax(worst, fabs(p.view_projection[col][row] -
							 v[18 + 4 * row + col]));
		lines++;
	}
	fclose(f);
	printf("# %d reference frusta, largest difference %.2g\n", lines, worst);
	assert_true(lines > 0);
	assert_true(worst < 2e-6);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(corner_rays),
		cmocka_unit_test(refused_behind),
		cmocka_unit_test(refused_arguments),
		cmocka_unit_test(camera_is_a_wall),
		cmocka_unit_test(reference_frusta),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
