// Probes on a grid (struct surfel_probes in renderer/gi/surfel_set.h), x fastest.
layout(std140, binding = 8) uniform Probes {
	vec4 origin;  // of the first probe; w: metres between probes
	ivec4 size;   // w: tiles in a row of the distance maps
	vec4 texel;   // xy: 1 / texels of the distance maps
} probes;

#define PROBE_SH 9
