#version 450
// SPDX-License-Identifier: MIT
// shadow_map.frag: where the light meets solids first. out: m from the eye towards the light; empty for none.
#include "common.glsl"
#include "environment.glsl"
#include "light_view.glsl"

uniform float u_texel; // m

layout(location = 0) out float o_light_depth;

void main() { o_light_depth = first_caster(u_corner + gl_FragCoord.xy * u_texel); }
