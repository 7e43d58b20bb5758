// SPDX-License-Identifier: MIT
// perlin.glsl: gradient noise of two and three dimensions. The twin is libssfr/passes/perlin.c.

uint lattice_hash(ivec3 p, uint seed)
{
    uint h = uint(p.x) * 0x9e3779b1u + uint(p.y) * 0x85ebca77u + uint(p.z) * 0x27d4eb2fu + seed * 0xc2b2ae3du;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    return h ^ h >> 15;
}

// A number in [0, 1) for a seed.
float lattice_share(uint seed) { return float(lattice_hash(ivec3(1, 0, 0), seed) >> 8) / 16777216.0; }

vec2 fade(vec2 t) { return t * t * t * (t * (6.0 * t - 15.0) + 10.0); }
vec3 fade(vec3 t) { return t * t * t * (t * (6.0 * t - 15.0) + 10.0); }

float lean(ivec2 p, uint seed, vec2 d)
{
    const float h = 0.70710678118654752440;
    const vec2 gradients[8] = vec2[](vec2(1, 0), vec2(-1, 0), vec2(0, 1), vec2(0, -1), vec2(h, h), vec2(-h, h),
                                     vec2(h, -h), vec2(-h, -h));
    return dot(gradients[lattice_hash(ivec3(p, 0), seed) & 7u], d);
}

// In lattice cells; mean 0.
float perlin(vec2 p, uint seed)
{
    ivec2 i = ivec2(floor(p));
    vec2 f = p - vec2(i), w = fade(f);
    float above = mix(lean(i, seed, f), lean(i + ivec2(1, 0), seed, f - vec2(1, 0)), w.x);
    float below = mix(lean(i + ivec2(0, 1), seed, f - vec2(0, 1)), lean(i + ivec2(1, 1), seed, f - vec2(1, 1)), w.x);
    return mix(above, below, w.y);
}

const int FOAM_CELLS = 8; // SSFR_FOAM_CELLS of perlin.h

// Of one corner of the cell that begins at lattice point i; f: the place in the cell.
float lean(ivec3 i, ivec3 side, vec3 f, uint seed)
{
    vec3 d = f - vec3(side);
    uint h = lattice_hash((i + side) % FOAM_CELLS, seed) & 15u;
    float u = h < 8u ? d.x : d.y, v = h < 4u ? d.y : h == 12u || h == 14u ? d.x : d.z;
    return ((h & 1u) != 0u ? -u : u) + ((h & 2u) != 0u ? -v : v);
}

// In [0, 1], of period 1; mean 1/2.
float foam_noise(vec3 place, uint seed)
{
    vec3 p = float(FOAM_CELLS) * fract(place), f = fract(p), w = fade(f);
    ivec3 i = ivec3(p);
    vec4 low, high; // at both ends of the cell's four edges along x
    for (int k = 0; k < 4; k++) {
        low[k] = lean(i, ivec3(0, k & 1, k >> 1), f, seed);
        high[k] = lean(i, ivec3(1, k & 1, k >> 1), f, seed);
    }
    vec4 along = mix(low, high, w.x);
    vec2 across = mix(along.xz, along.yw, w.y);
    return 0.5 + mix(across.x, across.y, w.z) / (2.0 * 1.0363538113); // SSFR_PERLIN_LARGEST
}
