// Emissive surfaces as rectangles (struct patch_record in renderer/view/blocks.h).
#define PATCHES_MOST 16

struct Patch {
	vec4 centre;   // scene, metres; w: half the longer side
	vec4 u;        // half side, metres; w: 1/|u|
	vec4 v;        // half side, metres; w: 1/|v|
	vec4 normal;   // unit, the side that emits; u x v is along it
	vec4 origin;   // on the surface: where its shadows are seen from; w: its maps' far, metres
	vec4 radiance; // rgb W/(m^2 sr)
	ivec4 maps;    // x: first of 5 layers of patch_layers
};

layout(std140, binding = 5) uniform Patches {
	ivec4 patch_count; // x
	vec4 patch_map;    // of the hemicubes, x: half width at distance 1, y: pixels, z: near, w: lift off the surface, metres
	Patch patches[PATCHES_MOST];
};

// Whether anything of a patch is above the horizon of (p, n), seen from its front.
bool patch_shines(Patch patch_, vec3 p, vec3 n)
{
	vec3 to = patch_.centre.xyz - p;
	float reach = abs(dot(n, patch_.u.xyz)) + abs(dot(n, patch_.v.xyz));

	return dot(to, patch_.normal.xyz) < 0.0 && dot(n, to) + reach > 0.0;
}

// One bit for each patch that shines on (p, n). The loop's length is fixed so that
// it is unrolled, and software then reads each patch once and not once a pixel.
uint patches_that_shine(vec3 p, vec3 n)
{
	uint bits = 0u;

	for (int i = 0; i < PATCHES_MOST; i++)
		bits |= i < patch_count.x && patch_shines(patches[i], p, n) ? 1u << i : 0u;
	return bits;
}

// Integral of an edge of a spherical polygon, z part: angle times unit normal.
// theta / (2 pi sin(theta)) is the fit of Heitz, Dupuy, Hill and Neubelt (2016),
// good to 2e-6.
float patch_edge(vec3 a, vec3 b)
{
	float x = dot(a, b);
	float y = abs(x);
	float fit = (0.8543985 + (0.4965155 + 0.0145206 * y) * y) /
		    (3.4175940 + (4.1616724 + y) * y);
	float angle_over_sine = x > 0.0 ? fit : 0.5 * inversesqrt(max(1.0 - x * x, 1e-7)) - fit;

	return (a.x * b.y - a.y * b.x) * angle_over_sine;
}

// Any two directions across n, and n, as rows.
mat3 patch_frame(vec3 n)
{
	vec3 helper = abs(n.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0);
	vec3 tangent = normalize(cross(helper, n));

	return transpose(mat3(tangent, cross(n, tangent), n));
}

// Lambert's polygon formula: share of the cosine-weighted hemisphere over
// (p, n) that the rectangle covers, 0..1; cut at the horizon. frame: of n.
float patch_form_factor(Patch patch_, vec3 p, mat3 frame_n)
{
	vec3 to = patch_.centre.xyz - p;

	vec3 c = frame_n * to, u = frame_n * patch_.u.xyz, v = frame_n * patch_.v.xyz;
	float reach = abs(u.z) + abs(v.z);
	bool seen = dot(to, patch_.normal.xyz) < 0.0 && c.z + reach > 0.0;
	vec3 corners[4] = vec3[4](c - u - v, c + u - v, c + u + v, c - u + v);
	vec3 leaves = vec3(0.0), enters = vec3(0.0);
	vec3 a = normalize(corners[0]), b = normalize(corners[1]);
	vec3 d = normalize(corners[2]), e = normalize(corners[3]);
	float sum = patch_edge(a, b) + patch_edge(b, d) + patch_edge(d, e) + patch_edge(e, a);
	// a loop and not a branch: software runs both sides of a branch
	bool whole = c.z - reach >= 0.0;
	int edges = whole || !seen ? 0 : 4;

	sum = whole ? sum : 0.0;
	for (int i = 0; i < edges; i++) {
		vec3 from = corners[i], to_ = corners[(i + 1) & 3];

		if (from.z <= 0.0 && to_.z <= 0.0)
			continue;
		if (from.z < 0.0) {
			from = mix(from, to_, from.z / (from.z - to_.z));
			enters = normalize(from);
		} else if (to_.z < 0.0) {
			to_ = mix(from, to_, from.z / (from.z - to_.z));
			leaves = normalize(to_);
		}
		sum += patch_edge(normalize(from), normalize(to_));
	}
	// along the horizon, back to where the first edge came up; 0 when none was cut
	sum += patch_edge(leaves, enters);
	return seen ? abs(sum) : 0.0;
}
