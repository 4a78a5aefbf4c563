/*
 * How much of the time goes into rays: the reference's rays a second on one
 * thread beside those of a loop that does nothing but trace rays of the same
 * kind, in turns. Figures for docs/reference.md; the bound is loose, since
 * machines are shared.
 */
#include "base/clock.h"
#include "renderer/trace/rays.h"
#include "renderer/trace/sampler.h"
#include "renderer/trace/vector.h"
#include "tests/accuracy/closed.h"

enum { WALKS = 40000, BOUNCES = 5, RAYS = WALKS * BOUNCES, TURNS = 3 };

struct segment {
	float from[3], to[3];
};
static struct segment ways[RAYS], shadows[RAYS];

/* Cosine-distributed walks from points of the box, and from each vertex a shadow ray to the lamp. */
static size_t record(const struct rays *rays, const float start[3])
{
	struct unit_random random = { 17 };
	size_t count = 0;

	for (int w = 0; w < WALKS; w++) {
		struct v3 at = v3_of(start), n = { 0, 1, 0 };

		for (int b = 0; b < BOUNCES; b++) {
			struct v3_frame f = v3_frame_of(n);
			float u = (float)unit_random_range(&random, 0, 1), r = sqrtf(u);
			float phi = (float)unit_random_range(&random, 0, 2 * PI);
			struct v3 to = v3_from_local(&f, (struct v3){ r * cosf(phi), r * sinf(phi),
								      sqrtf(1 - u) });
			struct v3 from = v3_ahead(at, n, 1e-4f);
			struct v3 lamp = { (float)unit_random_range(&random, 2.13, 3.43), 5.4879f,
					   (float)unit_random_range(&random, 2.27, 3.32) };
			struct ray_hit hit;

			v3_put(from, ways[count].from);
			v3_put(to, ways[count].to);
			v3_put(from, shadows[count].from);
			v3_put(lamp, shadows[count].to);
			count++;
			if (!rays_nearest(rays, ways[count - 1].from, ways[count - 1].to, INFINITY, &hit))
				break;
			at = v3_ahead(from, to, hit.distance);
			n = v3_of(hit.normal);
			if (v3_dot(n, to) > 0)
				n = v3_scale(n, -1);
		}
	}
	return count;
}

static double bare_rate(const struct rays *rays, size_t count)
{
	int64_t start = gr_clock_now(&gr_clock_monotonic);
	volatile unsigned found = 0;

	for (size_t i = 0; i < count; i++) {
		struct ray_hit hit;

		found += rays_nearest(rays, ways[i].from, ways[i].to, INFINITY, &hit);
		found += rays_blocked(rays, shadows[i].from, shadows[i].to);
	}
	return 2.0 * (double)count / ((double)(gr_clock_now(&gr_clock_monotonic) - start) * 1e-9);
}

static double reference_rate(struct closed *c, const float at[3])
{
	const struct reference_params p = { .seed = 1, .samples = 1 << 16, .max_bounces = BOUNCES - 1,
					    .threads = 1 };
	struct reference_point point = { .position = { at[0], at[1], at[2] }, .normal = { 0, 1, 0 } };
	int64_t start = gr_clock_now(&gr_clock_monotonic);

	assert_int_equal(reference_irradiance(c->reference, &p, &point, 1, NULL), GR_OK);
	return (double)reference_rays(c->reference) /
	       ((double)(gr_clock_now(&gr_clock_monotonic) - start) * 1e-9);
}

static void compare(const char *name, struct closed *c)
{
	const float at[3] = { 4.5f, 0, 1 };
	double best[2] = { 0 };
	struct rays *rays;
	size_t count;

	assert_int_equal(rays_create(&rays, &c->scene), GR_OK);
	count = record(rays, at);
	for (int turn = 0; turn < TURNS; turn++) {
		best[0] = fmax(best[0], reference_rate(c, at));
		best[1] = fmax(best[1], bare_rate(rays, count));
	}
	rays_destroy(&rays);
	printf("# %s, %zu triangles: %.2f million rays/s, bare loop %.2f: %.0f %%\n", name,
	       c->scene.index_count / 3, best[0] * 1e-6, best[1] * 1e-6, 100 * best[0] / best[1]);
	assert_true(best[0] > 0.15 * best[1]);
}

static void cornell(void **state)
{
	struct closed c;

	(void)state;
	closed_start(&c, cornell_quads, CORNELL_QUADS, cornell_materials, CORNELL_MATERIALS);
	compare("Cornell box", &c);
	closed_end(&c);
}

/* The same box, its floor and walls cut into many small quads that are not quite flat. */
static void many_triangles(void **state)
{
	enum { CUT = 100, MOST = (int)CORNELL_QUADS * CUT * CUT };
	struct quad *quads = calloc(MOST, sizeof(*quads));
	struct unit_random random = { 5 };
	struct closed c;
	size_t n = 0;

	(void)state;
	assert_non_null(quads);
	for (size_t q = 0; q < CORNELL_QUADS; q++) {
		const struct quad *whole = &cornell_quads[q];
		int cut = whole->material == CORNELL_LIGHT ? 1 : CUT;

		for (int k = 0; k < cut * cut; k++, n++) {
			quads[n].material = whole->material;
			for (int corner = 0; corner < 4; corner++) {
				float u = (float)(k % cut + (corner == 1 || corner == 2)) / (float)cut;
				float v = (float)(k / cut + (corner >= 2)) / (float)cut;
				float bump = cut > 1 ? (float)unit_random_range(&random, 0, 2e-3) : 0;

				for (int i = 0; i < 3; i++)
					quads[n].at[corner][i] =
						(1 - u) * (1 - v) * whole->at[0][i] + u * (1 - v) * whole->at[1][i] +
						u * v * whole->at[2][i] + (1 - u) * v * whole->at[3][i] - bump;
			}
		}
	}
	closed_start(&c, quads, n, cornell_materials, CORNELL_MATERIALS);
	compare("box of small triangles", &c);
	closed_end(&c);
	free(quads);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(cornell),
		cmocka_unit_test(many_triangles),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
