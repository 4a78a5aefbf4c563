/*
 * Numbers as a person writes them, for messages: no exponent, no digits that
 * mean nothing. Thread safe.
 */
#ifndef GROTTO_BASE_PLAIN_H
#define GROTTO_BASE_PLAIN_H

#define GR_PLAIN_SIZE 32

struct gr_plain {
	char text[GR_PLAIN_SIZE];
};

/*
 * value rounded to `digits` (1..15) significant ones: 110, 1073741824, 0.00021,
 * 12.5. Zeros after the point are left out. From 1e15 on, and below 1e-9, with
 * an exponent after all; what is not finite is "nan", "inf" or "-inf".
 */
struct gr_plain gr_plain(double value, int digits);
/* A share as percent, to two digits or to whole percents: "3.1 %", "0.42 %", "110 %". */
struct gr_plain gr_plain_percent(double share);

#endif
