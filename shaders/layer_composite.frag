#version 450
// SPDX-License-Identifier: MIT
// layer_composite.frag: layers of water and foam over the scene, from back to front (Bagar 2010, eqs 3.5 to 3.9). in:
// scene colour and depth, surface depth (m) and unit normal (eye space), thicknesses (m) of the water behind the front
// of the foam and before it, of the foam and of its front, share of light; with SPLIT the smoothed depth (m) in the
// place of surface depth and normal; out: linear colour, with BORDER where colours were interpolated.
#include "common.glsl"
#include "environment.glsl"
#include "optics.glsl"
#ifdef SPLIT
#include "split.glsl"
#endif

uniform sampler2D t_thickness_back;
uniform sampler2D t_thickness_front;
uniform sampler2D t_foam_thickness;
uniform sampler2D t_foam_front;
uniform sampler2D t_light;
uniform float u_shift;       // px a metre of water
uniform vec3 u_fresnel;      // bias, scale, power
uniform vec3 u_base;
uniform vec4 u_falloff;      // 1/m
uniform vec3 u_c_ff;
uniform vec3 u_c_fb;
uniform vec4 u_foam;         // attenuation 1/m, 1/delta_foam 1/m, most of T_ff / delta_foam, exponent
uniform float u_ambient;
uniform int u_exact_fresnel;
uniform int u_falloff_model;
uniform int u_power_blend;
uniform int u_foam_swapped;  // B10 as printed
uniform int u_front_weight;  // B11 as printed
uniform int u_cosine_added;  // B12 as printed

layout(location = 0) out vec4 o_color;
#ifdef BORDER
layout(location = 1) out float o_border;
#endif

struct Layers { float back, front, foam, foam_front, light; };

// Water over a colour, eqs 3.5 and 3.7; gives what comes through.
vec3 cover_with_water(float thickness, inout vec3 color)
{
    bool falloff = u_falloff_model != 0;
    vec3 through = falloff ? vec3(exp(-thickness * u_falloff.w)) : through_water(thickness);
    color = mix(falloff ? u_base * exp(-thickness * u_falloff.rgb) : frame.fluid.rgb, color, through);
    return through;
}

// Foam over a colour, eqs 3.6 and 3.9; gives what comes through.
float cover_with_foam(Layers l, inout vec3 color)
{
    float t = pow(min(l.foam_front * u_foam.y, u_foam.z), u_foam.w);
    float share = u_power_blend != 0 ? t : u_foam_swapped != 0 ? exp(-t) : 1.0 - exp(-t); // of c_ff
    float through = exp(-l.foam * u_foam.x);
    color = mix(mix(u_c_fb, u_c_ff, share) * mix(u_ambient, 1.0, l.light), color, through);
    return through;
}

float fresnel(float cosine)
{
    if (u_exact_fresnel != 0) return fresnel_exact(cosine);
    if (u_cosine_added != 0) return u_fresnel.x + u_fresnel.y * pow(1.0 + cosine, u_fresnel.z);
    return min(u_fresnel.x + u_fresnel.y * pow(1.0 - cosine, u_fresnel.z), 1.0);
}

vec3 compose(Layers l, vec3 position, vec3 n)
{
    bool water = is_surface(position.z), illuminated = water && u_front_weight == 0;
    vec3 mirrored = vec3(0);
    float f = 0.0, shine = 0.0;
    if (water) {
        vec3 view = normalize(-position);
        f = fresnel(clamp(dot(n, view), 0.0, 1.0));
        mirrored = reflected(n, view, position);
        shine = l.light * highlight(n, view);
    } else {
        n = vec3(0);
    }
    vec3 color = refracted(position.z, u_shift * (l.back + l.front) * vec2(n.x, -n.y));
    cover_with_water(l.back, color);
    if (illuminated && !(l.front > 0.0)) color = mix(color, mirrored, f) + shine; // eq. 3.8
    float through_foam = cover_with_foam(l, color);
    vec3 through = cover_with_water(l.front, color);
    if (illuminated && l.front > 0.0) color = mix(color, mirrored, f) + shine;
    if (water && u_front_weight != 0) // listing A.20: added as far as water is before the foam
        color += (mirrored * f + shine) * min(1.0 - through + through_foam, 1.0) * (1.0 - through);
    return color;
}

#ifdef SPLIT
// Depths of low resolution reach over the water's outline: its thickness says where it ends.
vec3 compose_split(Layers l, out bool border)
{
    Split at = split_at(gl_FragCoord.xy);
    bool water = l.back > 0.0 || l.front > 0.0;
    border = water && at.border;
    if (!water) at.position.z = -EMPTY;
    if (!border) return compose(l, at.position, at.n);
    vec3 color = vec3(0);
    for (int k = 0; k < 4; k++) { // listing A.23
        float weight = split_weight(at, k);
        if (!(weight > 0.0)) continue;
        vec3 position, n;
        split_sample(at, k, position, n);
        color += weight * compose(l, position, n);
    }
    return color;
}
#endif

void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    Layers l = Layers(value_at(t_thickness_back, p, THICKEST), value_at(t_thickness_front, p, THICKEST),
                      value_at(t_foam_thickness, p, THICKEST), value_at(t_foam_front, p, THICKEST),
                      value_at(t_light, p, 1.0));
    bool any = l.back > 0.0 || l.front > 0.0 || l.foam > 0.0, border = false;
#ifdef SPLIT
    if (!any) discard; // the scene shows
    vec3 color = compose_split(l, border);
#else
    float z = fetch(t_depth, p).x;
    if (!any && !is_surface(z)) discard;
    vec3 color = compose(l, vec3(slope_at(gl_FragCoord.xy) * -z, z), fetch(t_normal, p).xyz);
#endif
    o_color = vec4(color, 1.0);
#ifdef BORDER
    o_border = float(border);
#endif
}
