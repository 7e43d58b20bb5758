#version 450
// SPDX-License-Identifier: MIT
// foam_depth.frag: eye-space z of the foam particle's front at this pixel (m). MAX blending keeps the nearest.
#include "common.glsl"
#include "streak.glsl"

uniform sampler2D t_scene_depth;

layout(location = 0) out float o_depth;

void main()
{
    Fragment f = meet_quad();
    if (f.front < fetch(t_scene_depth, ivec2(gl_FragCoord.xy)).x) discard;
    o_depth = f.front;
}
