#version 450
// SPDX-License-Identifier: MIT
// adaptive_flow.frag: one Euler step of the curvature flow where the surface's distance asks for it (Bagar 2010,
// eq. 3.1, listings A.12 and A.13). in: eye-space depth, m; out: the same.
#include "common.glsl"
#include "curvature_flow.glsl"

const int PAPER = 0, METRES = 1; // as SSFR_ADAPTIVE_FLOW_* in adaptive_flow.h

layout(binding = 1) uniform sampler2D t_first; // the depth before the first step
layout(location = 1) uniform ivec2 u_step;     // number of the step from 0; 1: pixels that it leaves are not written
uniform float u_need;      // of a surface at 1 m: further steps (PAPER), or the sum of their dt (METRES)
uniform float u_threshold; // m, greatest z that enters H
uniform int u_constant, u_by_first, u_over_depth;
uniform int u_most;        // steps that any pixel takes

layout(location = 0) out float o_smooth;

// The share of a step that a surface at z takes now.
float share(float z, float dt)
{
    float i = float(u_step.x);
    if (u_step.x >= u_most) return 0.0;
    if (u_constant == PAPER) return i <= u_need / abs(z) + 1.0 ? 1.0 : 0.0;
    if (u_constant == METRES) return clamp(u_need / (abs(z) * dt) - i, 0.0, 1.0);
    return 1.0;
}

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    float here = fetch(t_depth, at).x;
    if (!is_surface(here)) discard;
    float z = min(here, u_threshold);
    float dt = min(u_over_depth != 0 ? u_dt / abs(z) : u_dt, flow_limit(z));
    float part = share(u_by_first != 0 ? fetch(t_first, at).x : here, dt);
    if (part > 0.0) o_smooth = here + part * (dt * flow_rate(at, here, z));
    else if (u_step.y != 0) discard;
    else o_smooth = here;
}
