#version 450
// SPDX-License-Identifier: MIT
// copy.frag: t_image, of whatever format, pixel by pixel; an image of one pixel fills the target.
#include "common.glsl"

uniform sampler2D t_image;

layout(location = 0) out vec4 o_image;

void main()
{
    o_image = fetch(t_image, ivec2(gl_FragCoord.xy));
}
