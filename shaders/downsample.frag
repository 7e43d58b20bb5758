#version 450
// SPDX-License-Identifier: MIT
// downsample.frag: eye-space depth (m) of a block of u_factor x u_factor pixels.
#include "common.glsl"

uniform sampler2D t_depth;
uniform int u_factor;
uniform int u_rule; // 0: the pixel right and below of the middle, 1: nearest to the eye, 2: mean of the surface pixels

layout(location = 0) out float o_low;

void main()
{
    ivec2 block = ivec2(gl_FragCoord.xy) * u_factor;
    o_low = -EMPTY;
    if (u_rule == 0) {
        o_low = fetch(t_depth, block + u_factor / 2).x;
        return;
    }
    float sum = 0.0, count = 0.0;
    for (int j = 0; j < u_factor; j++)
        for (int i = 0; i < u_factor; i++) {
            float z = depth_at(t_depth, block + ivec2(i, j));
            if (!is_surface(z)) continue;
            o_low = max(o_low, z);
            sum += z;
            count += 1.0;
        }
    if (u_rule == 2 && count > 0.0) o_low = sum / count;
}
