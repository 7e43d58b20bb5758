#version 450
// SPDX-License-Identifier: MIT
// adaptive_flow.frag: one Euler step of the curvature flow where the surface's distance asks for it (Bagar 2010,
// eq. 3.1, listings A.12 and A.13). in: eye-space depth, m; out: the same.
#include "common.glsl"
#include "curvature_flow.glsl"

const int PAPER = 0, METRES = 1; // as SSFR_ADAPTIVE_FLOW_* in adaptive_flow.h

layout(binding = 1) uniform sampler2D t_first; // the depth before the first step
layout(location = 0) uniform ivec4 u_tile;     // as in tiles.vert
uniform float u_need;      // of a surface at 1 m: further steps (PAPER), or the sum of their dt (METRES)
uniform float u_threshold; // m, greatest z that enters H
uniform int u_constant, u_by_first, u_over_depth;
uniform int u_most;        // steps that any pixel takes
uniform int u_parts;       // of them each step of the parameters is cut into so many

layout(location = 0) out float o_smooth;

// The share of a step that a surface at z takes now.
float share(float z, float dt)
{
    float i = float(u_step.x);
    if (u_step.x >= u_most) return 0.0;
    if (u_constant == PAPER) return float(u_step.x / u_parts) <= u_need / abs(z) + 1.0 ? 1.0 : 0.0;
    if (u_constant == METRES) return clamp(u_need / (abs(z) * dt) - i, 0.0, 1.0);
    return 1.0;
}

#ifdef LIVE_TILES
// A tile in which no pixel takes a step is done: the next would find it the same. The first two steps are taken
// wherever there is a surface, so that it stands in both images.
void keep_alive()
{
    ivec2 tile = ivec2(gl_FragCoord.xy) / u_tile.x;
    int k = tile.y * ((u_tile.z + u_tile.x - 1) / u_tile.x) + tile.x;
    uint next = uint(u_step.x + 1);
    if (live[k] != next && atomicExchange(live[k], next) != next) atomicAdd(n_live, 1u);
}
#endif

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    float here = fetch(t_depth, at).x;
    if (!is_surface(here)) discard;
    float z = min(here, u_threshold);
    float dt = flow_dt(z, u_over_depth != 0 ? u_dt / abs(z) : u_dt);
    float part = share(u_by_first != 0 ? fetch(t_first, at).x : here, dt);
#ifdef LIVE_TILES
    if ((part > 0.0 || u_step.x == 0) && u_step.x + 1 < u_most) keep_alive();
#endif
    if (part > 0.0) o_smooth = here + part * (dt * flow_rate(at, here, z));
    else if (u_step.y != 0) discard;
    else o_smooth = here;
}
