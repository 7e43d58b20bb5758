#version 450
// SPDX-License-Identifier: MIT
// thickness.frag: length of the view ray inside the particle (m), summed by blending (Bagar 2010, eqs 2.17 and 3.4).
#include "common.glsl"
#include "splat.glsl"
#include "thickness.glsl"

layout(location = 0) out float o_thickness;

void main()
{
    Fragment f = meet_sphere();
    o_thickness = thickness_of(f);
}
