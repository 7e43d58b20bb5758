#version 450
// SPDX-License-Identifier: MIT
// thickness.frag: length of the view ray inside the particle (m), summed by blending (Bagar 2010, eqs 2.17 and 3.4).
#include "common.glsl"
#include "splat.glsl"

uniform sampler2D t_scene_depth;
uniform int u_exponential; // kernel: chord e^(-2 r^2) (listing A.15), else the chord
uniform int u_clipped;     // count only what lies before the scene, else all when the front does
uniform float u_scale;

layout(location = 0) out float o_thickness;

void main()
{
    Fragment f = meet_sphere();
    float scene = fetch(t_scene_depth, ivec2(gl_FragCoord.xy)).x;
    if (f.front < scene) discard;
    float t = f.chord * u_scale;
    if (u_exponential != 0) t *= exp(-2.0 * f.r2);
    if (u_clipped != 0) t *= (f.front - max(f.back, scene)) / max(f.front - f.back, 1e-20);
    o_thickness = t;
}
