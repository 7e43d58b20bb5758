#version 450
// SPDX-License-Identifier: MIT
// upsample.frag: low-resolution depth (m) at full resolution, inside the outline of the guide.
#include "common.glsl"

uniform sampler2D t_depth; // low resolution
uniform sampler2D t_guide; // of the output's resolution, unsmoothed
uniform float u_falloff;   // m
uniform int u_factor;
uniform int u_filter;      // 0 nearest, 1 linear, 2 cubic B-spline

layout(location = 0) out float o_surface;

vec4 weigh(float t)
{
    if (u_filter == 1) return vec4(1.0 - t, t, 0.0, 0.0);
    float s = 1.0 - t;
    float w1 = 3.0 * t * t * t - 6.0 * t * t + 4.0, w2 = -3.0 * t * t * t + 3.0 * t * t + 3.0 * t + 1.0;
    return vec4(s * s * s, w1, w2, t * t * t) / 6.0;
}

float interpolate(float guide, vec2 p)
{
    int n = u_filter == 2 ? 4 : 2, before = u_filter == 2 ? 1 : 0;
    ivec2 p0 = ivec2(floor(p));
    vec4 wx = weigh(p.x - floor(p.x)), wy = weigh(p.y - floor(p.y));
    float sum = 0.0, weight = 0.0;
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++) {
            float z = fetch(t_depth, p0 - before + ivec2(i, j)).x;
            if (!is_surface(z) || abs(z - guide) > u_falloff) continue;
            sum += wx[i] * wy[j] * (z - guide); // relative: fewer digits are lost
            weight += wx[i] * wy[j];
        }
    return weight > 0.0 ? guide + sum / weight : guide;
}

void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    float guide = fetch(t_guide, p).x, z;
    if (!is_surface(guide)) discard;
    if (u_filter == 0) z = fetch(t_depth, p / u_factor).x;
    else z = interpolate(guide, gl_FragCoord.xy / float(u_factor) - 0.5);
    o_surface = is_surface(z) ? z : guide;
}
