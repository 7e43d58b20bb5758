// SPDX-License-Identifier: MIT
// optics.glsl: what a surface of water does to light, for all passes that shade one; the twin of
// libssfr/passes/optics.c. After common.glsl and environment.glsl.

uniform sampler2D t_scene_color;
uniform sampler2D t_scene_depth;
uniform sampler2D t_depth;
uniform sampler2D t_normal;
uniform float u_attenuation; // 1/m
uniform float u_specular;
uniform float u_shininess;
uniform int u_reject;
uniform int u_reflection;    // 0: sky, 1: scene
uniform int u_single;        // one coefficient for all colours

const float THICKEST = 1e6; // m, SSFR_THICKEST

// From 0 to the most; what is not a number is 0.
float value_at(sampler2D t, ivec2 p, float most)
{
    float value = fetch(t, p).x;
    return value > 0.0 ? min(value, most) : 0.0;
}

// Fresnel's equations for a dielectric: the share that is mirrored.
float fresnel_exact(float cosine)
{
    float ior = frame.absorption.w;
    float inside = sqrt(ior * ior - 1.0 + cosine * cosine); // ior times the cosine inside the fluid
    float across = (cosine - inside) / max(cosine + inside, 1e-20); // 0 / 0 for index 1 at grazing angles
    float along = (ior * ior * cosine - inside) / max(ior * ior * cosine + inside, 1e-20);
    return 0.5 * (across * across + along * along);
}

// The scene `by` pixels aside, or straight behind where what stands there is rejected.
vec3 refracted(float z, vec2 by)
{
    vec2 at = clamp(gl_FragCoord.xy + by, vec2(0), frame.image.xy);
    float behind = fetch(t_scene_depth, ivec2(floor(at))).x;
    if (u_reject != 0 && behind > z) at = gl_FragCoord.xy;
    return fetch_linear(t_scene_color, at).rgb;
}

// The share of the light behind a thickness of water (m) that comes through.
vec3 through_water(float thickness)
{
    vec3 k = u_single != 0 ? vec3(u_attenuation) : frame.absorption.rgb;
    return exp(-k * thickness);
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
