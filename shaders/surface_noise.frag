#version 450
// SPDX-License-Identifier: MIT
// surface_noise.frag: the particle's own gradient noise, Gaussian over its sprite, fading below the surface; summed by
// blending. in: depth, m; out: noise.
#include "common.glsl"
#include "perlin.glsl"
#include "splat.glsl"

layout(std430, binding = 3) readonly buffer Ids { uint ids[]; };

uniform sampler2D t_depth; // m, frontmost surface
uniform float u_frequency;
uniform float u_sharpness;
uniform float u_falloff;   // 1/m
uniform int u_has_ids;

layout(location = 0) out float o_noise;

void main()
{
    Fragment f = meet_sphere();
    float surface = fetch(t_depth, ivec2(gl_FragCoord.xy)).x;
    if (!is_surface(surface)) discard;
    float weight = exp(-u_sharpness * f.r2 - u_falloff * max(surface - f.front, 0.0));
    uint seed = u_has_ids != 0 ? ids[v_particle] : v_particle;
    o_noise = weight * perlin(u_frequency * f.at, seed);
}
