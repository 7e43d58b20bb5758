// SPDX-License-Identifier: MIT
// curvature_flow.glsl: the rate of z_t = -H (Bagar 2010, eqs 2.8 to 2.16), and the step that a pixel bears. The twin is
// libssfr/passes/curvature_flow_cpu.c; the formula stands in curvature_flow.c. CROSS_TERM: z_xy by central differences,
// else 0. OFF_AXIS: the surface's own curvature instead of eq. 2.10's. COUNTS: steps beyond the bound are counted.
// LIVE_TILES: tiles.vert leaves out tiles in which nothing changes any more.

uniform sampler2D t_depth;
uniform float u_dt;      // m^2
uniform vec2 u_c;        // eye-space size of a pixel at unit depth
uniform float u_falloff; // m
uniform float u_bound;   // the longest stable dt at |z| = 1, m^2
uniform float u_limit;   // dt is at most this times |z|
uniform float u_divisor; // full-resolution pixels a pixel

layout(location = 1) uniform ivec2 u_step; // number of the step from 0; 1: pixels that it leaves are not written

#if COUNTS || defined(LIVE_TILES)
layout(std430, binding = 7) buffer Words {
    uint n_unstable, n_live; // pixels; tiles in which a step changed something, over all steps
    uint live[];             // of each tile: one more than the last such step
};
#endif

float difference(ivec2 p, float z, inout bool cut)
{
    float d = fetch(t_depth, p).x - z;
    cut = cut || !(abs(d) <= u_falloff);
    return d;
}

// Eye-space x and y at unit distance, y downwards like rows.
vec2 ray_of_pixel() { return (gl_FragCoord.xy * u_divisor - 0.5 * frame.image.xy) * frame.image.zw; }

// By what a limit or a bound at |z| = 1 on the axis is multiplied, m.
float flow_reach(float z)
{
#if OFF_AXIS
    vec2 uv = ray_of_pixel();
    float away = 1.0 + uv.x * uv.x + uv.y * uv.y;
    return abs(z) / (away * sqrt(away));
#else
    return abs(z);
#endif
}

// The step that a pixel at depth z takes of one of dt, m^2.
float flow_dt(float z, float dt)
{
    float reach = flow_reach(z);
#if COUNTS
    if (u_step.x == 0 && dt > u_bound * reach) atomicAdd(n_unstable, 1u);
#endif
    return min(dt, u_limit * reach);
}

// -H of the pixel, whose depth is `here`, and enters as z.
float flow_rate(ivec2 at, float here, float z)
{
    float p = 0.0, q = 0.0, r = 0.0, s = 0.0, t = 0.0;
    bool cut_x = false, cut_y = false;
    float left = difference(at + ivec2(-1, 0), here, cut_x), right = difference(at + ivec2(1, 0), here, cut_x);
    float above = difference(at + ivec2(0, -1), here, cut_y), below = difference(at + ivec2(0, 1), here, cut_y);
    if (!cut_x) {
        p = (right - left) / (2.0 * u_c.x);
        r = (left + right) / (u_c.x * u_c.x);
    }
    if (!cut_y) {
        q = (below - above) / (2.0 * u_c.y);
        s = (above + below) / (u_c.y * u_c.y);
    }
#if CROSS_TERM
    bool cut_xy = cut_x || cut_y;
    float mm = difference(at + ivec2(-1, -1), here, cut_xy), pm = difference(at + ivec2(1, -1), here, cut_xy);
    float mp = difference(at + ivec2(-1, 1), here, cut_xy), pp = difference(at + ivec2(1, 1), here, cut_xy);
    if (!cut_xy) t = (pp - pm - mp + mm) / (4.0 * u_c.x * u_c.y);
#endif
#if OFF_AXIS
    vec2 uv = ray_of_pixel();
    float u = uv.x, v = uv.y, w = z + u * p + v * q, l2 = p * p + q * q + w * w;
    float E = (p * u + z) * (p * u + z) + p * p * (v * v + 1.0);
    float F = (p * u + z) * q * u + p * v * (q * v + z) + p * q;
    float G = (q * v + z) * (q * v + z) + q * q * (u * u + 1.0);
    float L = r * z - 2.0 * p * p, M = t * z - 2.0 * p * q, N = s * z - 2.0 * q * q;
    return -0.5 * sqrt(u_c.x * u_c.y) * abs(z) * (E * N - 2.0 * F * M + G * L) / (z * z * l2 * sqrt(l2));
#else
    float S = p * p + q * q + z * z;
    float x = p * (p * r + q * t + z * p) - r * S, y = q * (p * t + q * s + z * q) - s * S;
    return -(u_c.x * x + u_c.y * y) / (2.0 * S * sqrt(S));
#endif
}
