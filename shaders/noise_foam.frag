#version 450
// SPDX-License-Identifier: MIT
// noise_foam.frag: foam by the magnitude of the surface noise (Bagar 2010, sec. 2.5.3). in: linear colour of the water,
// noise, surface depth (m), unit normal (eye space); out: linear colour.
#include "common.glsl"
#include "environment.glsl"

uniform sampler2D t_water;
uniform sampler2D t_noise;
uniform sampler2D t_depth;
uniform sampler2D t_normal;
uniform float u_strength;
uniform float u_threshold;
uniform float u_softness;
uniform vec3 u_color;
uniform int u_blend; // 0: add, 1: over

layout(location = 0) out vec4 o_color;

// Smoothstep from the threshold on; softness 0 is a step. Noise that is not a number makes no foam.
float coverage(float noise)
{
    float above = abs(noise) - u_threshold;
    if (!(above > 0.0)) return 0.0;
    float s = above < u_softness ? above / u_softness : 1.0;
    return u_strength * s * s * (3.0 - 2.0 * s);
}

void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    float weight = coverage(fetch(t_noise, p).x);
    if (!is_surface(fetch(t_depth, p).x) || weight == 0.0) discard; // the water shows, to the last bit
    vec3 foam = u_color * lambert(world_from_eye(fetch(t_normal, p).xyz));
    float left = u_blend == 1 ? 1.0 - weight : 1.0;
    o_color = vec4(left * fetch(t_water, p).rgb + weight * foam, 1.0);
}
