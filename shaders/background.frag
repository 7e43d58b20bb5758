#version 450
// SPDX-License-Identifier: MIT
// background.frag: the scene without the fluid. out: color, eye-space z (m; empty for the sky).
#include "common.glsl"
#include "environment.glsl"

layout(location = 0) out vec4 o_color;
layout(location = 1) out float o_depth;

void main()
{
    float t;
    vec3 dir = world_from_eye(vec3(slope_at(gl_FragCoord.xy), -1.0));
    o_color = vec4(trace(vec3(0), dir, t), 1.0);
    o_depth = -t;
}
