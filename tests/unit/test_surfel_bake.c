/* The surfel baker: properties of every set, and scenes that nobody would build. */
#include "base/result.h"
#include "renderer/gi/surfel_bake.h"
#include "tools/bench/room.h"
#include "tests/unit/unit.h"

#include <math.h>
#include <sodium.h>

static struct surfel_bake_params quick(float spacing)
{
	return (struct surfel_bake_params){
		.spacing_m = spacing, .links = 32, .taps = 16, .probes = 3, .threads = 2, .seed = 1,
	};
}

static struct surfel_set *bake(const struct scene *scene, float spacing)
{
	const struct surfel_bake_params params = quick(spacing);
	struct gr_diag diag = { 0 };
	struct surfel_set *set;

	assert_int_equal(surfel_bake(&set, scene, NULL, &params, &diag), GR_OK);
	assert_int_equal(diag.count, 0);
	return set;
}

static void corner(const struct scene *scene, size_t t, int k, float out[3])
{
	memcpy(out, scene->vertices[scene->indices[3 * t + (size_t)k]].position, 3 * sizeof *out);
}

static double triangle(const struct scene *scene, size_t t, float normal[3])
{
	float p[3][3], n[3];
	double length;

	for (int k = 0; k < 3; k++)
		corner(scene, t, k, p[k]);
	for (int i = 0; i < 3; i++) {
		int a = (i + 1) % 3, b = (i + 2) % 3;

		n[i] = (p[1][a] - p[0][a]) * (p[2][b] - p[0][b]) -
		       (p[1][b] - p[0][b]) * (p[2][a] - p[0][a]);
	}
	length = sqrt((double)(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]));
	for (int i = 0; i < 3; i++)
		normal[i] = (float)((double)n[i] / length);
	return 0.5 * length;
}

/* Numbers finite, links to surfels that are there. */
static void check_sane(const struct surfel_set *set)
{
	for (size_t i = 0; i < set->count; i++) {
		for (int k = 0; k < 3; k++) {
			assert_true(isfinite(set->surfels[i].position[k]));
			assert_true(set->albedo[i][k] >= 0 && set->albedo[i][k] <= 1);
			assert_true(isfinite(set->fixed_emissive[i][k]) && set->fixed_emissive[i][k] >= 0);
			assert_true(isfinite(set->fixed_other[i][k]) && set->fixed_other[i][k] >= 0);
		}
		assert_true(set->area[i] > 0 && isfinite(set->area[i]));
	}
	for (size_t i = 0; i < set->count * set->links_each; i++)
		assert_true(set->links[i] < set->count || set->links[i] == SURFEL_NONE);
	for (size_t i = 0; i < set->probes.count * set->probes.links_each; i++)
		assert_true(set->probes.links[i] < set->count || set->probes.links[i] == SURFEL_NONE);
}

/* A room with boxes at random, one- and two-sided. */
static struct scene *clutter(struct unit_random *random)
{
	struct room_builder b;
	struct scene *scene;

	room_begin(&b);
	uint32_t a = room_material(&b, 0.8f, 0.5f, 0.2f), c = room_material(&b, 0.3f, 0.6f, 0.9f);
	room_inside(&b, (uint32_t[6]){ a, a, c, c, a, c }, (float[3]){ 0, 0, 0 }, (float[3]){ 4, 3, 5 });
	for (int i = 0; i < 8; i++) {
		float middle[3], half[3];

		for (int k = 0; k < 3; k++) {
			middle[k] = (float)unit_random_range(random, 0.5, 2.5);
			half[k] = (float)exp(unit_random_range(random, -4, -0.5));
		}
		room_box(&b, i % 2 ? a : c, middle, half, (float)unit_random_range(random, 0, 3));
	}
	scene = room_end(&b);
	scene->materials[a].two_sided = false;
	return scene;
}

static void every_set(void **state)
{
	struct unit_random random = unit_random_start("every_set");

	(void)state;
	for (int round = 0; round < 4; round++) {
		struct scene *scene = clutter(&random);
		struct surfel_set *set = bake(scene, 0.3f);
		size_t unheard = 0, asked = 0, lonely = 0;
		double area = 0, reflecting[3] = { 0 }, expected = 0, expected_by[3] = { 0 };

		check_sane(set);
		for (size_t d = 0; d < scene->draw_count; d++) {
			const struct scene_material *m = &scene->materials[scene->draws[d].material];

			for (uint32_t i = 0; i < scene->draws[d].index_count / 3; i++) {
				float n[3];
				double sides = triangle(scene, scene->draws[d].first_index / 3 + i, n) *
					       (m->two_sided ? 2 : 1);

				expected += sides;
				for (int c = 0; c < 3; c++)
					expected_by[c] += sides * (double)m->diffuse[c];
			}
		}
		for (size_t i = 0; i < set->count; i++) {
			area += (double)set->area[i];
			for (int c = 0; c < 3; c++)
				reflecting[c] += (double)(set->area[i] * set->albedo[i][c]);
		}
		assert_true(fabs(area / expected - 1) < 1e-3);
		/* patches know the reflectance of what they cover */
		for (int c = 0; c < 3; c++)
			assert_true(fabs(reflecting[c] / expected_by[c] - 1) < 2e-3);
		/* points of the fronts hear surfels, and close ones of their own side */
		for (size_t t = 0; t < scene->index_count / 3; t++) {
			float p[3][3], n[3];

			triangle(scene, t, n);
			for (int k = 0; k < 3; k++)
				corner(scene, t, k, p[k]);
			for (int k = 0; k < 40; k++) {
				float u = (float)sqrt(unit_random_range(&random, 0, 1));
				float v = (float)unit_random_range(&random, 0, 1), at[3], sum = 0;
				const uint32_t *members;
				bool close = false;

				for (int i = 0; i < 3; i++)
					at[i] = (1 - u) * p[0][i] + u * (1 - v) * p[1][i] + u * v * p[2][i];
				size_t count = surfel_set_cell(set, at, &members);
				for (size_t j = 0; j < count; j++) {
					const float *s = set->surfels[members[j]].position;
					float w = surfel_weight(set, members[j], at, n);

					assert_true(w >= 0 && w <= 1.001f);
					sum += w;
					close = close || (w > 0 && hypotf(hypotf(s[0] - at[0], s[1] - at[1]),
									  s[2] - at[2]) < 1.1f * set->spacing_m);
				}
				asked++;
				unheard += !(sum > 0);
				lonely += !close;
			}
		}
		printf("# %zu surfels; of %zu points %zu hear none, %zu none within the spacing\n",
		       set->count, asked, unheard, lonely);
		/* slits between boxes that run through each other; shading takes the nearest there */
		assert_true(unheard * 33 <= asked);
		assert_true(lonely * 25 <= asked);
		surfel_set_destroy(&set);
		room_free(&scene);
	}
}

/* On open ground no two are closer than the spacing, and none could be added. */
static void poisson_disc(void **state)
{
	struct room_builder b;
	struct scene *scene;
	struct surfel_set *set;
	double least = INFINITY;

	(void)state;
	room_begin(&b);
	uint32_t m = room_material(&b, 0.5f, 0.5f, 0.5f);
	room_quad(&b, m, (float[3]){ 0, 0, 0 }, (float[3]){ 0, 0, 5 }, (float[3]){ 5, 0, 0 });
	scene = room_end(&b);
	set = bake(scene, 0.4f);
	size_t sides[2] = { 0 };
	for (size_t i = 0; i < set->count; i++) {
		float n[3], other[3];

		surfel_normal_unpack(set->surfels[i].normal, n);
		assert_true(fabsf(n[1]) > 0.999f);
		sides[n[1] < 0]++;
		for (size_t j = 0; j < i; j++) {
			const float *a = set->surfels[i].position, *c = set->surfels[j].position;

			surfel_normal_unpack(set->surfels[j].normal, other);
			if (n[1] * other[1] > 0)
				least = fmin(least, hypot((double)(a[0] - c[0]), (double)(a[2] - c[2])));
		}
	}
	printf("# 25 m^2, both sides: %zu and %zu surfels, the closest two %.3f m apart\n", sides[0],
	       sides[1], least);
	assert_true(least >= 0.3999);
	/* between the sparsest that is maximal and the densest there is */
	for (int side = 0; side < 2; side++)
		assert_in_range(sides[side], 25 / (0.16 * 3.15), 25 / (0.16 * 0.7));
	surfel_set_destroy(&set);
	room_free(&scene);
}

static void same_for_any_threads(void **state)
{
	struct scene *scene = room_cornell();
	uint64_t first = 0;

	(void)state;
	for (int threads = 1; threads <= 7; threads += 3) {
		struct surfel_bake_params params = quick(0.4f);
		struct gr_diag diag = { 0 };
		struct surfel_set *set;

		params.threads = threads;
		assert_int_equal(surfel_bake(&set, scene, NULL, &params, &diag), GR_OK);
		if (threads == 1)
			first = surfel_set_hash(set);
		assert_int_equal(surfel_set_hash(set), first);
		surfel_set_destroy(&set);
	}
	room_free(&scene);
}

static void normals(void **state)
{
	struct unit_random random = unit_random_start("normals");
	double worst = 0;

	(void)state;
	for (int i = 0; i < 20000; i++) {
		float n[3], back[3], u[3], v[3], length;

		for (int k = 0; k < 3; k++)
			n[k] = i < 27 ? (float)(i / (k == 0 ? 1 : k == 1 ? 3 : 9) % 3 - 1)
				      : (float)unit_random_range(&random, -1, 1);
		length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
		if (length < 1e-3f)
			continue;
		for (int k = 0; k < 3; k++)
			n[k] /= length;
		surfel_normal_unpack(surfel_normal_pack(n), back);
		for (int k = 0; k < 3; k++)
			worst = fmax(worst, (double)fabsf(back[k] - n[k]));
		surfel_frame(n, u, v);
		assert_true(fabsf(u[0] * v[0] + u[1] * v[1] + u[2] * v[2]) < 1e-5f);
		assert_true(fabsf(u[0] * n[0] + u[1] * n[1] + u[2] * n[2]) < 1e-5f);
	}
	printf("# packed normals are off by %.1e at most\n", worst);
	assert_true(worst < 1e-4);
}

/* --- scenes that nobody would build --- */

static void scale(struct scene *scene, float by)
{
	for (size_t i = 0; i < scene->vertex_count; i++)
		for (int k = 0; k < 3; k++)
			scene->vertices[i].position[k] *= by;
	for (int k = 0; k < 3; k++) {
		scene->min[k] *= by;
		scene->max[k] *= by;
	}
}

/* The same room, 1 mm and 10 km wide, has the same light: links follow the shape alone. */
static void any_size(void **state)
{
	static const float sizes[] = { 1, 0.00025f, 2500 };
	double lost[3];

	(void)state;
	for (int s = 0; s < 3; s++) {
		struct scene *scene = room_cornell();
		struct surfel_set *set;

		scale(scene, sizes[s]);
		set = bake(scene, 0);
		check_sane(set);
		lost[s] = 0;
		for (size_t i = 0; i < set->count * set->links_each; i++)
			lost[s] += set->links[i] == SURFEL_NONE ? 1.0 / (double)(set->count * set->links_each) : 0;
		printf("# %g m wide: %zu surfels of %.3g m, %.2f %% of the links go outside\n",
		       (double)(4 * sizes[s]), set->count, (double)set->spacing_m, 100 * lost[s]);
		assert_true(fabs(lost[s] - lost[0]) < 0.01);
		surfel_set_destroy(&set);
		room_free(&scene);
	}
}

static void broken_triangles(void **state)
{
	struct scene *scene = room_cornell();
	struct surfel_set *set;

	(void)state;
	scene->vertices[5].position[1] = NAN;
	scene->vertices[9].position[0] = INFINITY;
	scene->vertices[13].position[2] = 1e30f;
	memcpy(scene->vertices[17].position, scene->vertices[16].position, sizeof(float[3]));
	scene->indices[20] = scene->indices[19];
	set = bake(scene, 0.4f);
	check_sane(set);
	assert_true(set->count > 100);
	surfel_set_destroy(&set);
	room_free(&scene);
}

static void odd_shapes(void **state)
{
	struct room_builder b;
	struct scene *scene;
	struct surfel_set *set;

	(void)state;
	room_begin(&b);
	uint32_t m = room_material(&b, 0.5f, 0.5f, 0.5f);
	/* the same faces three times, one of them inside out; and three that share one edge */
	for (int i = 0; i < 2; i++)
		room_inside(&b, (uint32_t[6]){ m, m, m, m, m, m }, (float[3]){ 0, 0, 0 }, (float[3]){ 2, 2, 2 });
	room_box(&b, m, (float[3]){ 1, 1, 1 }, (float[3]){ 1, 1, 1 }, 0);
	for (int i = 0; i < 3; i++)
		room_quad(&b, m, (float[3]){ 1, 0, 1 }, (float[3]){ 0, 1, 0 },
			  (float[3]){ cosf((float)i), 0, sinf((float)i) });
	scene = room_end(&b);
	scene->materials[0].two_sided = false;
	/* a texture that is not there */
	scene->materials[0].diffuse_image = 7;
	set = bake(scene, 0.3f);
	check_sane(set);
	surfel_set_destroy(&set);
	room_free(&scene);
}

static void black_or_bright(void **state)
{
	(void)state;
	for (int i = 0; i < 2; i++) {
		struct scene *scene = room_cornell();
		struct surfel_set *set;
		double sum = 0;

		for (size_t k = 0; k < scene->material_count; k++)
			memset(scene->materials[k].diffuse, 0, sizeof(float[3]));
		if (i == 1)
			scene->materials[0].emission[1] = 1e9f;
		scene->emissive = i == 1;
		set = bake(scene, 0.4f);
		check_sane(set);
		for (size_t k = 0; k < set->count; k++)
			sum += (double)set->fixed_emissive[k][1];
		assert_true(i == 1 ? sum > 1e9 : sum == 0);
		surfel_set_destroy(&set);
		room_free(&scene);
	}
}

static void nothing_at_all(void **state)
{
	struct room_builder b;
	struct scene *scene;
	struct surfel_set *set;
	const uint32_t *members;

	(void)state;
	room_begin(&b);
	room_material(&b, 1, 1, 1);
	scene = room_end(&b);
	set = bake(scene, 0);
	assert_int_equal(set->count, 0);
	assert_int_equal(surfel_set_cell(set, (float[3]){ 0, 0, 0 }, &members), 0);
	assert_int_equal(surfel_set_cell(set, (float[3]){ NAN, 1e30f, -1e30f }, &members), 0);
	surfel_set_destroy(&set);
	room_free(&scene);
}

static void refused(void **state)
{
	static const struct surfel_bake_params wrong[] = {
		{ .spacing_m = 1e-5f, .links = 256, .taps = 16 },
		{ .spacing_m = 0.02f, .links = 4096, .taps = 16 },
		{ .spacing_m = -1, .links = 256, .taps = 16 },
		{ .spacing_m = NAN, .links = 256, .taps = 16 },
		{ .links = 15, .taps = 16 }, { .links = 5000, .taps = 16 },
		{ .links = 256, .taps = 0 }, { .links = 256, .taps = 65 },
		{ .links = 256, .taps = 16, .probes = 65 }, { .links = 256, .taps = 16, .probes = -1 },
	};
	struct scene *scene = room_cornell();

	(void)state;
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		struct gr_diag diag = { 0 };
		struct surfel_set *set;

		assert_int_equal(surfel_bake(&set, scene, NULL, &wrong[i], &diag), GR_ERR_RANGE);
		assert_null(set);
		assert_int_equal(diag.errors, 1);
		if (i < 2)
			printf("# %s\n", diag.items[0].text);
		gr_diag_finish(&diag);
	}
	room_free(&scene);
}

static bool stop(void *ctx, const char *stage, double done, double seconds_left)
{
	int *calls = ctx;

	assert_non_null(stage);
	assert_true(done >= 0 && done <= 1.0001);
	(void)seconds_left;
	return ++*calls < 2;
}

static void can_be_stopped(void **state)
{
	struct surfel_bake_params params = quick(0.1f);
	struct scene *scene = room_cornell();
	struct gr_diag diag = { 0 };
	struct surfel_set *set;
	int calls = 0;

	(void)state;
	params.progress = stop;
	params.ctx = &calls;
	assert_int_equal(surfel_bake(&set, scene, NULL, &params, &diag), GR_NOTHING);
	assert_null(set);
	room_free(&scene);
}

static int set_up(void **state)
{
	(void)state;
	return sodium_init() < 0 ? -1 : 0;
}

/* An import lets no such emission in; if one came, no set would hold it. */
static void emission_that_is_no_number(void **state)
{
	const float wrong[] = { NAN, INFINITY };
	const struct surfel_bake_params params = quick(0.8f);

	(void)state;
	for (int i = 0; i < 2; i++) {
		struct room_builder b;
		struct gr_diag diag = { 0 };
		struct surfel_set *set = NULL;
		struct scene *scene;

		room_begin(&b);
		uint32_t m = room_material(&b, 0.5f, 0.5f, 0.5f), shines = room_material(&b, 0.5f, 0.5f, 0.5f);
		room_inside(&b, (uint32_t[6]){ m, m, m, shines, m, m }, (float[3]){ 0, 0, 0 }, (float[3]){ 3, 2, 4 });
		scene = room_end(&b);
		scene->materials[shines].emission[1] = wrong[i];
		scene->emissive = true;
		assert_true(surfel_bake(&set, scene, NULL, &params, &diag) < 0);
		assert_null(set);
		assert_int_equal(diag.errors, 1);
		assert_non_null(strstr(diag.items[diag.count - 1].text, "not finite"));
		printf("# %s\n", diag.items[diag.count - 1].text);
		gr_diag_finish(&diag);
		room_free(&scene);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_set),
		cmocka_unit_test(poisson_disc),
		cmocka_unit_test(same_for_any_threads),
		cmocka_unit_test(normals),
		cmocka_unit_test(any_size),
		cmocka_unit_test(broken_triangles),
		cmocka_unit_test(odd_shapes),
		cmocka_unit_test(black_or_bright),
		cmocka_unit_test(emission_that_is_no_number),
		cmocka_unit_test(nothing_at_all),
		cmocka_unit_test(refused),
		cmocka_unit_test(can_be_stopped),
	};

	return cmocka_run_group_tests(tests, set_up, NULL);
}
