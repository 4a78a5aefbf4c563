/*
 * The 26 directions of the lattice and the solid angles around them.
 *
 * A cell's light is a directional distribution of flux psi(w) [W/sr] in two
 * spherical-harmonics bands, kept as the flux F [W] and the flux vector
 * V [W]: psi(w) = (F + 3 V.w) / 4 pi. (In orthonormal SH: c0 = F Y0,
 * c1 = V Y1.) The sphere is cut into the 26 sets of directions that are
 * nearest to one neighbour's direction. By symmetry there are three kinds:
 * towards a face (6), an edge (12), a corner (8).
 *
 * What goes towards neighbour j is the exact integral over its sector,
 *   Phi_j = a F + b (J.V),   a = Omega/4pi, b = 3 mu Omega/4pi,
 * and arrives as a lobe of the shape of that sector:
 *   F += Phi_j,  V += mu Phi_j J       (J: unit vector towards j,
 *                                       mu: mean of w.J over the sector).
 * Sum over j of Phi_j is F, so energy is kept by construction and no scale
 * factor has to be searched for (cf. seed 004 section 3.2.2).
 *
 * Thread safe: pure functions.
 */
#ifndef GROTTO_RENDERER_GI_SECTORS_H
#define GROTTO_RENDERER_GI_SECTORS_H

#define SECTOR_COUNT 26
#define SECTOR_KINDS 3 /* face, edge, corner: by the number of non-zero offsets */

/* Offset (-1..1 each) of neighbour j; j and SECTOR_COUNT - 1 - j are opposite. */
extern const signed char sector_offset[SECTOR_COUNT][3];

static inline int sector_kind(int j)
{
	const signed char *o = sector_offset[j];

	return o[0] * o[0] + o[1] * o[1] + o[2] * o[2] - 1;
}

struct sectors {
	double omega[SECTOR_KINDS]; /* solid angle of one sector, sr */
	double mu[SECTOR_KINDS];    /* mean cosine to the sector's axis */
	double a[SECTOR_KINDS], b[SECTOR_KINDS];
	/*
	 * Irradiance on a plane of normal n from the hops that cross it, for cells
	 * of side d: E = (look_f F/4 - look_v (V.n)/2) / d^2. A hop carries Phi_j
	 * over j.d, so E = sum of Phi_j max(-n.j, 0)/d^2, taken for n along an
	 * axis. For an even field E = pi L with L = look_f psi/d^2.
	 */
	double look_f, look_v;
	/*
	 * Flux vector of light that leaves a surface, per flux. The cosine lobe has
	 * 2/3, but cut to two bands it sends a negative flux back into its own
	 * wall; this one sends exactly none.
	 */
	double lobe;
};

void sectors_init(struct sectors *out);

/*
 * Medium for cells of side d (metres), sigma in 1/m as a probability per
 * metre (seed 004 section 3.3.2): what a metre lets through is 1 - sigma_t,
 * a hop of length l lets (1 - sigma_t)^l through. sigma_t >= 1 lets nothing
 * through. What is scattered goes evenly to all directions.
 */
struct sector_medium {
	double a[SECTOR_KINDS], b[SECTOR_KINDS]; /* as in struct sectors, medium folded in */
	double keep_f, keep_v; /* on F and V of the light that meets a wall within the hop */
};
void sectors_medium(const struct sectors *sectors, double absorption_per_m,
		    double scattering_per_m, double d, struct sector_medium *out);
/* (1 - sigma)^metres: what the medium lets through, for direct light, too. */
double medium_transmittance(double sigma_per_m, double metres);

#endif
