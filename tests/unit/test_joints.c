/* Poses of characters on the wire: error, length, and what is no pose. */
#include "shared.h"
#include "skinned.h"
#include "unit.h"

#include "base/result.h"

#define MATRIX_BYTES 48 /* 3 x 4 f32 */

static void random_turn(struct unit_random *r, float q[4])
{
	double v[4], squared = 0;

	do {
		squared = 0;
		for (int i = 0; i < 4; i++) {
			v[i] = unit_random_range(r, -1, 1);
			squared += v[i] * v[i];
		}
	} while (squared > 1 || squared < 1e-4);
	for (int i = 0; i < 4; i++)
		q[i] = (float)(v[i] / sqrt(squared));
}

/* Angle between two turns; by the sine of its half, which is exact where it is small. */
static double angle_between(const float a[4], const float b[4])
{
	double d[4], e[4], dot = 0, off = 0, sum = 0;

	for (int i = 0; i < 4; i++)
		dot += (double)a[i] * (double)b[i];
	for (int i = 0; i < 4; i++) {
		d[i] = (double)a[i] - (dot < 0 ? -1 : 1) * (double)b[i];
		e[i] = (double)a[i] + (dot < 0 ? -1 : 1) * (double)b[i];
		off += d[i] * d[i];
		sum += e[i] * e[i];
	}
	return 4 * atan2(sqrt(off), sqrt(sum));
}

static struct fdp_joint through(const struct fdp_joint *joint)
{
	uint8_t bytes[64];
	struct fdp_joint out;
	size_t count;
	const size_t len = fdp_joints_encode(joint, 1, bytes, sizeof bytes);

	assert_int_equal(len, 2u + FDP_JOINT_BYTES + (joint->moved ? 12u : 0u));
	assert_int_equal(fdp_joints_decode(bytes, len, &out, 1, &count), GR_OK);
	assert_int_equal(count, 1);
	return out;
}

static void turns(void **state)
{
	struct unit_random r = unit_random_start("turns");
	double most = 0, sum = 0;
	const int tries = 200000;

	(void)state;
	for (int i = 0; i < tries; i++) {
		struct fdp_joint joint = { .moved = i & 1 }, out;
		double angle;

		random_turn(&r, joint.rotation);
		for (int k = 0; joint.moved && k < 3; k++)
			joint.position[k] = (float)unit_random_range(&r, -2, 2);
		out = through(&joint);
		angle = angle_between(joint.rotation, out.rotation);
		most = angle > most ? angle : most;
		sum += angle;
		assert_int_equal(out.moved, joint.moved);
		assert_memory_equal(out.position, joint.position, sizeof out.position);
	}
	printf("# turns in 48 bits: off by %.1e rad in the mean, %.2e at most (bound %.1e)\n",
	       sum / tries, most, (double)FDP_JOINT_ERROR);
	assert_true(most <= (double)FDP_JOINT_ERROR);
}

/* Halves, quarters, and all components alike, where the error is largest; signs do not matter. */
static void corners(void **state)
{
	static const float values[] = { 0, 1e-30f, 1e-5f, 0.5f, 0.70710678f, 1 };

	(void)state;
	for (unsigned i = 0; i < 6 * 6 * 6 * 6 * 16; i++) {
		float v[4];
		double squared = 0;
		struct fdp_joint joint = { .moved = false }, turned = joint, out, back;

		for (unsigned k = 0, n = i / 16; k < 4; k++, n /= 6) {
			v[k] = i >> k & 1 ? -values[n % 6] : values[n % 6];
			squared += (double)v[k] * (double)v[k];
		}
		if (squared == 0)
			continue;
		for (unsigned k = 0; k < 4; k++) {
			joint.rotation[k] = (float)((double)v[k] / sqrt(squared));
			turned.rotation[k] = -joint.rotation[k];
		}
		out = through(&joint);
		back = through(&turned);
		assert_true(angle_between(joint.rotation, out.rotation) <= (double)FDP_JOINT_ERROR);
		assert_true(angle_between(out.rotation, back.rotation) <=
			    2 * (double)FDP_JOINT_ERROR);
	}
	for (int k = 0; k < 4; k++) {
		struct fdp_joint joint = { .moved = false };

		joint.rotation[k] = 1; /* the identity and half turns go exactly */
		assert_memory_equal(through(&joint).rotation, joint.rotation,
				    sizeof joint.rotation);
	}
}

static void refused(void **state)
{
	static const float bad[] = { NAN, INFINITY, -INFINITY, 2, 0, 1.01f, 3e38f };
	static struct fdp_joint many[FDP_JOINTS_MAX + 1];
	static uint8_t bytes[FDP_JOINTS_MAX * (FDP_JOINT_BYTES + 12) + 64];
	struct fdp_joint joint = { .rotation = { 0, 0, 0, 1 },
				   .position = { 1, 2, 3 },
				   .moved = true };

	(void)state;
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		struct fdp_joint b = joint;

		b.rotation[3] = bad[i];
		assert_int_equal(fdp_joints_encode(&b, 1, bytes, sizeof bytes), 0);
	}
	for (size_t i = 0; i < 3; i++) {
		struct fdp_joint b = joint;

		b.position[2] = bad[i];
		assert_int_equal(fdp_joints_encode(&b, 1, bytes, sizeof bytes), 0);
	}
	joint.position[0] = 1.01f * FDP_JOINT_REACH;
	assert_int_equal(fdp_joints_encode(&joint, 1, bytes, sizeof bytes), 0);
	for (size_t i = 0; i <= FDP_JOINTS_MAX; i++)
		many[i].rotation[0] = 1;
	assert_int_equal(fdp_joints_encode(many, FDP_JOINTS_MAX + 1, bytes, sizeof bytes), 0);
	assert_int_equal(fdp_joints_encode(many, FDP_JOINTS_MAX, bytes, sizeof bytes),
			 1 + 32 + FDP_JOINTS_MAX * FDP_JOINT_BYTES);
	assert_int_equal(fdp_joints_encode(many, 0, bytes, sizeof bytes), 1);
}

/* Every length, every bit, and noise: refused, or a pose whose every part is in its range. */
static void hostile(void **state)
{
	struct unit_random r = unit_random_start("hostile");
	struct fdp_joint joints[9] = { 0 }, out[9];
	uint8_t bytes[256], exact[256];
	size_t len, count, taken = 0;

	(void)state;
	for (int i = 0; i < 9; i++) {
		random_turn(&r, joints[i].rotation);
		joints[i].moved = i == 0 || i == 8;
	}
	len = fdp_joints_encode(joints, 9, bytes, sizeof bytes);
	assert_int_equal(len, 1 + 2 + 9 * 6 + 2 * 12);
	for (size_t size = 0; size < len; size++) {
		assert_int_equal(fdp_joints_encode(joints, 9, exact, size), 0);
		assert_int_equal(fdp_joints_decode(bytes, size, out, 9, &count), GR_ERR_FORMAT);
		assert_int_equal(count, 0);
	}
	assert_int_equal(fdp_joints_decode(bytes, len + 1, out, 9, &count), GR_ERR_FORMAT);
	assert_int_equal(fdp_joints_decode(bytes, len, out, 8, &count), GR_ERR_FORMAT);
	for (int i = 0; i < 200000; i++) {
		memcpy(exact, bytes, len);
		if (i < (int)len * 8)
			exact[i / 8] = (uint8_t)(exact[i / 8] ^ 1u << i % 8);
		else
			for (size_t k = 3; k < len; k++)
				exact[k] = (uint8_t)unit_random_u32(&r);
		if (fdp_joints_decode(exact, len, out, 9, &count))
			continue;
		taken++;
		for (size_t k = 0; k < count; k++) {
			double squared = 0;

			for (int n = 0; n < 4; n++)
				squared += (double)out[k].rotation[n] * (double)out[k].rotation[n];
			assert_true(fabs(squared - 1) < 1e-6);
			for (int n = 0; n < 3; n++)
				assert_true(fabsf(out[k].position[n]) <= FDP_JOINT_REACH);
		}
	}
	assert_true(taken > 0);
}

static size_t read_positions(const char *path, double (*out)[3], size_t most)
{
	FILE *file = fopen(path, "r");
	char line[256];
	size_t n = 0;

	assert_non_null(file);
	while (fgets(line, sizeof line, file))
		if (n < most &&
		    sscanf(line, "%lf,%lf,%lf", &out[n][0], &out[n][1], &out[n][2]) == 3)
			n++;
	fclose(file);
	return n;
}

static double apart(const double (*a)[3], const double (*b)[3], size_t n, double *out_rms)
{
	double most = 0, sum = 0;

	for (size_t i = 0; i < n; i++) {
		double squared = 0;

		for (int k = 0; k < 3; k++)
			squared += (a[i][k] - b[i][k]) * (a[i][k] - b[i][k]);
		most = squared > most ? squared : most;
		sum += squared;
	}
	*out_rms = sqrt(sum / (double)n);
	return sqrt(most);
}

/* A character that walks: bytes of a pose, and where its vertices are after them. */
static void character(const char *name, const double *times, size_t time_count, double most_mm)
{
	enum { MOST = 8192 };
	static double exact[MOST][3], coded[MOST][3], truth[MOST][3];
	static struct fdp_joint joints[FDP_JOINTS_MAX], back[FDP_JOINTS_MAX];
	static uint8_t bytes[FDP_JOINTS_MAX * (FDP_JOINT_BYTES + 12) + 64];
	const int frames = 240;
	char path[1024], file[256];
	double worst = 0, sum = 0, rms, length;
	size_t most_bytes = 0, all_bytes = 0, count;
	struct skinned s;

	snprintf(file, sizeof file, "reference/scenes/characters/%s/%s.gltf", name, name);
	if (!shared_file(file, path))
		skip();
	skinned_load(&s, path);
	assert_non_null(s.scene);
	assert_true(s.count > 0 && s.mesh->mNumVertices <= MOST);
	/* What vertices are compared with is right: others computed them, at times of keys. */
	for (size_t i = 0; i < time_count; i++) {
		snprintf(file, sizeof file, "reference/scenes/characters/%s/skinned_t%s.csv", name,
			 times[i] == 0	   ? "0.0"
			 : times[i] == 0.5 ? "0.5"
			 : times[i] == 1   ? "1.0"
					   : "1.25");
		assert_non_null(shared_file(file, path));
		assert_int_equal(read_positions(path, truth, MOST), s.mesh->mNumVertices);
		skinned_pose(&s, times[i], joints);
		skinned_vertices(&s, joints, exact);
		assert_true(apart(exact, truth, s.mesh->mNumVertices, &rms) < 3e-6);
	}
	length = s.animation->mDuration /
		 (s.animation->mTicksPerSecond > 0 ? s.animation->mTicksPerSecond : 1000);
	for (int i = 0; i < frames; i++) {
		size_t len;
		double off;

		skinned_pose(&s, length * i / frames, joints);
		skinned_vertices(&s, joints, exact);
		len = fdp_joints_encode(joints, s.count, bytes, sizeof bytes);
		assert_true(len > 0);
		assert_int_equal(fdp_joints_decode(bytes, len, back, FDP_JOINTS_MAX, &count),
				 GR_OK);
		assert_int_equal(count, s.count);
		skinned_vertices(&s, back, coded);
		off = apart(exact, coded, s.mesh->mNumVertices, &rms);
		worst = off > worst ? off : worst;
		sum += rms * rms;
		most_bytes = len > most_bytes ? len : most_bytes;
		all_bytes += len;
	}
	printf("# %s, %u joints, %u vertices, %d poses: %zu bytes in the mean, %zu at most, of 3x4 "
	       "matrices %.1f %% and "
	       "%.1f %%; vertices off by %.4f mm rms, %.4f mm at most\n",
	       name, s.count, s.mesh->mNumVertices, frames, all_bytes / (size_t)frames, most_bytes,
	       100.0 * (double)all_bytes / frames / (MATRIX_BYTES * s.count),
	       100.0 * (double)most_bytes / (MATRIX_BYTES * s.count), 1e3 * sqrt(sum / frames),
	       1e3 * worst);
	assert_true(most_bytes <= 0.4 * MATRIX_BYTES * s.count);
	assert_true(1e3 * worst <= most_mm);
	skinned_free(&s);
}

static void man(void **state)
{
	static const double keys[] = { 0, 0.5, 1, 1.25 };

	(void)state;
	character("CesiumMan", keys, 4, 0.12);
}

static void figure(void **state)
{
	static const double keys[] = { 0, 1.25 };

	(void)state;
	character("RiggedFigure", keys, 2, 0.1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(turns),   cmocka_unit_test(corners), cmocka_unit_test(refused),
		cmocka_unit_test(hostile), cmocka_unit_test(man),     cmocka_unit_test(figure),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
