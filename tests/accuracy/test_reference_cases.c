/*
 * The reference where no table of closed forms helps: white furnaces of every
 * material, medium, equal results for any threads and after resuming, scenes of
 * any size, and hard cases.
 */
#include "renderer/scene/brdf_table.h"
#include "renderer/view/projection.h"
#include "tests/accuracy/closed.h"
#include "tools/bench/room.h"
#include "tools/bench/truth.h"

static const double up[3] = { 0, 1, 0 };

static struct scene_material material(float reflectance, float emission)
{
	struct scene_material m = { .diffuse_image = -1, .emission_image = -1 };

	for (int c = 0; c < 3; c++) {
		m.diffuse[c] = reflectance;
		m.emission[c] = emission;
	}
	return m;
}

static const struct quad floor_quad = {
	0, { { -1, 0, 1 }, { 1, 0, 1 }, { 1, 0, -1 }, { -1, 0, -1 } }
};

/* --- white furnaces --- */

/* Radiance of a plate under a sky of 1, seen at an angle. */
static void look_at_plate(const struct scene_material *m, struct brdf_table *table, double cosine,
			  uint64_t seed, int samples, double *got, double *error)
{
	const struct reference_params p = { .seed = seed, .samples = samples };
	double sine = sqrt(1 - cosine * cosine);
	struct closed c;

	closed_start(&c, &floor_quad, 1, m, 1);
	c.scene.tables = &table;
	c.scene.table_count = table != NULL;
	closed_sky(&c, 1);
	closed_look(&c, &p, (const double[3]){ 0.6 * sine, cosine, 0.8 * sine },
		    (const double[3]){ -0.6 * sine, -cosine, -0.8 * sine }, got, error);
	closed_end(&c);
}

/* Integral over the hemisphere of a function of the incoming direction (z up), by midpoints. */
static double hemisphere(double (*f)(const void *ctx, const double l[3]), const void *ctx)
{
	enum { NZ = 1000, NPHI = 1000 };
	double sum = 0;

	for (int i = 0; i < NZ; i++) {
		for (int j = 0; j < NPHI; j++) {
			double z = (i + 0.5) / NZ, phi = 2 * PI * (j + 0.5) / NPHI;
			double r = sqrt(1 - z * z);

			sum += f(ctx, (const double[3]){ r * cos(phi), r * sin(phi), z });
		}
	}
	return sum * 2 * PI / NZ / NPHI;
}

struct phong_case {
	double shininess, cosine;
};

/* Seed 004, equation 3.2, specular 1, times the cosine. */
static double phong(const void *ctx, const double l[3])
{
	const struct phong_case *p = ctx;
	double v[3] = { sqrt(1 - p->cosine * p->cosine), 0, p->cosine };
	double h[3] = { v[0] + l[0], v[1] + l[1], v[2] + l[2] };
	double length = sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);

	return (p->shininess + 8) / (8 * PI) * pow(h[2] / length, p->shininess) * l[2];
}

static void furnace_phong(void **state)
{
	static const double shininess[] = { 0, 5, 50, 500 }, cosines[] = { 1, 0.6, 0.2 };
	struct tally tally = { .name = "furnace: Lambert and Blinn-Phong" };

	(void)state;
	for (int i = 0; i < 4; i++) {
		for (int k = 0; k < 3; k++) {
			const struct phong_case p = { shininess[i], cosines[k] };
			struct scene_material m = material(0.3f, 0);
			double got, error;

			m.shininess = (float)p.shininess;
			for (int c = 0; c < 3; c++)
				m.specular[c] = 0.5f;
			look_at_plate(&m, NULL, p.cosine, (uint64_t)tally.count + 10, 1 << 17, &got,
				      &error);
			tally_add(&tally, got, error, 0.3 + 0.5 * hemisphere(phong, &p));
		}
	}
	tally_end(&tally);
}

static void furnace_white(void **state)
{
	struct tally tally = { .name = "furnace: white Lambert, mirror" };
	struct scene_material m = material(1, 0);
	double got, error;

	(void)state;
	look_at_plate(&m, NULL, 0.4, 1, 1024, &got, &error);
	tally_add(&tally, got, error, 1);
	m = material(0, 0);
	m.kind = MATERIAL_MIRROR;
	m.specular[0] = m.specular[1] = m.specular[2] = 1;
	look_at_plate(&m, NULL, 0.4, 1, 1024, &got, &error);
	tally_add(&tally, got, error, 1);
	tally_end(&tally);
}

struct table_case {
	const struct brdf_table *table;
	float viewer[3];
};

static double measured(const void *ctx, const double l[3])
{
	const struct table_case *t = ctx;
	const float light[3] = { (float)l[0], (float)l[1], (float)l[2] };
	float f[3];

	brdf_table_evaluate(t->table, light, t->viewer, f);
	return (double)f[1] * l[2];
}

static void furnace_measured(void **state)
{
	static const char *const names[] = { "garnet_red", "krylon_blue", "cayman" };
	static const double cosines[] = { 0.9, 0.5, 0.25 };
	struct tally tally = { .name = "furnace: measured tables" };

	(void)state;
	for (int i = 0; i < 3; i++) {
		char name[64], path[1024];
		struct gr_diag diag = { 0 };
		struct brdf_table *table;

		snprintf(name, sizeof(name), "reference/brdf/%s.brdf", names[i]);
		if (!shared_file(name, path))
			skip();
		assert_int_equal(brdf_table_load(&table, path, &diag), GR_OK);
		gr_diag_finish(&diag);
		for (int k = 0; k < 3; k++) {
			struct table_case t = { table, { (float)sqrt(1 - cosines[k] * cosines[k]), 0,
							 (float)cosines[k] } };
			struct scene_material m = material(0, 0);
			double got, error;

			m.kind = MATERIAL_MEASURED;
			look_at_plate(&m, table, cosines[k], (uint64_t)tally.count + 1, 1 << 17, &got,
				      &error);
			tally_add(&tally, got, error, hemisphere(measured, &t));
		}
		brdf_table_destroy(&table);
	}
	tally_end(&tally);
}

/* --- medium --- */

static void medium_takes_light(void **state)
{
	static const struct quad wall = { 0, { { -5, -5, -4 }, { 5, -5, -4 }, { 5, 5, -4 }, { -5, 5, -4 } } };
	const struct scene_material lamp = material(0, 1);
	const struct reference_params few = { .seed = 1, .samples = 32, .max_bounces = 8 };
	struct tally tally = { .name = "medium: transmittance" };
	double got, error;
	struct closed c;

	(void)state;
	closed_start(&c, &wall, 1, &lamp, 1);
	c.frame.absorption_per_m = 0.1f;
	closed_again(&c);
	/* one ray; a pixel is a spread of nothing */
	closed_look(&c, &few, (const double[3]){ 0, 0, 0 }, (const double[3]){ 0, 0, -1 }, &got, &error);
	tally_add(&tally, got, error, pow(0.9, 4));
	closed_end(&c);
	tally_end(&tally);
}

/* All that a scattering medium takes it gives back: inside of a furnace nothing shows it. */
static void medium_in_furnace(void **state)
{
	const struct reference_params p = { .seed = 5, .samples = 1 << 16, .max_bounces = 1024 };
	const struct scene_material m = material(0.5f, 1);
	struct tally tally = { .name = "medium: furnace with scattering" };
	struct quad quads[6];
	double got, error;
	struct closed c;

	(void)state;
	closed_cube(quads, 0, 1);
	closed_start(&c, quads, 6, &m, 1);
	c.frame.scattering_per_m = 0.3f;
	closed_again(&c);
	closed_look(&c, &p, (const double[3]){ 0, 0, 0 }, (const double[3]){ 0, 0, -1 }, &got, &error);
	tally_add(&tally, got, error, 2);
	closed_point(&c, &p, (const double[3]){ 0, -1, 0 }, up, &got, &error);
	tally_add(&tally, got, error, 2 * PI);
	closed_end(&c);
	tally_end(&tally);
}

/* Single scattering of a point lamp beside the ray, against its integral. */
static void medium_scatters_once(void **state)
{
	const struct reference_params p = { .seed = 6, .samples = 1 << 18, .max_bounces = 0 };
	const struct scene_material black = material(0, 0);
	const double sigma[2] = { 0.05, 0.15 }, reach = 10, aside = 1;
	struct tally tally = { .name = "medium: single scattering" };
	double want = 0, got, error, extinction = -log1p(-sigma[0] - sigma[1]);
	struct quad quads[6];
	struct closed c;

	(void)state;
	closed_cube(quads, 0, (float)reach);
	closed_start(&c, quads, 6, &black, 1);
	c.frame.absorption_per_m = (float)sigma[0];
	c.frame.scattering_per_m = (float)sigma[1];
	c.lamp = (struct scene_lamp){ .kind = SCENE_LAMP_POINT, .on = true, .direction = { 0, -1, 0 },
				      .position = { 0, 1, -2 }, .intensity = { 3, 3, 3 } };
	c.file.lamps = &c.lamp;
	c.file.lamp_count = 1;
	c.frame.lamps[0] = (struct frame_lamp){ .on = true, .direction = { 0, -1, 0 },
						.position = { 0, 1, -2 }, .intensity = { 3, 3, 3 } };
	closed_again(&c);
	closed_look(&c, &p, (const double[3]){ 0, 0, 0 }, (const double[3]){ 0, 0, -1 }, &got, &error);
	for (int i = 0; i < 100000; i++) {
		double t = (i + 0.5) * reach / 100000, r2 = aside * aside + (t - 2) * (t - 2);

		want += extinction * sigma[1] / (sigma[0] + sigma[1]) / (4 * PI) * 3 / r2 *
			exp(-extinction * (t + sqrt(r2))) * reach / 100000;
	}
	tally_add(&tally, got, error, want);
	closed_end(&c);
	tally_end(&tally);
}

/* --- equal results --- */

static void start_cornell(struct closed *c)
{
	closed_start(c, cornell_quads, CORNELL_QUADS, cornell_materials, CORNELL_MATERIALS);
}

static void cornell_view(struct reference_view *view, int side)
{
	struct scene_camera camera = { .position = { 2.78f, 2.73f, -8 }, .target = { 2.78f, 2.73f, 0 },
				       .up = { 0, 1, 0 }, .vfov_rad = 0.68f, .pixels = { side, side } };

	assert_int_equal(reference_view_camera(&camera, view), GR_OK);
}

static void render(struct closed *c, const struct reference_view *view,
		   const struct reference_params *params, struct reference_film *film)
{
	assert_int_equal(reference_render(c->reference, view, params, film), GR_OK);
	assert_int_equal(film->nonfinite, 0);
}

static void same_film(const struct reference_film *a, const struct reference_film *b)
{
	size_t bytes = 3 * (size_t)a->width * (size_t)a->height * sizeof(double);

	assert_int_equal(a->samples, b->samples);
	assert_memory_equal(a->radiance, b->radiance, bytes);
	assert_memory_equal(a->squares, b->squares, bytes);
	assert_memory_equal(a->indirect, b->indirect, bytes);
	assert_memory_equal(a->indirect_squares, b->indirect_squares, bytes);
}

static void threads_and_resuming_change_nothing(void **state)
{
	static const int threads[] = { 2, 5 };
	struct reference_params p = { .seed = 9, .samples = 96, .max_bounces = 16, .threads = 1 };
	struct reference_film one = { 0 }, parts = { 0 };
	struct reference_view view;
	struct closed c;

	(void)state;
	start_cornell(&c);
	cornell_view(&view, 24);
	render(&c, &view, &p, &one);
	for (int i = 0; i < 2; i++) {
		struct reference_film many = { 0 };

		p.threads = threads[i];
		render(&c, &view, &p, &many);
		same_film(&one, &many);
		reference_film_finish(&many);
	}
	for (p.samples = 32; p.samples <= 96; p.samples += 64) {
		struct gr_diag diag = { 0 };

		render(&c, &view, &p, &parts);
		assert_int_equal(reference_film_save(&parts, "test_reference_cases.film"), GR_OK);
		reference_film_finish(&parts);
		assert_int_equal(reference_film_load(&parts, "test_reference_cases.film", &diag), GR_OK);
	}
	remove("test_reference_cases.film");
	same_film(&one, &parts);
	/* not of another seed, another lamp, another view */
	p.seed = 10;
	assert_int_equal(reference_render(c.reference, &view, &p, &parts), GR_ERR_MISMATCH);
	p.seed = 9;
	view.eye[0] += 0.01f;
	assert_int_equal(reference_render(c.reference, &view, &p, &parts), GR_ERR_MISMATCH);
	view.eye[0] -= 0.01f;
	c.scene.materials[CORNELL_LIGHT].emission[0] += 1;
	closed_again(&c);
	assert_int_equal(reference_render(c.reference, &view, &p, &parts), GR_ERR_MISMATCH);
	same_film(&one, &parts);
	reference_film_finish(&parts);
	reference_film_finish(&one);
	closed_end(&c);
}

/* A wall that stands where a camera's picture is shows the same. */
static void walls_are_windows(void **state)
{
	const struct projection_wall wall = { { -1, 0, -2 }, { 1, 0, -2 }, { -1, 2, -2 } };
	struct scene_camera camera = { .position = { 3, 1, 7 }, .target = { 3 + 2, 1, 7 }, .up = { 0, 1, 0 },
				       .vfov_rad = 2 * atanf(0.5f), .pixels = { 8, 8 } };
	struct reference_view seen, wanted;
	const float eye[3] = { 0, 1, 0 };
	struct gr_pose room;

	(void)state;
	/* -z of the room is +x of the scene */
	gr_pose_heading((vec3){ 3, 0, 7 }, (float)(-PI / 2), &room);
	assert_int_equal(reference_view_wall(&wall, &room, eye, 8, 8, &seen), GR_OK);
	assert_int_equal(reference_view_camera(&camera, &wanted), GR_OK);
	for (int i = 0; i < 3; i++) {
		assert_float_equal(seen.eye[i], wanted.eye[i], 1e-5f);
		assert_float_equal(seen.corner[i], wanted.corner[i], 1e-5f);
		assert_float_equal(seen.right[i], wanted.right[i], 1e-5f);
		assert_float_equal(seen.down[i], wanted.down[i], 1e-5f);
	}
	assert_int_equal(reference_view_wall(&wall, &room, (const float[3]){ 0, 1, -3 }, 8, 8, &seen),
			 GR_ERR_RANGE);
}

/* --- hard cases --- */

static void cornell_points(struct reference_point points[3], float scale)
{
	static const float at[3][6] = { { 4.5f, 0, 1, 0, 1, 0 }, { 0, 2, 3, 1, 0, 0 },
					{ 3, 4, 5.592f, 0, 0, -1 } };

	memset(points, 0, 3 * sizeof(points[0]));
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 3; i++) {
			points[k].position[i] = at[k][i] * scale;
			points[k].normal[i] = at[k][3 + i];
		}
}

/* Light of surfaces does not depend on the scene's size. */
static void any_size(void **state)
{
	static const float widths[] = { 5.5f, 1e-3f, 1e4f };
	const struct reference_params p = { .seed = 3, .samples = 4096, .max_bounces = 64 };
	struct reference_point points[3][3];
	struct quad quads[CORNELL_QUADS];
	double worst = 0;

	(void)state;
	for (int s = 0; s < 3; s++) {
		float scale = widths[s] / 5.5f;
		uint64_t nonfinite;
		struct closed c;

		memcpy(quads, cornell_quads, sizeof(quads));
		for (size_t q = 0; q < CORNELL_QUADS; q++)
			for (int k = 0; k < 12; k++)
				(&quads[q].at[0][0])[k] *= scale;
		closed_start(&c, quads, CORNELL_QUADS, cornell_materials, CORNELL_MATERIALS);
		cornell_points(points[s], scale);
		assert_int_equal(reference_irradiance(c.reference, &p, points[s], 3, &nonfinite), GR_OK);
		assert_int_equal(nonfinite, 0);
		for (int k = 0; k < 3; k++) {
			assert_true(points[s][k].total[1] > 0);
			worst = fmax(worst, fabs(points[s][k].total[1] / points[0][k].total[1] - 1));
		}
		closed_end(&c);
	}
	printf("# scenes 1 mm and 10 km wide: irradiance differs by at most %.2g\n", worst);
	assert_true(worst < 1e-3);
}

/* Brightness is a factor; nothing is clamped on the way. */
static void bright_and_dark(void **state)
{
	const struct reference_params p = { .seed = 3, .samples = 256, .max_bounces = 64 };
	struct reference_point plain[3], bright[3];
	uint64_t nonfinite;
	double worst = 0;
	struct closed c;

	(void)state;
	start_cornell(&c);
	cornell_points(plain, 1);
	assert_int_equal(reference_irradiance(c.reference, &p, plain, 3, &nonfinite), GR_OK);
	for (int i = 0; i < 3; i++)
		c.scene.materials[CORNELL_LIGHT].emission[i] *= 1e9f;
	closed_again(&c);
	cornell_points(bright, 1);
	assert_int_equal(reference_irradiance(c.reference, &p, bright, 3, &nonfinite), GR_OK);
	assert_int_equal(nonfinite, 0);
	for (int k = 0; k < 3; k++) {
		assert_true(plain[k].total[0] > 0);
		worst = fmax(worst, fabs(bright[k].total[0] / plain[k].total[0] / 1e9 - 1));
	}
	printf("# an emitter a thousand million times as bright: off by %.2g\n", worst);
	assert_true(worst < 1e-5);
	/* a closed black box, no lamps */
	memset(c.scene.materials[CORNELL_LIGHT].emission, 0, 3 * sizeof(float));
	closed_again(&c);
	assert_int_equal(reference_irradiance(c.reference, &p, bright, 3, &nonfinite), GR_OK);
	assert_int_equal(nonfinite, 0);
	for (int k = 0; k < 3; k++)
		assert_true(bright[k].total[0] == 0 && bright[k].total_error[0] == 0);
	closed_end(&c);
}

/* Without a surface there is background, or sky; nothing else. */
static void nothing_there(void **state)
{
	const struct reference_params p = { .seed = 1, .samples = 32 };
	const struct scene_material m = material(1, 0);
	double got, error;
	struct closed c;

	(void)state;
	closed_start(&c, &floor_quad, 0, &m, 1);
	c.file.background[1] = 0.25f;
	closed_again(&c);
	closed_look(&c, &p, up, up, &got, &error);
	assert_true(got == 0.25 && error == 0);
	closed_point(&c, &p, up, up, &got, &error);
	assert_true(got == 0);
	closed_sky(&c, 2);
	closed_look(&c, &p, up, up, &got, &error);
	assert_true(got == 2 && error == 0);
	closed_end(&c);
}

/* Two one-sided sheets back to back at the same place stop all light and show their fronts. */
static void coincident_faces(void **state)
{
	struct quad quads[8];
	struct scene_material m[2] = { material(0.5f, 0), material(0, 1) };
	const struct reference_params p = { .seed = 2, .samples = 4096, .max_bounces = 64 };
	double above, below, error;
	struct closed c;

	(void)state;
	closed_cube(quads, 0, 1);
	quads[6] = (struct quad){ 0, { { -1, 0, 1 }, { 1, 0, 1 }, { 1, 0, -1 }, { -1, 0, -1 } } };
	quads[7] = (struct quad){ 0, { { -1, 0, -1 }, { 1, 0, -1 }, { 1, 0, 1 }, { -1, 0, 1 } } };
	/* the ceiling emits: quads of one material need not follow each other here */
	quads[3].material = 1;
	closed_start(&c, quads, 8, m, 2);
	closed_point(&c, &p, (const double[3]){ 0.2, 0, 0.1 }, up, &above, &error);
	closed_point(&c, &p, (const double[3]){ 0.2, -1, 0.1 }, up, &below, &error);
	assert_true(below == 0);
	closed_end(&c);
	/* the same with the sheet alone */
	closed_start(&c, quads, 7, m, 2);
	closed_point(&c, &p, (const double[3]){ 0.2, 0, 0.1 }, up, &below, &error);
	printf("# coincident sheets: %.5f, one sheet: %.5f (standard error %.5f)\n", above, below, error);
	assert_true(fabs(above / below - 1) < 1e-3);
	closed_end(&c);
}

/* Triangles that import would have dropped do no harm when they come all the same. */
static void unusable_triangles(void **state)
{
	struct quad quads[8];
	const struct scene_material m[2] = { material(0.5f, 0), material(0, 1) };
	const struct reference_params p = { .seed = 2, .samples = 256, .max_bounces = 64 };
	struct reference_point points[2];
	struct closed c;

	(void)state;
	for (int k = 0; k < 2; k++) {
		closed_cube(quads, 0, 1);
		quads[3].material = 1;
		/* of no area, and with a corner nowhere: both would emit */
		quads[6] = (struct quad){ 1, { { 0, 0, 0 }, { 0.5f, 0, 0 }, { 0.2f, 0, 0 }, { 0, 0, 0 } } };
		quads[7] = (struct quad){ 1, { { 0, 0, 0 }, { NAN, 0, 0 }, { 0, INFINITY, 0 }, { 0, 0, 1 } } };
		points[k] = (struct reference_point){ .position = { 0.3f, -1, 0.1f }, .normal = { 0, 1, 0 } };
		uint64_t nonfinite;

		closed_start(&c, quads, k == 0 ? 6 : 8, m, 2);
		for (int i = 0; i < 3; i++) {
			c.scene.min[i] = -1;
			c.scene.max[i] = 1;
		}
		closed_again(&c);
		assert_int_equal(reference_irradiance(c.reference, &p, &points[k], 1, &nonfinite), GR_OK);
		assert_int_equal(nonfinite, 0);
		closed_end(&c);
	}
	assert_true(points[0].total[1] > 0);
	assert_true(fabs(points[1].total[1] / points[0].total[1] - 1) < 1e-5);
}

/* --- against the bench's own tracer of paths, which shares nothing with this one but Embree --- */

static void room_as_traced_before(void **state)
{
	enum { POINTS = 24, PATHS = 6000 };
	struct truth_spot spot = { .position = { 2, 3.9f, 2 }, .direction = { 0, -1, 0 },
				   .intensity = { 10, 10, 10 }, .half_angle = 0.7f };
	const struct reference_params p = { .seed = 1, .samples = 8192, .max_bounces = 31 };
	struct scene_file file = quads_file();
	struct scene_lamp lamp = { .kind = SCENE_LAMP_SPOT, .on = true, .cone_rad = 1.4f };
	struct reference_point points[POINTS];
	struct truth_sample samples[POINTS];
	struct reference *reference;
	struct render_frame frame;
	struct scene *scene = room_cornell();
	struct truth truth;
	double sum[2] = { 0 }, variance = 0, sigma2 = 0;
	size_t count;

	(void)state;
	memset(points, 0, sizeof(points));
	memcpy(lamp.position, spot.position, sizeof(lamp.position));
	memcpy(lamp.direction, spot.direction, sizeof(lamp.direction));
	memcpy(lamp.intensity, spot.intensity, sizeof(lamp.intensity));
	file.lamps = &lamp;
	file.lamp_count = 1;
	render_frame_init(&frame, &file);
	assert_int_equal(truth_init(&truth, scene, &spot), GR_OK);
	count = truth_points(&truth, 1, 0.05f, samples, POINTS);
	truth_trace(&truth, 1, PATHS, samples, count);
	for (size_t i = 0; i < count; i++) {
		memcpy(points[i].position, samples[i].position, sizeof(points[i].position));
		memcpy(points[i].normal, samples[i].normal, sizeof(points[i].normal));
	}
	assert_int_equal(reference_create(&reference, scene, &file, &frame), GR_OK);
	assert_int_equal(reference_irradiance(reference, &p, points, count, NULL), GR_OK);
	for (size_t i = 0; i < count; i++) {
		double mean[2] = { 0 }, error2 = samples[i].standard_error * samples[i].standard_error;

		for (int c = 0; c < 3; c++) {
			mean[0] += points[i].indirect[c] / 3;
			mean[1] += samples[i].irradiance[c] / 3;
			error2 += points[i].indirect_error[c] * points[i].indirect_error[c] / 3;
		}
		sum[0] += mean[0];
		sum[1] += mean[1];
		variance += error2;
		if (error2 > 0)
			sigma2 += (mean[0] - mean[1]) * (mean[0] - mean[1]) / error2;
	}
	printf("# room of 4 m, %zu points: mean indirect %.5f, the bench's tracer %.5f (%+.2f %%, "
	       "%.1f standard errors; rms of points %.2f)\n",
	       count, sum[0] / (double)count, sum[1] / (double)count, 100 * (sum[0] / sum[1] - 1),
	       fabs(sum[0] - sum[1]) / sqrt(variance), sqrt(sigma2 / (double)count));
	assert_true(fabs(sum[0] - sum[1]) < 3 * sqrt(variance));
	reference_destroy(&reference);
	truth_finish(&truth);
	room_free(&scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(furnace_white),
		cmocka_unit_test(furnace_phong),
		cmocka_unit_test(furnace_measured),
		cmocka_unit_test(medium_takes_light),
		cmocka_unit_test(medium_in_furnace),
		cmocka_unit_test(medium_scatters_once),
		cmocka_unit_test(threads_and_resuming_change_nothing),
		cmocka_unit_test(walls_are_windows),
		cmocka_unit_test(any_size),
		cmocka_unit_test(bright_and_dark),
		cmocka_unit_test(nothing_there),
		cmocka_unit_test(coincident_faces),
		cmocka_unit_test(unusable_triangles),
		cmocka_unit_test(room_as_traced_before),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
