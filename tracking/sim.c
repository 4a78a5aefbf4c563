#include "tracking/sim.h"

#include "base/clock.h"
#include "base/result.h"

#include <math.h>
#include <stdlib.h>

#define MARGIN_M 0.25   /* between the walk and the room's sides */
#define STEP_M 0.65     /* length of a footstep, for the bobbing of the head */
#define BOB_M 0.015
#define EIGHT 6.0972230 /* length of Gerono's lemniscate with half-width 1 */
#define SLOT_NS (2 * GR_NS_PER_S) /* at most one press of the buttons in each */

struct track_sim {
	struct track_source source;
	struct track_sim_params params;
	int64_t period_ns;
	int bodies[TRACK_BODIES], body_count;
	double lost_chance;    /* that a drop-out begins at a given sample */
	int64_t lost_samples;  /* how many samples one takes */
	bool started;
	int64_t next;          /* sample number */
	int next_body;         /* index into bodies */
	int64_t lost_until[TRACK_BODIES]; /* first sample number that is seen again */
};

/* What a number is drawn for; keeps the streams apart. */
enum stream { STREAM_NOISE, STREAM_LOST, STREAM_BUTTONS };

/*
 * Counter-based: the finaliser of SplitMix64 (Steele, Lea, Flood 2014) over
 * the seed and over what is drawn, so that sample n does not depend on whether
 * sample n - 1 was asked for.
 */
static uint64_t mix64(uint64_t x)
{
	x = (x ^ x >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
	x = (x ^ x >> 27) * UINT64_C(0x94d049bb133111eb);
	return x ^ x >> 31;
}

/* Uniform in (0, 1]: never 0, for the logarithm in gaussian(). */
static double uniform(uint32_t seed, enum stream stream, int body, int64_t n, int channel)
{
	uint64_t key = mix64(seed + UINT64_C(0x9e3779b97f4a7c15));

	key = mix64(key + ((uint64_t)stream << 16 | (uint64_t)body << 8 | (uint64_t)channel));
	return (double)((mix64(key + (uint64_t)n) >> 11) + 1) * 0x1p-53;
}

/* Box and Muller (1958). */
static double gaussian(uint32_t seed, int body, int64_t n, int channel)
{
	double u = uniform(seed, STREAM_NOISE, body, n, channel * 2);
	double v = uniform(seed, STREAM_NOISE, body, n, channel * 2 + 1);

	return sqrt(-2.0 * log(u)) * cos(2.0 * M_PI * v);
}

/*
 * Slows a movement `by` down towards the side of the room that it goes to:
 * slope 1 at rest, so smooth where the direction turns, and never past it.
 */
static float keep_inside(float from, double by, float min, float max)
{
	double room, margin = fmin(MARGIN_M, 0.5 * ((double)max - min));

	room = by < 0 ? (double)from - min - margin : (double)max - from - margin;
	if (!(room > 0))
		return from;
	return (float)(from + copysign(room * tanh(fabs(by) / room), by));
}

/*
 * How far the visitor has walked from the start, in the room's axes: Gerono's
 * lemniscate through the start pose, never further away than the radius.
 */
static void walk(const struct track_sim_params *p, double t, double out[3])
{
	double radius = p->walk_radius_m, phase, side, ahead, norm;
	vec3 right;
	double steps = fmax(1.0, round(EIGHT * radius / STEP_M));

	out[0] = out[1] = out[2] = 0;
	if (!(radius > 0) || !(p->walk_speed_m_s > 0))
		return;
	phase = fmod(t * p->walk_speed_m_s / (EIGHT * radius), 1.0) * 2.0 * M_PI;
	gr_pose_direction(&p->start_head, (vec3){ 1, 0, 0 }, right);
	norm = hypot(right[0], right[2]);
	if (norm < 1e-3) { /* lying on the side */
		right[0] = 1;
		right[2] = 0;
		norm = 1;
	}
	side = radius * sin(phase) / norm;
	ahead = radius * sin(phase) * cos(phase) / norm;
	out[0] = side * right[0] + ahead * right[2];
	out[1] = BOB_M * sin(steps * phase);
	out[2] = side * right[2] - ahead * right[0];
}

/* Turns about the room's vertical, then about the body's own right and forward. */
static void turned(const versor start, double yaw, double pitch, double roll, versor out)
{
	versor q0 = { start[0], start[1], start[2], start[3] };
	versor y = { 0, (float)sin(yaw * 0.5), 0, (float)cos(yaw * 0.5) };
	versor x = { (float)sin(pitch * 0.5), 0, 0, (float)cos(pitch * 0.5) };
	versor z = { 0, 0, (float)sin(roll * 0.5), (float)cos(roll * 0.5) };

	glm_quat_mul(y, q0, out);
	glm_quat_mul(out, x, out);
	glm_quat_mul(out, z, out);
	glm_quat_normalize(out);
}

/* Radians to the left. Two periods without a common multiple: never quite the same look. */
static double look_yaw(double t)
{
	return 0.60 * sin(2.0 * M_PI * 0.110 * t) + 0.25 * sin(2.0 * M_PI * 0.047 * t);
}

static void head_at(const struct track_sim_params *p, double t, struct gr_pose *out)
{
	double by[3];

	walk(p, t, by);
	for (int i = 0; i < 3; i++)
		out->p[i] = keep_inside(p->start_head.p[i], by[i], p->room_min[i], p->room_max[i]);
	turned(p->start_head.q, look_yaw(t), 0.20 * sin(2.0 * M_PI * 0.083 * t),
	       0.05 * sin(2.0 * M_PI * 0.061 * t), out->q);
}

/* The hand goes along with the body, turns half as far as the head, and sweeps. */
static void wand_at(const struct track_sim_params *p, double t, struct gr_pose *out)
{
	double by[3], arm[3], yaw = 0.5 * look_yaw(t), c = cos(yaw), s = sin(yaw);
	double sweep = sin(2.0 * M_PI * 0.230 * t), lift = sin(2.0 * M_PI * 0.170 * t);

	walk(p, t, by);
	for (int i = 0; i < 3; i++)
		arm[i] = (double)p->start_wand.p[i] - p->start_head.p[i];
	by[0] += c * arm[0] + s * arm[2] - arm[0] + 0.10 * sweep;
	by[1] += 0.08 * lift;
	by[2] += c * arm[2] - s * arm[0] - arm[2];
	for (int i = 0; i < 3; i++)
		out->p[i] = keep_inside(p->start_wand.p[i], by[i], p->room_min[i], p->room_max[i]);
	turned(p->start_wand.q, yaw - 0.45 * sweep, 0.30 * lift, 0.0, out->q);
}

static void truth_at(const struct track_sim_params *p, enum track_body body, int64_t time_ns,
		     struct gr_pose *out)
{
	double t = (double)time_ns * 1e-9;

	if (body == TRACK_WAND)
		wand_at(p, t, out);
	else
		head_at(p, t, out);
}

/* In every second slot or so, one of three buttons for some hundred milliseconds. */
static uint32_t buttons_at(const struct track_sim_params *p, int64_t time_ns)
{
	int64_t slot = time_ns / SLOT_NS;
	double at = (double)(time_ns % SLOT_NS) * 1e-9;
	double from = 0.2 + 0.8 * uniform(p->seed, STREAM_BUTTONS, TRACK_WAND, slot, 0);
	double held = 0.2 + 0.6 * uniform(p->seed, STREAM_BUTTONS, TRACK_WAND, slot, 1);
	double which = uniform(p->seed, STREAM_BUTTONS, TRACK_WAND, slot, 2) * 6.0;

	if (which > 3.0 || at < from || at >= from + held)
		return 0;
	return which > 2.0 ? 4 : which > 1.0 ? 2 : 1;
}

static bool drop_out_begins(const struct track_sim *sim, int body, int64_t n)
{
	return sim->lost_chance > 0 &&
	       uniform(sim->params.seed, STREAM_LOST, body, n, 0) <= sim->lost_chance;
}

static bool lost(struct track_sim *sim, int body, int64_t n)
{
	if (drop_out_begins(sim, body, n))
		sim->lost_until[body] = n + sim->lost_samples;
	return n < sim->lost_until[body];
}

static void sample_at(struct track_sim *sim, int body, int64_t n, struct track_sample *out)
{
	const struct track_sim_params *p = &sim->params;
	int64_t time_ns = n * sim->period_ns;
	double angle[3];

	*out = (struct track_sample){
		.time_ns = time_ns,
		.body = (enum track_body)body,
		.T_room_body = GR_POSE_IDENTITY,
		.buttons = body == TRACK_WAND ? buttons_at(p, time_ns) : 0,
		.valid = !lost(sim, body, n),
	};
	if (!out->valid)
		return;
	truth_at(p, out->body, time_ns, &out->T_room_body);
	if (p->noise_position_m > 0)
		for (int i = 0; i < 3; i++)
			out->T_room_body.p[i] +=
				(float)(p->noise_position_m * gaussian(p->seed, body, n, i));
	if (p->noise_angle_rad > 0) {
		for (int i = 0; i < 3; i++)
			angle[i] = p->noise_angle_rad * gaussian(p->seed, body, n, i + 3);
		turned(out->T_room_body.q, angle[0], angle[1], angle[2], out->T_room_body.q);
	}
}

/* A tracker has no memory of the time before it was asked, and 1 s of buffer after. */
static void catch_up(struct track_sim *sim, int64_t newest)
{
	int64_t oldest = newest - GR_NS_PER_S / sim->period_ns;

	if (sim->started && sim->next >= oldest)
		return;
	sim->next = sim->started ? oldest : newest;
	sim->next_body = 0;
	sim->started = true;
	if (sim->next < 0)
		sim->next = 0;
	/* Whatever began before still goes on. */
	if (sim->lost_chance > 0)
		for (int i = 0; i < sim->body_count; i++)
			for (int64_t n = sim->next - sim->lost_samples; n < sim->next; n++)
				if (n >= 0)
					(void)lost(sim, sim->bodies[i], n);
}

static int sim_poll(struct track_source *source, int64_t now_ns, struct track_sample *out, int room)
{
	struct track_sim *sim = (struct track_sim *)source;
	int64_t there = now_ns - sim->params.latency_ns;
	int64_t newest = there < 0 ? -1 : there / sim->period_ns;
	int count = 0;

	catch_up(sim, newest);
	while (count < room && sim->next <= newest) {
		sample_at(sim, sim->bodies[sim->next_body], sim->next, &out[count++]);
		if (++sim->next_body == sim->body_count) {
			sim->next_body = 0;
			sim->next++;
		}
	}
	return count;
}

static int sim_fd(const struct track_source *source)
{
	(void)source;
	return -1;
}

static int64_t sim_next(const struct track_source *source, int64_t now_ns)
{
	const struct track_sim *sim = (const struct track_sim *)source;

	if (sim->started)
		return sim->next * sim->period_ns + sim->params.latency_ns;
	return now_ns > sim->params.latency_ns ? now_ns : sim->params.latency_ns;
}

static void sim_destroy(struct track_source *source)
{
	free(source);
}

static const struct track_source_ops sim_ops = {
	.kind = "sim",
	.poll = sim_poll,
	.fd = sim_fd,
	.next = sim_next,
	.destroy = sim_destroy,
};

static void check(struct gr_diag *diag, const char *key, double value, double min, double max,
		  const char *unit)
{
	if (!(value >= min && value <= max))
		gr_diag_add(diag, GR_DIAG_ERROR, NULL, 0, key, "is %g%s, must be %g to %g%s", value,
			    unit, min, max, unit);
}

static void check_poses(const struct track_sim_params *p, struct gr_diag *diag)
{
	if (!gr_pose_valid(&p->start_head))
		gr_diag_add(diag, GR_DIAG_ERROR, NULL, 0, "start_head", "is not a pose");
	if (!gr_pose_valid(&p->start_wand))
		gr_diag_add(diag, GR_DIAG_ERROR, NULL, 0, "start_wand", "is not a pose");
	for (int i = 0; i < 3; i++) {
		const char axis = (char)('x' + i);

		if (!(p->room_max[i] > p->room_min[i]) || !isfinite(p->room_max[i] - p->room_min[i]))
			gr_diag_add(diag, GR_DIAG_ERROR, NULL, 0, "room",
				    "goes from %g m to %g m along %c, must have an inside",
				    (double)p->room_min[i], (double)p->room_max[i], axis);
		else if (p->head && !(p->start_head.p[i] >= p->room_min[i] &&
				      p->start_head.p[i] <= p->room_max[i]))
			gr_diag_add(diag, GR_DIAG_ERROR, NULL, 0, "start_head",
				    "%c is %g m, must be inside the room: %g m to %g m", axis,
				    (double)p->start_head.p[i], (double)p->room_min[i],
				    (double)p->room_max[i]);
	}
}

static int check_params(const struct track_sim_params *p, struct gr_diag *diag)
{
	size_t errors = diag->errors;

	check(diag, "sim.rate_hz", p->rate_hz, 1, 1000, " Hz");
	check(diag, "sim.noise_position_m", p->noise_position_m, 0, 0.1, " m");
	check(diag, "sim.noise_angle_rad", p->noise_angle_rad, 0, 0.5, " rad");
	check(diag, "sim.latency_ns", (double)p->latency_ns, 0, 1e9, " ns");
	check(diag, "sim.dropout_per_s", p->dropout_per_s, 0, 100, "/s");
	check(diag, "sim.dropout_ns", (double)p->dropout_ns, 0, 60e9, " ns");
	check(diag, "sim.walk_radius_m", p->walk_radius_m, 0, 100, " m");
	check(diag, "sim.walk_speed_m_s", p->walk_speed_m_s, 0, 10, " m/s");
	if (!p->head && !p->wand)
		gr_diag_add(diag, GR_DIAG_ERROR, NULL, 0, "sim",
			    "tracks nothing, must track the head, the wand or both");
	check_poses(p, diag);
	return diag->errors == errors ? GR_OK : GR_ERR_RANGE;
}

int track_sim_create(struct track_source **out, const struct track_sim_params *params,
		     struct gr_diag *diag)
{
	struct track_sim *sim;
	int result = check_params(params, diag);

	if (result != GR_OK)
		return result;
	sim = calloc(1, sizeof *sim);
	if (!sim)
		return GR_ERR_NOMEM;
	sim->source.ops = &sim_ops;
	sim->params = *params;
	sim->period_ns = llround(1e9 / params->rate_hz);
	/* A Poisson process: the chance of at least one beginning within one sample. */
	sim->lost_chance = -expm1(-(double)params->dropout_per_s / params->rate_hz);
	sim->lost_samples = (params->dropout_ns + sim->period_ns - 1) / sim->period_ns;
	if (sim->lost_samples == 0)
		sim->lost_chance = 0;
	for (int body = 0; body < TRACK_BODIES; body++)
		if (body == TRACK_HEAD ? params->head : params->wand)
			sim->bodies[sim->body_count++] = body;
	*out = &sim->source;
	return GR_OK;
}

void track_sim_truth(const struct track_source *source, enum track_body body, int64_t time_ns,
		     struct gr_pose *out)
{
	truth_at(&((const struct track_sim *)source)->params, body, time_ns, out);
}
