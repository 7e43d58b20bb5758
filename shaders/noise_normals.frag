#version 450
// SPDX-License-Identifier: MIT
// noise_normals.frag: the unit normal leaning with the slope of the surface noise.
#include "common.glsl"

uniform sampler2D t_normal;
uniform sampler2D t_noise;
uniform sampler2D t_depth; // m
uniform float u_height;    // m
uniform vec2 u_c;

layout(location = 0) out vec4 o_shading_normal;

// The noise's change a pixel along d, one-sided where a neighbour has no surface and so no noise. Noise that is not a
// number has no slope.
float slope(ivec2 p, ivec2 d)
{
    int before = int(is_surface(depth_at(t_depth, p - d))), after = int(is_surface(depth_at(t_depth, p + d)));
    float change = fetch(t_noise, p + after * d).x - fetch(t_noise, p - before * d).x;
    return is_surface(change) ? change / float(max(before + after, 1)) : 0.0;
}

void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    float z = fetch(t_depth, p).x;
    if (!is_surface(z)) discard;
    vec3 normal = fetch(t_normal, p).xyz;
    vec2 lean = u_height * vec2(slope(p, ivec2(1, 0)), slope(p, ivec2(0, -1))) / (u_c * abs(z)); // rows go down, y up
    if (u_height > 0.0) normal -= vec3(lean, 0.0);
    float size = length(normal);
    if (u_height > 0.0 && size > 0.0) normal /= size; // height 0 is the identity to the last bit; no normal stays none
    o_shading_normal = vec4(normal, 0.0);
}
