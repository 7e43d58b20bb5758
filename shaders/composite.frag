#version 450
// SPDX-License-Identifier: MIT
// composite.frag: the fluid's surface over the scene (Bagar 2010, eqs 2.18 and 2.19). in: scene colour and depth,
// surface depth (m) and unit normal (eye space), thickness (m); out: linear colour.
#include "common.glsl"
#include "environment.glsl"

uniform sampler2D t_scene_color;
uniform sampler2D t_scene_depth;
uniform sampler2D t_depth;
uniform sampler2D t_normal;
uniform sampler2D t_thickness;
uniform float u_gamma;       // image heights a metre
uniform float u_attenuation; // 1/m
uniform float u_specular;
uniform float u_shininess;
uniform float u_r0;
uniform int u_fresnel;       // 0: Schlick, 1: exact
uniform int u_refraction;    // 0: offset, 1: Snell
uniform int u_reject;
uniform int u_reflection;    // 0: sky, 1: scene
uniform int u_single;

layout(location = 0) out vec4 o_color;

float fresnel(float cosine)
{
    float ior = frame.absorption.w, one = 1.0 - cosine;
    if (u_fresnel == 0) return u_r0 + (1.0 - u_r0) * one * one * one * one * one;
    float inside = sqrt(ior * ior - 1.0 + cosine * cosine); // ior times the cosine inside the fluid
    float across = (cosine - inside) / max(cosine + inside, 1e-20); // 0 / 0 for index 1 at grazing angles
    float along = (ior * ior * cosine - inside) / max(ior * ior * cosine + inside, 1e-20);
    return 0.5 * (across * across + along * along);
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

vec3 refracted(float z, vec2 by)
{
    vec2 at = clamp(gl_FragCoord.xy + by, vec2(0), frame.image.xy);
    float behind = fetch(t_scene_depth, ivec2(floor(at))).x;
    if (u_reject != 0 && behind > z) at = gl_FragCoord.xy;
    return fetch_linear(t_scene_color, at).rgb;
}

vec3 reflected(vec3 n, vec3 view, vec3 position)
{
    vec3 dir = normalize(world_from_eye(2.0 * dot(n, view) * n - view));
    float t;
    if (u_reflection == 0) return sky(dir);
    return trace(world_from_eye(position), dir, t);
}

float highlight(vec3 n, vec3 view)
{
    vec3 world = world_from_eye(n);
    if (dot(world, frame.light.xyz) <= 0.0) return 0.0; // also where view and light are opposite, with no middle
    vec3 middle = normalize(world_from_eye(view) + frame.light.xyz);
    return frame.light.w * u_specular * pow(max(dot(world, middle), 0.0), u_shininess);
}

void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    float z = fetch(t_depth, p).x;
    if (!is_surface(z)) discard; // the scene shows
    vec3 position = vec3(slope_at(gl_FragCoord.xy) * -z, z), view = normalize(-position);
    vec3 n = fetch(t_normal, p).xyz;
    float thickness = fetch(t_thickness, p).x, cosine = clamp(dot(n, view), 0.0, 1.0);
    vec3 behind = refracted(z, shift(n, view, position, cosine, thickness));
    vec3 k = u_single != 0 ? vec3(u_attenuation) : frame.absorption.rgb;
    behind = mix(frame.fluid.rgb, behind, exp(-k * thickness));
    o_color = vec4(mix(behind, reflected(n, view, position), fresnel(cosine)) + highlight(n, view), 1.0);
}
