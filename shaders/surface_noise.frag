#version 450
// SPDX-License-Identifier: MIT
// surface_noise.frag: the particle's own gradient noise, Gaussian over its sprite, fading below the surface; summed by
// blending. in: depth, m; out: noise.
#include "common.glsl"
#include "splat.glsl"

layout(std430, binding = 3) readonly buffer Ids { uint ids[]; };

uniform sampler2D t_depth; // m, frontmost surface
uniform float u_frequency;
uniform float u_sharpness;
uniform float u_falloff;   // 1/m
uniform int u_has_ids;

layout(location = 0) out float o_noise;

uint hash(uint x, uint y, uint seed)
{
    uint h = x * 0x9e3779b1u + y * 0x85ebca77u + seed * 0xc2b2ae3du;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    return h ^ h >> 15;
}

float lean(ivec2 p, uint seed, vec2 d)
{
    const float h = 0.70710678118654752440;
    const vec2 gradients[8] = vec2[](vec2(1, 0), vec2(-1, 0), vec2(0, 1), vec2(0, -1), vec2(h, h), vec2(-h, h),
                                     vec2(h, -h), vec2(-h, -h));
    return dot(gradients[hash(uint(p.x), uint(p.y), seed) & 7u], d);
}

float perlin(vec2 p, uint seed)
{
    ivec2 i = ivec2(floor(p));
    vec2 f = p - vec2(i), w = f * f * f * (f * (6.0 * f - 15.0) + 10.0);
    float above = mix(lean(i, seed, f), lean(i + ivec2(1, 0), seed, f - vec2(1, 0)), w.x);
    float below = mix(lean(i + ivec2(0, 1), seed, f - vec2(0, 1)), lean(i + ivec2(1, 1), seed, f - vec2(1, 1)), w.x);
    return mix(above, below, w.y);
}

void main()
{
    Fragment f = meet_sphere();
    float surface = fetch(t_depth, ivec2(gl_FragCoord.xy)).x;
    if (!is_surface(surface)) discard;
    float weight = exp(-u_sharpness * f.r2 - u_falloff * max(surface - f.front, 0.0));
    uint seed = u_has_ids != 0 ? ids[v_particle] : v_particle;
    o_noise = weight * perlin(u_frequency * f.at, seed);
}
