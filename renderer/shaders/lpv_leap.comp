#version 450 core
// From three steps in a row to near the steady state (Aitken 1926): what is
// still to come is mostly the light that goes round the whole room, and shrinks
// by the same factor every step. STAGE 0: 1,024 partial sums of r_1.r_0 and
// r_0.r_0, r the steps' changes; 1: their sums, in order, so that equal nodes
// get equal bits; 2: newest += r_1 factor/(1 - factor).
// check: #define STAGE 0
layout(local_size_x = 64) in;

layout(location = 0) uniform int count; // vec4 in a lattice with border
layout(std430, binding = 11) readonly buffer OldestBuffer { vec4 oldest[]; };
layout(std430, binding = 12) readonly buffer MiddleBuffer { vec4 middle[]; };
layout(std430, binding = 13) buffer NewestBuffer { vec4 newest[]; };
layout(std430, binding = 14) buffer SumBuffer {
	vec2 whole, unused;
	vec2 partial[1024];
} sums;

const float MOST = 0.97; // a factor of rooms that keep nearly all light: it must not run away

void main()
{
	uint k = gl_WorkGroupID.x * gl_WorkGroupSize.x + gl_LocalInvocationID.x;

#if STAGE == 0
	vec2 sum = vec2(0.0);

	for (int i = int(k); i < count; i += 1024) {
		vec4 r0 = middle[i] - oldest[i], r1 = newest[i] - middle[i];

		sum += vec2(dot(r1, r0), dot(r0, r0));
	}
	sums.partial[k] = sum;
#elif STAGE == 1
	if (k != 0u)
		return;
	// pair by pair, for the rounding; nothing else reads the sums meanwhile
	for (int half_ = 512; half_ > 0; half_ /= 2)
		for (int i = 0; i < half_; i++)
			sums.partial[i] += sums.partial[i + half_];
	sums.whole = sums.partial[0];
#else
	if (k >= uint(count))
		return;
	// not so for sums that are NaN, nothing or past what a float holds: no leap then
	if (!(sums.whole.y > 0.0) || !(sums.whole.x > 0.0) || isinf(sums.whole.y))
		return;
	float factor = min(sums.whole.x / sums.whole.y, MOST);
	vec4 c = newest[k] + (newest[k] - middle[k]) * (factor / (1.0 - factor));

	// a cell never goes dark by this
	if (c.x > 0.0)
		newest[k] = c;
#endif
}
