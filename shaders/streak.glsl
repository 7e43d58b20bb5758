// SPDX-License-Identifier: MIT
// streak.glsl: where this pixel's ray meets the particle's quad. The twin is libssfr/passes/streak_cpu.c.

flat in vec3 v_centre; // m, eye space
flat in vec3 v_along;  // unit vectors
flat in vec3 v_across;
flat in vec2 v_half;   // m, half axes; the second is the radius
#ifdef PARTICLE
flat in uint v_particle;
#endif
#include "fragment.glsl"
#include "root.glsl"

// Discards where there is none.
Fragment meet_quad()
{
    Fragment f;
    vec3 d = vec3(slope_at(gl_FragCoord.xy), -1.0), normal = cross(v_along, v_across);
    float height = dot(normal, v_centre), t = height / dot(normal, d);
    vec3 p = t * d - v_centre;
    f.at = vec2(dot(p, v_along), dot(p, v_across)) / v_half;
    f.r2 = dot(f.at, f.at);
    // Of planes along the ray nothing is met: comparisons with NaN fail.
    if (!(t >= frame.horizon.w && f.r2 <= 1.0)) discard;
    float rise = v_half.y * root(1.0 - f.r2);
    f.front = -t + rise;
    f.back = -t - rise;
    f.chord = 2.0 * rise;
    f.area = v_half.x / v_half.y * abs(height / v_centre.z);
    cut_front(f);
    return f;
}
