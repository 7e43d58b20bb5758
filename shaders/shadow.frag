#version 450
// SPDX-License-Identifier: MIT
// shadow.frag: the share of the light that arrives at water and foam past the solids (Bagar 2010, listing A.22; Annen
// et al. 2007). in: surface and foam depth (m, eye space), light depth (m, along the light) or its basis; out: [0, 1].
#include "common.glsl"
#include "environment.glsl"
#include "light_view.glsl"

uniform sampler2D t_depth;
uniform sampler2D t_foam_depth;
uniform sampler2D t_light_depth;
uniform sampler2D t_basis;
uniform int u_night;   // a plane has the light behind it
uniform float u_bias;  // m
uniform float u_scale;
uniform int u_kind;    // 0 map, 1 convolution, 2 ray
uniform int u_around;  // px, of the mean
uniform int u_foam;    // 0: left out; 1: where there is no water; 2: wherever it is before the water
uniform float u_divisor; // full-resolution pixels a pixel

layout(location = 0) out float o_light;

const float HALF_TURN = 3.14159265358979;

// The mean of the depths around a pixel that are a surface; empty where none is.
float mean_depth(sampler2D t, ivec2 p)
{
    float sum = 0.0;
    int n = 0;
    for (int j = -u_around; j <= u_around; j++)
        for (int i = -u_around; i <= u_around; i++) {
            float z = depth_at(t, p + ivec2(i, j));
            if (!is_surface(z)) continue;
            sum += z;
            n++;
        }
    return n > 0 ? sum / float(n) : -EMPTY;
}

// A place in the light's view, as a share of its square.
vec2 share_of(vec2 at) { return (at - u_corner) / u_extent; }

// Beyond its border no fluid is, or no caster.
bool is_within(vec2 share) { return all(greaterThanEqual(share, vec2(0))) && all(lessThanEqual(share, vec2(1))); }

float nearest_caster(vec2 at)
{
    vec2 share = share_of(at);
    ivec2 p = ivec2(share * float(textureSize(t_light_depth, 0).x));
    return is_within(share) ? fetch(t_light_depth, p).x : -EMPTY;
}

// Image i of the basis, between its four texels around q.
vec4 basis_at(int i, int side, vec2 q)
{
    vec2 f = floor(q - 0.5), a = q - 0.5 - f;
    ivec2 p = ivec2(f);
    int y0 = i * side + clamp(p.y, 0, side - 1), y1 = i * side + clamp(p.y + 1, 0, side - 1);
    return mix(mix(fetch(t_basis, ivec2(p.x, y0)), fetch(t_basis, ivec2(p.x + 1, y0)), a.x),
               mix(fetch(t_basis, ivec2(p.x, y1)), fetch(t_basis, ivec2(p.x + 1, y1)), a.x), a.y);
}

// The series at the fluid's depth, for the share of texels that have casters; the others are lit.
float convolved(vec3 at)
{
    ivec2 size = textureSize(t_basis, 0);
    int images = max(size.y / size.x, 1);
    float span = 1.0 - 0.5 / float(max(2 * images - 2, 1)); // ssfr_shadow_span
    float d = clamp((u_top - at.z) / u_range, 0.0, 1.0) * span, share = 0.0, sum = 0.0;
    vec2 place = share_of(at.xy), q = place * float(size.x);
    if (!is_within(place)) return 1.0;
    for (int i = 0; i < images; i++) {
        vec4 v = basis_at(i, size.x, q);
        for (int k = 0; k < 4; k++) {
            int value = 4 * i + k;
            float angle = HALF_TURN * float(2 * ((value + 1) / 2) - 1) * d;
            if (value == 0) share = v[k];
            else sum += value % 2 == 1 ? -sin(angle) * v[k] : cos(angle) * v[k];
        }
    }
    return 1.0 - share + clamp(u_scale * (0.5 * share + sum), 0.0, share);
}

float light_at(vec3 at)
{
    if (u_night != 0) return 0.0;
    if (u_kind == 1) return convolved(at);
    float caster = u_kind == 2 ? first_caster(at.xy) : nearest_caster(at.xy);
    return caster > at.z ? 0.0 : 1.0;
}

void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    float z = mean_depth(t_depth, p);
    if (u_foam == 2 || (u_foam == 1 && !is_surface(z))) z = max(z, mean_depth(t_foam_depth, p));
    if (!is_surface(z)) discard;
    vec3 world = world_from_eye(vec3(slope_at(gl_FragCoord.xy * u_divisor) * -z, z));
    o_light = light_at(vec3(dot(world, u_light_x), dot(world, u_light_y), dot(world, frame.light.xyz) + u_bias));
}
