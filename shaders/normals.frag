#version 450
// SPDX-License-Identifier: MIT
// normals.frag: unit normal in eye space, towards the eye, from eye-space depth (m) by finite differences (Bagar 2010,
// eq. 2.10).
#include "common.glsl"

uniform sampler2D t_depth;
uniform vec2 u_c;
uniform float u_falloff; // m
uniform float u_divisor;
uniform int u_edge;      // 0: the smaller difference at silhouettes, 1: central
uniform int u_off_axis;  // the surface's own normal, else eq. 2.10

layout(location = 0) out vec4 o_normal;

float slope(float before, float z, float after)
{
    bool has_before = is_surface(before), has_after = is_surface(after);
    float left = z - before, right = after - z;
    bool smooth_here = u_edge == 1 || (abs(left) <= u_falloff && abs(right) <= u_falloff);
    if (has_before && has_after && smooth_here) return 0.5 * (left + right);
    if (has_before && (!has_after || abs(left) < abs(right))) return left;
    return has_after ? right : 0.0;
}

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    float z = fetch(t_depth, at).x;
    if (!is_surface(z)) discard;
    vec2 uv = vec2(gl_FragCoord.x * u_divisor - 0.5 * frame.image.x, 0.5 * frame.image.y - gl_FragCoord.y * u_divisor);
    uv *= frame.image.zw;
    // Not fetch: a pixel repeated outside the image would halve the slope at its border.
    float p = slope(depth_at(t_depth, at - ivec2(1, 0)), z, depth_at(t_depth, at + ivec2(1, 0))) / u_c.x;
    float q = slope(depth_at(t_depth, at + ivec2(0, 1)), z, depth_at(t_depth, at - ivec2(0, 1))) / u_c.y; // upwards
    float w = z + (u_off_axis != 0 ? uv.x * p + uv.y * q : 0.0);
    o_normal = vec4(normalize(vec3(-p, -q, -w)), 0.0);
}
