// Spherical harmonics of a latitude-longitude picture (renderer/view/env_sh.h).
// Of each row the picture's Fourier series as far as the order needs it, then of
// each coefficient the sum over rows with the row's weight, then the turn.
#define SERIES (2 * ORDER - 1) // 1, cos p, sin p, cos 2p, ...
#define PARTS 16               // of a row
layout(std430, binding = 8) buffer Sums { vec4 sums[]; };             // [row][part][SERIES]
layout(std430, binding = 9) readonly buffer Columns { vec2 columns[]; }; // cos, sin of p
layout(std430, binding = 10) readonly buffer Weights { float weights[]; }; // [row][ORDER * ORDER]
layout(std430, binding = 11) buffer Unturned { vec4 unturned[]; };
layout(std430, binding = 12) readonly buffer Turn { float turn[]; }; // bands one after another
layout(std430, binding = 13) buffer Coefficients { vec4 coefficients[]; };
