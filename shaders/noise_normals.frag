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

void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    float z = fetch(t_depth, p).x;
    if (!is_surface(z)) discard;
    float dx = fetch(t_noise, p + ivec2(1, 0)).x - fetch(t_noise, p - ivec2(1, 0)).x;
    float dy = fetch(t_noise, p - ivec2(0, 1)).x - fetch(t_noise, p + ivec2(0, 1)).x; // upwards
    vec3 normal = fetch(t_normal, p).xyz;
    // Waves of height 0 are the identity to the last bit: leaving this pass out must change nothing.
    o_shading_normal = u_height == 0.0 ? vec4(normal, 0.0) : vec4(normalize(normal - vec3(u_height * vec2(dx, dy) / (2.0 * u_c * abs(z)), 0.0)), 0.0);
}
