// SPDX-License-Identifier: MIT
// splat.glsl: where this pixel's ray meets the particle's sphere. The twin is libssfr/passes/splat_cpu.c.

#ifdef SIZES
flat in float v_radius; // m
#define RADIUS v_radius
#else
uniform float u_radius; // m
#define RADIUS u_radius
#endif

#ifdef EXACT
flat in vec3 v_centre;
#else
flat in vec4 v_disc;
flat in float v_z;
#endif
#ifdef POINT
uniform float u_max_point_px;
#endif
#ifdef PARTICLE
flat in uint v_particle;
#endif
#ifndef EXACT
#include "root.glsl"
#endif
#include "fragment.glsl"

// Discards where there is none.
Fragment meet_sphere()
{
    Fragment f;
#ifdef EXACT
    // The point of the ray nearest to the centre: the quadratic formula's discriminant cancels for far spheres.
    vec3 d = vec3(slope_at(gl_FragCoord.xy), -1.0);
    float dd = dot(d, d), t = dot(d, v_centre) / dd;
    vec3 p = t * d - v_centre;
    float r = length(p);
    if (r > RADIUS) discard;
    float rise = sqrt((RADIUS - r) * (RADIUS + r) / dd);
    f.at = vec2(p.x, -p.y) / RADIUS;
    f.r2 = r / RADIUS * (r / RADIUS);
    f.front = -(t - rise);
    f.back = -(t + rise);
    f.chord = 2.0 * rise * sqrt(dd);
#else
    vec2 away = gl_FragCoord.xy - v_disc.xy;
    f.at = away / v_disc.zw;
    f.r2 = dot(f.at, f.at);
    if (f.r2 > 1.0) discard;
#ifdef POINT
    float side = min(2.0 * max(v_disc.z, v_disc.w) + 2.0, u_max_point_px);
    if (2.0 * max(abs(away.x), abs(away.y)) > side) discard;
#endif
    float rise = RADIUS * root(1.0 - f.r2);
    f.front = v_z + rise;
    f.back = v_z - rise;
    f.chord = 2.0 * rise;
#endif
    f.area = 1.0;
    cut_front(f);
    return f;
}
