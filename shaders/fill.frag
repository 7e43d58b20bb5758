/* SPDX-License-Identifier: MIT */
/* fill.frag: in: u_colour; out: o_colour = u_colour in every pixel. */
#version 450 core

uniform vec4 u_colour;
layout(location = 0) out vec4 o_colour;

void main()
{
    o_colour = u_colour;
}
