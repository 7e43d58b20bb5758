// SPDX-License-Identifier: MIT
// streak.glsl: where this pixel's ray meets the particle's quad. The twin is libssfr/passes/streak_cpu.c.

flat in vec3 v_centre; // m, eye space
flat in vec3 v_along;  // unit vectors
flat in vec3 v_across;
flat in vec2 v_half;   // m, half axes; the second is the radius
#ifdef PARTICLE
flat in uint v_particle;
#endif
#include "root.glsl"

struct Fragment {
    vec2 at;     // place on the quad, along and across, in half axes
    float r2;    // |at|^2
    float front; // m, eye-space z
    float back;
    float chord; // m
    float area;  // of the quad in the image, in that of its square
};

// Discards where there is none.
Fragment meet_quad()
{
    Fragment f;
    float near = frame.horizon.w;
    vec3 d = vec3(slope_at(gl_FragCoord.xy), -1.0), normal = cross(v_along, v_across);
    float height = dot(normal, v_centre), t = height / dot(normal, d);
    vec3 p = t * d - v_centre;
    f.at = vec2(dot(p, v_along), dot(p, v_across)) / v_half;
    f.r2 = dot(f.at, f.at);
    if (!(t >= near && f.r2 <= 1.0)) discard; // of planes along the ray nothing is met: comparisons with NaN fail
    float rise = v_half.y * root(1.0 - f.r2);
    f.front = -t + rise;
    f.back = -t - rise;
    f.chord = 2.0 * rise;
    f.area = v_half.x / v_half.y * abs(height / v_centre.z);
    if (f.front > -near) { // what the ray sees of it begins at the near plane
        f.chord *= (-near - f.back) / (f.front - f.back);
        f.front = -near;
    }
    return f;
}
