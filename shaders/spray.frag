#version 450
// SPDX-License-Identifier: MIT
// spray.frag: what a spray particle adds to the picture (Bagar 2010, sec. 4.9.5): colour e^(-falloff r^2), linear,
// summed by blending over what is there.
#include "common.glsl"
#include "streak.glsl"

uniform sampler2D t_scene_depth;
uniform sampler2D t_depth;      // of the water, m
uniform sampler2D t_foam_depth; // m
uniform vec3 u_color;
uniform float u_falloff;
uniform int u_exponential; // in r, else in r^2
uniform int u_by_surface;  // water and foam hide it too

layout(location = 0) out vec4 o_color;

void main()
{
    Fragment f = meet_quad();
    ivec2 p = ivec2(gl_FragCoord.xy);
    float before = fetch(t_scene_depth, p).x;
    if (u_by_surface != 0) before = max(before, max(fetch(t_depth, p).x, fetch(t_foam_depth, p).x));
    if (f.front < before) discard;
    o_color = vec4(u_color * exp(-u_falloff * (u_exponential != 0 ? sqrt(f.r2) : f.r2)), 0.0);
}
