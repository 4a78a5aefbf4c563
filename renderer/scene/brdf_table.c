#include "renderer/scene/brdf_table.h"

#include "base/result.h"
#include "renderer/image/read_file.h"
#include "renderer/scene/brdf_private.h"

#include <math.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#define NEAREST 8
#define MAX_FILE ((size_t)64 << 20)
/* The logarithm's: below it (1/sr) interpolation is linear. */
#define FLOOR 1e-3
/* Along the normal a surface cannot send back twice what it gets: such a file has another unit. */
#define MOST_REFLECTANCE 2.0
/* How much a radian of the half vector counts against one of the difference vector. */
#define HALF_WEIGHT 4.0

struct angles {
	double half, difference, azimuth; /* azimuth folded to 0..pi/2 */
	double lever; /* how much an azimuth there moves: sin half sin difference */
};

static double unit_cosine(double c)
{
	return c < -1 ? -1 : c > 1 ? 1 : c;
}

/*
 * Rusinkiewicz' angles of two directions above the horizon, from their sum and
 * difference: so that swapping the two changes no bit.
 */
static struct angles angles_of(const double i[3], const double o[3])
{
	const double h[3] = { i[0] + o[0], i[1] + o[1], i[2] + o[2] };
	const double d[3] = { i[0] - o[0], i[1] - o[1], i[2] - o[2] };
	double across2 = h[0] * h[0] + h[1] * h[1], length = sqrt(across2 + h[2] * h[2]);
	/* d along n x h and along h x (n x h), the half vector's other axes. */
	double across = h[0] * d[1] - h[1] * d[0];
	double along = length > 0 ? ((h[0] * d[0] + h[1] * d[1]) * h[2] - d[2] * across2) / length : 0;

	return (struct angles){
		.half = atan2(sqrt(across2), h[2]),
		.difference = atan2(sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), length),
		.azimuth = atan2(fabs(across), fabs(along)),
	};
}

static struct angles angles_between(double theta_i, double theta_o, double phi)
{
	const double i[3] = { sin(theta_i), 0, cos(theta_i) };
	const double o[3] = { sin(theta_o) * cos(phi), sin(theta_o) * sin(phi), cos(theta_o) };

	return angles_of(i, o);
}

/* --- from samples to the grid --- */

struct near_sample {
	double distance;
	size_t index;
};

static double lever(const struct angles *a)
{
	return sin(a->half) * sin(a->difference);
}

/* Azimuths are close where either angle is small. */
static double distance2(const struct angles *a, const struct angles *b)
{
	double half = HALF_WEIGHT * (a->half - b->half);
	double difference = a->difference - b->difference;
	double azimuth = a->azimuth - b->azimuth;

	return half * half + difference * difference + azimuth * azimuth * a->lever * b->lever;
}

/* The nearest NEAREST + 1, nearest first. */
static void find_nearest(const struct angles *places, size_t count, const struct angles *at,
			 struct near_sample found[NEAREST + 1])
{
	for (int k = 0; k <= NEAREST; k++)
		found[k].distance = INFINITY;
	for (size_t s = 0; s < count; s++) {
		double d = distance2(&places[s], at);
		int k = NEAREST;

		if (d >= found[NEAREST].distance)
			continue;
		for (; k > 0 && found[k - 1].distance > d; k--)
			found[k] = found[k - 1];
		found[k] = (struct near_sample){ d, s };
	}
}

static void interpolate(const struct brdf_samples *from, const struct angles *places,
			const struct angles *at, float out[3])
{
	struct near_sample found[NEAREST + 1];
	double reach, weights = 0, sum[3] = { 0 };

	find_nearest(places, from->count, at, found);
	reach = sqrt(found[NEAREST].distance);
	for (int k = 0; k < NEAREST; k++) {
		double d = fmax(sqrt(found[k].distance), 1e-6);
		double w = fmax(reach - d, 0) / d;

		w = w * w + 1e-12; /* all as far as the last: their mean */
		weights += w;
		for (int c = 0; c < 3; c++)
			sum[c] += w * log(from->samples[found[k].index].rgb[c] + FLOOR);
	}
	for (int c = 0; c < 3; c++)
		out[c] = (float)fmax(exp(sum[c] / weights) - FLOOR, 0);
}

static int build_grid(struct brdf_table *t, const struct brdf_samples *from)
{
	struct angles *places = calloc(from->count, sizeof *places);

	t->grid = calloc(GRID_POINTS, sizeof *t->grid);
	if (!places || !t->grid) {
		free(places);
		return GR_ERR_NOMEM;
	}
	for (size_t s = 0; s < from->count; s++) {
		places[s] = angles_between(from->samples[s].theta_i, from->samples[s].theta_o,
					   from->samples[s].phi);
		places[s].lever = lever(&places[s]);
	}
	for (int h = 0; h < GRID_HALF; h++) {
		for (int d = 0; d < GRID_DIFFERENCE; d++) {
			for (int a = 0; a < GRID_AZIMUTH; a++) {
				double step = (double)h / (GRID_HALF - 1);
				struct angles at = {
					.half = M_PI / 2 * step * step,
					.difference = M_PI / 2 * d / (GRID_DIFFERENCE - 1),
					.azimuth = M_PI / 2 * a / (GRID_AZIMUTH - 1),
				};

				at.lever = lever(&at);
				interpolate(from, places, &at,
					    t->grid[(h * GRID_DIFFERENCE + d) * GRID_AZIMUTH + a]);
			}
		}
	}
	free(places);
	return GR_OK;
}

/* --- look-up --- */

static int cell_of(double at, int points, double *share)
{
	int i = (int)at;

	i = i < 0 ? 0 : i > points - 2 ? points - 2 : i;
	*share = at - i;
	return i;
}

static void look_up(const struct brdf_table *t, const struct angles *at, double out[3])
{
	double share[3];
	int h = cell_of(sqrt(at->half / (M_PI / 2)) * (GRID_HALF - 1), GRID_HALF, &share[0]);
	int d = cell_of(at->difference / (M_PI / 2) * (GRID_DIFFERENCE - 1), GRID_DIFFERENCE,
			&share[1]);
	int a = cell_of(at->azimuth / (M_PI / 2) * (GRID_AZIMUTH - 1), GRID_AZIMUTH, &share[2]);

	out[0] = out[1] = out[2] = 0;
	for (int k = 0; k < 8; k++) {
		int dh = k & 1, dd = k >> 1 & 1, da = k >> 2;
		double w = (dh ? share[0] : 1 - share[0]) * (dd ? share[1] : 1 - share[1]) *
			   (da ? share[2] : 1 - share[2]);
		const float *p =
			t->grid[((h + dh) * GRID_DIFFERENCE + d + dd) * GRID_AZIMUTH + a + da];

		for (int c = 0; c < 3; c++)
			out[c] += w * (double)p[c];
	}
}

static void limit_at(const struct brdf_table *t, double theta, double out[3])
{
	double share;
	int i = cell_of(theta / (M_PI / 2) * (LIMIT_ANGLES - 1), LIMIT_ANGLES, &share);

	for (int c = 0; c < 3; c++)
		out[c] = (double)t->limit[i][c] * (1 - share) + (double)t->limit[i + 1][c] * share;
}

static void limited(const struct brdf_table *t, const struct angles *at, double theta_i,
		    double theta_o, double out[3])
{
	double from_i[3], from_o[3];

	look_up(t, at, out);
	if (!t->facts.limited)
		return;
	limit_at(t, theta_i, from_i);
	limit_at(t, theta_o, from_o);
	for (int c = 0; c < 3; c++)
		out[c] *= fmin(from_i[c], from_o[c]);
}

void brdf_evaluate_angles(const struct brdf_table *table, double theta_i, double theta_o,
			  double phi, double out[3])
{
	struct angles at = angles_between(theta_i, theta_o, phi);

	limited(table, &at, theta_i, theta_o, out);
}

void brdf_table_evaluate(const struct brdf_table *table, const float wi[3], const float wo[3],
			 float out[3])
{
	const double i[3] = { (double)wi[0], (double)wi[1], (double)wi[2] };
	const double o[3] = { (double)wo[0], (double)wo[1], (double)wo[2] };
	struct angles at;
	double value[3];

	out[0] = out[1] = out[2] = 0;
	if (!(i[2] > 0) || !(o[2] > 0))
		return;
	at = angles_of(i, o);
	limited(table, &at, acos(unit_cosine(i[2])), acos(unit_cosine(o[2])), value);
	for (int c = 0; c < 3; c++)
		out[c] = (float)value[c];
}

/* --- what comes back in all --- */

#define QUADRATURE_THETA 180
#define QUADRATURE_PHI 180

/* Finer towards the mirror's azimuth, where highlights are. */
static void directional(const struct brdf_table *t, double theta_i, double out[3])
{
	out[0] = out[1] = out[2] = 0;
	for (int k = 0; k < QUADRATURE_THETA; k++) {
		double theta = (k + 0.5) / QUADRATURE_THETA * M_PI / 2;
		double weight = sin(theta) * cos(theta) * M_PI / 2 / QUADRATURE_THETA;

		for (int j = 0; j < QUADRATURE_PHI; j++) {
			double step = (j + 0.5) / QUADRATURE_PHI;
			double width = 2 * 2 * M_PI * step / QUADRATURE_PHI; /* both halves */
			double f[3];

			brdf_evaluate_angles(t, theta_i, theta, M_PI * (1 - step * step), f);
			for (int c = 0; c < 3; c++)
				out[c] += f[c] * weight * width;
		}
	}
}

/* Directional reflectances, the limit from them, and what is left of them all. */
static void measure(struct brdf_table *t)
{
	static const int every = 3; /* degrees; between them it is linear */
	double last[3] = { 0 };
	bool limit = false;

	for (int i = 0; i < LIMIT_ANGLES; i += every) {
		double r[3];

		directional(t, (i < LIMIT_ANGLES - 1 ? i : i - 0.5) * M_PI / 180, r);
		for (int c = 0; c < 3; c++) {
			t->facts.most = fmaxf(t->facts.most, (float)r[c]);
			limit = limit || r[c] > 1;
			for (int k = i > 0 ? i - every + 1 : 0; k <= i; k++) {
				double share = i > 0 ? (double)(i - k) / every : 0;
				double between = r[c] + share * (last[c] - r[c]);

				t->limit[k][c] = (float)(between > 1 ? 1 / between : 1);
			}
			if (i == 0)
				t->facts.normal[c] = (float)r[c];
			last[c] = r[c];
		}
	}
	t->facts.limited = limit;
	for (int i = 0; i < 30; i++) {
		double theta = (i + 0.5) / 30 * M_PI / 2, r[3];

		directional(t, theta, r);
		for (int c = 0; c < 3; c++)
			t->facts.reflectance[c] += (float)(r[c] * 2 * sin(theta) * cos(theta) * M_PI / 60);
	}
	for (int c = 0; c < 3; c++) /* the quadrature's own error */
		t->facts.reflectance[c] = fminf(t->facts.reflectance[c], 1);
}

static double luminance(const double rgb[3])
{
	return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

static void measure_misfit(struct brdf_table *t, const struct brdf_samples *from)
{
	double squares = 0;
	size_t count = 0;

	for (size_t s = 0; s < from->count; s++) {
		const struct brdf_sample *at = &from->samples[s];
		struct angles angles = angles_between(at->theta_i, at->theta_o, at->phi);
		double want = luminance(at->rgb), got[3], error;

		if (want < FLOOR)
			continue;
		look_up(t, &angles, got);
		error = luminance(got) / want - 1;
		squares += error * error;
		count++;
	}
	t->facts.misfit = count ? (float)sqrt(squares / (double)count) : 0;
}

static int check_energy(const struct brdf_table *t, const char *name, struct gr_diag *diag)
{
	const struct brdf_table_facts *f = &t->facts;

	for (int c = 0; c < 3; c++) {
		if ((double)f->normal[c] > MOST_REFLECTANCE) {
			gr_diag_add(diag, GR_DIAG_ERROR, name, 0, NULL,
				    "sends back %.3g times the light that comes along the normal; a BRDF "
				    "in 1/sr is meant", (double)f->normal[c]);
			return GR_ERR_CONFIG;
		}
	}
	if (f->limited)
		gr_diag_add(diag, GR_DIAG_NOTE, name, 0, NULL,
			    "sends back up to %.3g times what arrives where samples are few; limited to 1",
			    (double)f->most);
	return GR_OK;
}

int brdf_table_parse(struct brdf_table **out, const char *text, size_t len, const char *name,
		     struct gr_diag *diag)
{
	struct brdf_samples samples;
	struct brdf_table *t;
	int result = brdf_read(text, len, name, &samples, diag);

	*out = NULL;
	if (result != GR_OK)
		return result;
	t = calloc(1, sizeof *t);
	result = t ? build_grid(t, &samples) : GR_ERR_NOMEM;
	if (result == GR_OK) {
		t->facts.samples = samples.count;
		t->facts.wavelengths = samples.wavelengths;
		t->facts.below_zero = samples.below_zero;
		t->facts.cut = samples.cut;
		measure(t);
		measure_misfit(t, &samples);
		result = check_energy(t, name, diag);
	}
	brdf_samples_finish(&samples);
	if (result == GR_OK)
		result = brdf_build_sampling(t);
	*out = t;
	if (result != GR_OK)
		brdf_table_destroy(out);
	return result;
}

int brdf_table_load(struct brdf_table **out, const char *path, struct gr_diag *diag)
{
	uint8_t *bytes;
	size_t len;
	int result;

	*out = NULL;
	result = read_file(path, MAX_FILE, &bytes, &len, diag, "table");
	if (result != GR_OK)
		return result;
	result = brdf_table_parse(out, (const char *)bytes, len, path, diag);
	free(bytes);
	return result;
}

void brdf_table_destroy(struct brdf_table **table)
{
	struct brdf_table *t = *table;

	if (!t)
		return;
	free(t->grid);
	free(t->sums);
	free(t);
	*table = NULL;
}

const struct brdf_table_facts *brdf_table_facts(const struct brdf_table *table)
{
	return &table->facts;
}

void brdf_table_hash(const struct brdf_table *table, uint8_t out[32])
{
	crypto_generichash_state state;

	crypto_generichash_init(&state, NULL, 0, 32);
	crypto_generichash_update(&state, (const uint8_t *)table->grid,
				  GRID_POINTS * sizeof table->grid[0]);
	crypto_generichash_update(&state, (const uint8_t *)table->limit, sizeof table->limit);
	crypto_generichash_final(&state, out, 32);
}
