#version 450
// SPDX-License-Identifier: MIT
// curvature_flow.frag: one Euler step of z_t = -H (Bagar 2010, eqs 2.8 to 2.16). in: eye-space depth, m; out: the same.
#include "common.glsl"
#include "curvature_flow.glsl"

layout(location = 0) out float o_smooth;

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    float z = fetch(t_depth, at).x;
    if (!is_surface(z)) discard;
    o_smooth = z + flow_dt(z, u_dt) * flow_rate(at, z, z);
}
