/*
 * The reference against closed forms (reference/analytic/analytic.csv): within
 * three standard errors, and those under 0.2 %.
 */
#include "tests/accuracy/closed.h"

static const struct reference_params params = { .seed = 1, .samples = 8192, .max_bounces = 64 };

static struct scene_material material(float reflectance, float emission)
{
	struct scene_material m = { .diffuse_image = -1, .emission_image = -1 };

	for (int c = 0; c < 3; c++) {
		m.diffuse[c] = reflectance;
		m.emission[c] = emission;
	}
	return m;
}

/* Every surface emits 1 and reflects rho: radiance after k bounces is what k - 1 further ones leave. */
static void enclosure(void **state)
{
	const double eye[3] = { 0.1, -0.2, 0.3 }, direction[3] = { 0.36, 0.48, 0.8 };
	const double floor[3] = { 0.2, -1, -0.4 }, up[3] = { 0, 1, 0 };
	struct tally tally = { .name = "closed enclosure" };
	FILE *f = closed_open();
	struct quad quads[6];
	char line[1024];

	(void)state;
	closed_cube(quads, 0, 1);
	while (fgets(line, sizeof(line), f)) {
		struct reference_params p = params;
		struct scene_material m;
		struct closed c;
		double rho, want, got, error;
		int k = -1;

		if (sscanf(line, "furnace,\"closed%*[^\"]\",rho=%lf,%lf", &rho, &want) != 2 &&
		    sscanf(line, "furnace,\"same%*[^\"]\",rho=%lf;k=%d,%lf", &rho, &k, &want) != 3)
			continue;
		m = material((float)rho, 1);
		closed_start(&c, quads, 6, &m, 1);
		p.seed = (uint64_t)(100 * rho) + (uint64_t)(k + 1) * 1000;
		/* longer paths are noisier */
		p.samples = (int)(12288 * fmax(1, 3 * rho * rho / (1 - rho)));
		if (k >= 0)
			p.samples = 12288 * (1 + k / 2);
		p.max_bounces = k < 0 ? 1024 : k;
		closed_point(&c, &p, floor, up, &got, &error);
		tally_add(&tally, got / PI, error / PI, want);
		if (k > 0) {
			p.max_bounces = k - 1;
			p.seed += 100000;
			closed_look(&c, &p, eye, direction, &got, &error);
			tally_add(&tally, got, error, want);
		}
		closed_end(&c);
	}
	fclose(f);
	tally_end(&tally);
}

/* A box in a black enclosure that emits 1: radiance rho from every side. */
static void convex(void **state)
{
	const double eye[3] = { 0.1, 3, 0.2 }, down[3] = { 0, -1, 0 };
	struct reference_params p = params;
	struct tally tally = { .name = "convex object in uniform light" };
	FILE *f = closed_open();
	struct quad quads[7];
	char line[1024];

	(void)state;
	closed_cube(quads, 0, 5);
	quads[6] = (struct quad){ 1, { { -1, 0, 1 }, { 1, 0, 1 }, { 1, 0, -1 }, { -1, 0, -1 } } };
	while (fgets(line, sizeof(line), f)) {
		struct scene_material m[2] = { material(0, 1) };
		struct closed c;
		double rho, want, got, error;

		if (sscanf(line, "furnace,convex%*[^,],rho=%lf,%lf", &rho, &want) != 2)
			continue;
		m[1] = material((float)rho, 0);
		closed_start(&c, quads, 7, m, 2);
		p.seed++;
		p.samples = 1 << 14;
		closed_look(&c, &p, eye, down, &got, &error);
		tally_add(&tally, got, error, want);
		closed_end(&c);
	}
	fclose(f);
	tally_end(&tally);
}

/* --- form factors: mean irradiance of one surface under the other, which emits 1/pi --- */

/*
 * place: a point of the receiver for two numbers in [0, 1), evenly by area.
 * Means of independent jittered grids give the standard error.
 */
static void mean_irradiance(struct closed *c, void (*place)(const double *size, double u, double v,
							    float out[3]),
			    const double *size, const float normal[3], double *out, double *out_error)
{
	enum { SIDE = 16, GRIDS = 32, POINTS = SIDE * SIDE };
	static struct reference_point points[POINTS];
	struct unit_random random = { 12345 };
	double sum = 0, squares = 0;

	for (int g = 0; g < GRIDS; g++) {
		struct reference_params p = { .seed = (uint64_t)g, .samples = 32 };
		double mean = 0;

		for (int i = 0; i < POINTS; i++) {
			place(size, (i % SIDE + unit_random_range(&random, 0, 1)) / SIDE,
			      (i / SIDE + unit_random_range(&random, 0, 1)) / SIDE,
			      points[i].position);
			memcpy(points[i].normal, normal, sizeof(points[i].normal));
		}
		assert_int_equal(reference_irradiance(c->reference, &p, points, POINTS, NULL), GR_OK);
		for (int i = 0; i < POINTS; i++)
			mean += points[i].total[1] / POINTS;
		sum += mean;
		squares += mean * mean;
	}
	*out = sum / GRIDS;
	*out_error = sqrt(fmax(squares / GRIDS - *out * *out, 0) / (GRIDS - 1));
}

static void on_rectangle(const double *size, double u, double v, float out[3])
{
	out[0] = (float)(u * size[0]);
	out[1] = 0;
	out[2] = (float)(v * size[1]);
}

static const float up[3] = { 0, 1, 0 };

/* Over [0, a] x [0, b] at a height, looking down. */
static double opposed(double a, double b, double height, double *error)
{
	const struct scene_material lamp = material(0, (float)(1 / PI));
	struct quad quad = { 0, { { 0 } } };
	const double size[2] = { a, b };
	struct closed c;
	double got;

	for (int k = 0; k < 4; k++) {
		quad.at[k][0] = k == 1 || k == 2 ? (float)a : 0;
		quad.at[k][1] = (float)height;
		quad.at[k][2] = k >= 2 ? (float)b : 0;
	}
	closed_start(&c, &quad, 1, &lamp, 1);
	mean_irradiance(&c, on_rectangle, size, up, &got, error);
	closed_end(&c);
	return got;
}

/* w x l on the floor sees l x h, upright along their common edge. */
static double perpendicular(double w, double l, double h, double *error)
{
	const struct scene_material lamp = material(0, (float)(1 / PI));
	struct quad quad = { 0, { { 0, 0, 0 }, { 0, (float)h, 0 }, { 0, (float)h, (float)l },
				  { 0, 0, (float)l } } };
	const double size[2] = { w, l };
	struct closed c;
	double got;

	/* its front is +x */
	closed_start(&c, &quad, 1, &lamp, 1);
	mean_irradiance(&c, on_rectangle, size, up, &got, error);
	closed_end(&c);
	return got;
}

static void on_disk(const double *size, double u, double v, float out[3])
{
	double r = size[0] * sqrt(u), phi = 2 * PI * v;

	out[0] = (float)(r * cos(phi));
	out[1] = 0;
	out[2] = (float)(r * sin(phi));
}

/* A disk of quads at a height, looking down; its area is that of the circle. */
static void disk(struct closed *c, double radius, double height)
{
	enum { QUADS = 256 };
	const struct scene_material lamp = material(0, (float)(1 / PI));
	struct quad quads[QUADS];
	double step = PI / QUADS, out = radius * sqrt(step / sin(step));

	for (int q = 0; q < QUADS; q++) {
		quads[q] = (struct quad){ 0 };
		for (int k = 0; k < 4; k++)
			quads[q].at[k][1] = (float)height;
		for (int k = 1; k < 4; k++) {
			double phi = step * (2 * q + k - 1);

			quads[q].at[k][0] = (float)(out * cos(phi));
			quads[q].at[k][2] = (float)(out * sin(phi));
		}
	}
	closed_start(c, quads, QUADS, &lamp, 1);
}

static void form_factors(void **state)
{
	struct tally tally = { .name = "form factors" };
	const double origin[3] = { 0, 0, 0 }, upright[3] = { 0, 1, 0 };
	FILE *f = closed_open();
	char line[1024];

	(void)state;
	while (fgets(line, sizeof(line), f)) {
		double a, b, d, want, got, error;
		struct closed c;

		if (sscanf(line, "form factor,\"parallel, directly opposed equal squares side 1\",distance=%lf,%lf",
			   &d, &want) == 2) {
			got = opposed(1, 1, d, &error);
		} else if (sscanf(line, "form factor,\"parallel, directly opposed equal rectangles a x b\",a=%lf;b=%lf;distance=%lf,%lf",
				  &a, &b, &d, &want) == 4) {
			got = opposed(a, b, d, &error);
		} else if (sscanf(line, "form factor,perpendicular%*[^,],w=%lf;l=%lf;h=%lf,%lf", &a, &b,
				  &d, &want) == 4) {
			got = perpendicular(a, b, d, &error);
		} else if (sscanf(line, "form factor,coaxial parallel disks r1 to r2,r1=%lf;r2=%lf;h=%lf,%lf",
				  &a, &b, &d, &want) == 4) {
			disk(&c, b, d);
			mean_irradiance(&c, on_disk, &a, up, &got, &error);
			closed_end(&c);
		} else if (sscanf(line, "form factor,differential area to parallel coaxial disk,r=%lf;h=%lf,%lf",
				  &a, &d, &want) == 3) {
			disk(&c, a, d);
			closed_point(&c, &params, origin, upright, &got, &error);
			closed_end(&c);
		} else {
			continue;
		}
		tally_add(&tally, got, error, want);
	}
	fclose(f);
	tally_end(&tally);
}

static void point_light(void **state)
{
	static const struct quad plane = {
		0, { { -20, 0, 20 }, { 20, 0, 20 }, { 20, 0, -20 }, { -20, 0, -20 } }
	};
	const struct reference_params few = { .seed = 1, .samples = 32, .max_bounces = 0 };
	const double down[3] = { 0, -1, 0 };
	struct tally tally = { .name = "point light over a plane" };
	FILE *f = closed_open();
	char line[1024];

	(void)state;
	while (fgets(line, sizeof(line), f)) {
		double intensity, h, rho, d, want, got, error;
		struct scene_material grey;
		struct closed c;

		if (sscanf(line, "point light over plane,%*[^,],I=%lf;h=%lf;rho=%lf;d=%lf,%lf",
			   &intensity, &h, &rho, &d, &want) != 5)
			continue;
		grey = material((float)rho, 0);
		closed_start(&c, &plane, 1, &grey, 1);
		c.lamp = (struct scene_lamp){ .kind = SCENE_LAMP_POINT, .on = true,
					      .direction = { 0, -1, 0 } };
		c.lamp.position[1] = (float)h;
		for (int i = 0; i < 3; i++)
			c.lamp.intensity[i] = (float)intensity;
		c.file.lamps = &c.lamp;
		c.file.lamp_count = 1;
		render_frame_init(&c.frame, &c.file);
		closed_again(&c);
		closed_look(&c, &few, (const double[3]){ d, 1, 0 }, down, &got, &error);
		tally_add(&tally, got, error, want);
		closed_end(&c);
	}
	fclose(f);
	tally_end(&tally);
}

static void rectangle_lamp(void **state)
{
	struct reference_params lamp_params = params;
	struct tally tally = { .name = "rectangle lamp" };
	const struct scene_material lamp = material(0, 1);
	struct quad quad = { 0 };
	FILE *f = closed_open();
	struct closed c;
	char line[1024];

	(void)state;
	for (size_t i = 0; i < CORNELL_QUADS; i++)
		if (cornell_quads[i].material == CORNELL_LIGHT)
			memcpy(quad.at, cornell_quads[i].at, sizeof(quad.at));
	closed_start(&c, &quad, 1, &lamp, 1);
	while (fgets(line, sizeof(line), f)) {
		double p[3], n[3], want, got, error;
		const char *at = strstr(line, "point=("), *value = strstr(line, ")]\",");

		if (strncmp(line, "rectangle light", 15) != 0 || !at || !value ||
		    sscanf(at, "point=(%lf, %lf, %lf);normal=(%lf, %lf, %lf)", &p[0], &p[1], &p[2],
			   &n[0], &n[1], &n[2]) != 6 ||
		    sscanf(value, ")]\",%lf", &want) != 1)
			continue;
		lamp_params.seed++;
		lamp_params.samples = 1 << 13;
		closed_point(&c, &lamp_params, p, n, &got, &error);
		tally_add(&tally, got, error, want);
	}
	fclose(f);
	closed_end(&c);
	tally_end(&tally);
}

/* Two planes, 1 m apart and 2 km wide; one emits an exitance of 1. */
static void infinite_planes(void **state)
{
	static const struct quad quads[2] = {
		{ 0, { { -1e3f, 0, 1e3f }, { 1e3f, 0, 1e3f }, { 1e3f, 0, -1e3f }, { -1e3f, 0, -1e3f } } },
		{ 1, { { -1e3f, 1, -1e3f }, { 1e3f, 1, -1e3f }, { 1e3f, 1, 1e3f }, { -1e3f, 1, 1e3f } } },
	};
	const double eye[3] = { 0.3, 0.5, 0.2 };
	struct tally tally = { .name = "two infinite planes" };
	FILE *f = closed_open();
	char line[1024];

	(void)state;
	while (fgets(line, sizeof(line), f)) {
		struct reference_params p = params;
		struct scene_material m[2];
		struct closed c;
		double rho[2], want, got, error;
		int plane = 0, k = -1;

		if (sscanf(line, "two infinite planes,radiosity of plane 1 after%*[^,],rho1=%lf;rho2=%lf;k=%d,%lf",
			   &rho[0], &rho[1], &k, &want) != 4 &&
		    sscanf(line, "two infinite planes,radiosity of plane %d %*[^,],rho1=%lf;rho2=%lf,%lf",
			   &plane, &rho[0], &rho[1], &want) != 4)
			continue;
		m[0] = material((float)rho[0], (float)(1 / PI));
		m[1] = material((float)rho[1], 0);
		closed_start(&c, quads, 2, m, 2);
		p.seed = (uint64_t)tally.count + 1;
		p.samples = rho[0] > 0.8 && rho[1] > 0.8 ? 1 << 17 : 1 << 16;
		p.max_bounces = k > 0 ? k - 1 : 1024;
		closed_look(&c, &p, eye, (const double[3]){ 0, plane == 2 ? 1 : -1, 0 }, &got, &error);
		tally_add(&tally, PI * got, PI * error, want);
		closed_end(&c);
	}
	fclose(f);
	tally_end(&tally);
}

/* A conductor in uniform radiance 1 sends its directional albedo back. */
static void ggx_albedo(void **state)
{
	struct tally tally = { .name = "GGX directional albedo" };
	FILE *f = closed_open();
	struct quad quads[7];
	char line[1024];

	(void)state;
	closed_cube(quads, 0, 5);
	quads[6] = (struct quad){ 1, { { -1, 0, 1 }, { 1, 0, 1 }, { 1, 0, -1 }, { -1, 0, -1 } } };
	while (fgets(line, sizeof(line), f)) {
		struct scene_material m[2] = { material(0, 1) };
		const struct reference_params p = { .seed = (uint64_t)tally.count + 100,
						    .samples = 1 << 14 };
		double alpha, cosine, want, got, error, sine;
		struct closed c;

		if (sscanf(line, "GGX,\"directional albedo, F=1, separable%*[^\"]\",alpha=%lf;cos=%lf,%lf",
			   &alpha, &cosine, &want) != 3)
			continue;
		sine = sqrt(1 - cosine * cosine);
		m[1] = material(0, 0);
		m[1].kind = MATERIAL_CONDUCTOR;
		m[1].alpha = (float)alpha;
		for (int i = 0; i < 3; i++)
			m[1].specular[i] = 1;
		closed_start(&c, quads, 7, m, 2);
		closed_look(&c, &p, (const double[3]){ sine, cosine, 0 },
			    (const double[3]){ -sine, -cosine, 0 }, &got, &error);
		tally_add(&tally, got, error, want);
		closed_end(&c);
	}
	fclose(f);
	tally_end(&tally);
}

enum { SPHERE_ROUND = 256, SPHERE_HIGH = 128, SPHERE_QUADS = SPHERE_ROUND * SPHERE_HIGH };

static void sphere_point(double radius, double height, int i, int j, float out[3])
{
	double phi = 2 * PI * i / SPHERE_ROUND, theta = PI * j / SPHERE_HIGH;

	out[0] = (float)(radius * sin(theta) * cos(phi));
	out[1] = (float)(height - radius * cos(theta));
	out[2] = (float)(radius * sin(theta) * sin(phi));
}

/* A black sphere hides a share of the sky from a point of the plane below. */
static void sphere_over_plane(void **state)
{
	static struct quad quads[SPHERE_QUADS];
	struct tally tally = { .name = "sphere over a plane under a sky" };
	const double upright[3] = { 0, 1, 0 };
	const struct scene_material black = material(0, 0);
	FILE *f = closed_open();
	char line[1024];

	(void)state;
	while (fgets(line, sizeof(line), f)) {
		struct reference_params p = params;
		double r, h, d, want, got, error, covered;
		struct closed c;

		if (sscanf(line, "sphere over plane,\"plane irradiance%*[^\"]\",r=%lf;h=%lf;d=%lf,%lf", &r,
			   &h, &d, &want) != 4)
			continue;
		/* as large as makes the mean silhouette that of a sphere */
		covered = r * (1 + PI * PI / 6 * (0.5 / (SPHERE_ROUND * SPHERE_ROUND) +
						  0.5 / (4.0 * SPHERE_HIGH * SPHERE_HIGH)));
		for (int i = 0; i < SPHERE_ROUND; i++) {
			for (int j = 0; j < SPHERE_HIGH; j++) {
				struct quad *q = &quads[i * SPHERE_HIGH + j];

				q->material = 0;
				sphere_point(covered, h, i, j, q->at[0]);
				sphere_point(covered, h, i, j + 1, q->at[1]);
				sphere_point(covered, h, i + 1, j + 1, q->at[2]);
				sphere_point(covered, h, i + 1, j, q->at[3]);
			}
		}
		closed_start(&c, quads, SPHERE_QUADS, &black, 1);
		closed_sky(&c, 1);
		p.seed = (uint64_t)tally.count + 1;
		p.samples = 1 << 14;
		closed_point(&c, &p, (const double[3]){ d, 0, 0 }, upright, &got, &error);
		tally_add(&tally, got, error, want);
		closed_end(&c);
	}
	fclose(f);
	tally_end(&tally);
}

/*
 * A closed box that emits 1 inside, and 1e9 outside: not one path comes in, and
 * least of all where two walls meet and rounding decides on which side a point is.
 */
static void nothing_comes_in(void **state)
{
	const struct reference_params p = { .seed = 3, .samples = 2048, .max_bounces = 8 };
	static const float edge[3] = { 1.37f, -1.37f, 0.21f };
	struct reference_view view = { .eye = { 0.1f, 0.2f, 0.3f }, .right = { 0, 0, 0.2f },
				       .down = { 2e-6f, 2e-6f, 0 }, .width = 8, .height = 8 };
	const struct scene_material m = { .name = "wall", .diffuse = { 0.5f, 0.5f, 0.5f },
					  .emission = { 1, 1, 1 }, .diffuse_image = -1,
					  .emission_image = -1 };
	struct reference_film film = { 0 };
	struct quad quads[6];
	struct image mean;
	double most = 0, least = INFINITY;
	struct closed c;

	(void)state;
	closed_cube(quads, 0, 1.37f);
	closed_start(&c, quads, 6, &m, 1);
	closed_sky(&c, 1e9f);
	for (int i = 0; i < 3; i++)
		view.corner[i] = edge[i] - view.eye[i] - 0.5f * (view.right[i] + view.down[i]);
	assert_int_equal(reference_render(c.reference, &view, &p, &film), GR_OK);
	assert_int_equal(film.nonfinite, 0);
	assert_int_equal(reference_film_images(&film, &mean, NULL, NULL), GR_OK);
	for (int k = 0; k < 3 * 64; k++) {
		most = fmax(most, (double)mean.data[k]);
		least = fmin(least, (double)mean.data[k]);
	}
	printf("# closed, 1 inside and 1e9 outside, seen at an edge: %.4f to %.4f (in all 2)\n", least, most);
	assert_true(most < 2.01 && least > 1.9);
	image_finish(&mean);
	reference_film_finish(&film);
	closed_end(&c);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(enclosure),
		cmocka_unit_test(convex),
		cmocka_unit_test(form_factors),
		cmocka_unit_test(sphere_over_plane),
		cmocka_unit_test(point_light),
		cmocka_unit_test(rectangle_lamp),
		cmocka_unit_test(infinite_planes),
		cmocka_unit_test(ggx_albedo),
		cmocka_unit_test(nothing_comes_in),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
