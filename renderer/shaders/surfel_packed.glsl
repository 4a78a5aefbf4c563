// A colour in 32 bits: three mantissas of 9 bits and an exponent of 5, counted
// down from a scale that a whole slice has, so that the range of the light in a
// room fits whatever its unit. Integer arithmetic and exact products only: all
// GPUs round alike. With scale s and exponent field e a mantissa m is worth
// m 2^(s + e - 166); e 31: not finite.
const uint PACKED_BAD = 31u << 27;

// Bits of a positive float that are kept are rounded; its exponent after that, plus 1.
uint packed_exponent(uint bits)
{
	return ((bits + 0x4000u) >> 23) + 1u;
}

uint packed_mantissa(float value, uint exponent)
{
	uint bits = floatBitsToUint(value) & 0x7fffffffu;
	uint own = bits >> 23;

	if (own == 0u)
		return 0u;
	uint shift = exponent - own + 14u;
	uint whole = (bits & 0x7fffffu) | 0x800000u;

	return shift > 25u ? 0u : min((whole + (1u << (shift - 1u))) >> shift, 511u);
}

// Light is not negative: what is, was rounded below nothing and counts as nothing.
uint packed_colour(vec3 c, uint scale)
{
	if (any(isnan(c)) || any(isinf(c)))
		return PACKED_BAD;
	c = mix(c, vec3(0.0), lessThan(c, vec3(0.0)));
	uint most = floatBitsToUint(max(max(c.r, c.g), c.b));
	uint exponent = clamp(packed_exponent(most), max(scale, 31u) - 30u, scale);

	return packed_mantissa(c.r, exponent) | packed_mantissa(c.g, exponent) << 9 |
	       packed_mantissa(c.b, exponent) << 18 | (exponent + 30u - max(scale, 30u)) << 27;
}

vec3 unpacked_colour(uint word, uint scale)
{
	if (word >= PACKED_BAD)
		return vec3(uintBitsToFloat(0x7fc00000u));
	int power = int(max(scale, 30u)) + int(word >> 27) - 39;
	float unit = uintBitsToFloat(power > 0 ? uint(power) << 23 : 0u);

	return unit * vec3(float(word & 511u), float((word >> 9) & 511u), float((word >> 18) & 511u));
}
