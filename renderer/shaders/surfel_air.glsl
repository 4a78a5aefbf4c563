// Light that was fixed at baking, in air that takes more (or less) than it did then.
// way: mean and variance, in metres, of how far it has come, as if such lengths had a
// gamma distribution: then the rest of it is (1 + more variance/mean)^(-mean^2/variance).
// more: 1/m. As surfel_thinned (renderer/gi/surfel_set.c).
float surfel_thinned(vec2 way, float more)
{
	float spread = way.y / max(way.x, 1e-30); // metres

	if (more == 0.0)
		return 1.0;
	// the logarithm's first terms, where lengths are nearly one
	if (spread * abs(more) < 1e-3)
		return exp(-more * way.x * (1.0 - 0.5 * spread * more));
	// air is taken away: how much light there was can be told so far
	return pow(max(1.0 + more * spread, 0.25), -way.x / spread);
}
