#version 450
// SPDX-License-Identifier: MIT
// composite.frag: the fluid's surface over the scene (Bagar 2010, eqs 2.18 and 2.19). in: scene colour and depth,
// surface depth (m) and unit normal (eye space), thickness (m); out: linear colour.
#include "common.glsl"
#include "environment.glsl"
#include "optics.glsl"

uniform sampler2D t_thickness;
uniform float u_gamma;       // image heights a metre
uniform float u_r0;
uniform int u_fresnel;       // 0: Schlick, 1: exact
uniform int u_refraction;    // 0: offset, 1: Snell

layout(location = 0) out vec4 o_color;

float fresnel(float cosine)
{
    float one = 1.0 - cosine;
    if (u_fresnel == 0) return u_r0 + (1.0 - u_r0) * one * one * one * one * one;
    return fresnel_exact(cosine);
}

// Where the light from behind the fluid comes from, as a shift in pixels.
vec2 shift(vec3 n, vec3 view, vec3 position, float cosine, float thickness)
{
    if (u_refraction == 0) return u_gamma * thickness * frame.image.y * vec2(n.x, -n.y);
    float eta = 1.0 / frame.absorption.w;
    float bend = eta * cosine - sqrt(1.0 - eta * eta * (1.0 - cosine * cosine));
    vec3 q = position + thickness * (bend * n - eta * view);
    q.z = min(q.z, -frame.horizon.w);
    vec2 way = (q.xy / -q.z - position.xy / -position.z) / frame.image.zw;
    return vec2(way.x, -way.y);
}

void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    float z = fetch(t_depth, p).x;
    if (!is_surface(z)) discard; // the scene shows
    vec3 position = vec3(slope_at(gl_FragCoord.xy) * -z, z), view = normalize(-position);
    vec3 n = fetch(t_normal, p).xyz;
    float thickness = value_at(t_thickness, p, THICKEST), cosine = clamp(dot(n, view), 0.0, 1.0);
    vec3 behind = refracted(z, shift(n, view, position, cosine, thickness));
    behind = mix(frame.fluid.rgb, behind, through_water(thickness));
    o_color = vec4(mix(behind, reflected(n, view, position), fresnel(cosine)) + highlight(n, view), 1.0);
}
