#version 450
// SPDX-License-Identifier: MIT
// layer_thickness.frag: length of the view ray inside the particle (m), summed by blending; under LAYERS before and
// behind the front of the foam, as the particle's CENTRE is or as far as the ray is (Bagar 2010, sec. 3.2.2).
#include "common.glsl"
#include "splat.glsl"
#include "thickness.glsl"

layout(location = 0) out float o_back;

#ifdef LAYERS
uniform float u_open; // share of the water that is before the foam where there is none

#ifdef CENTRE
flat in vec2 v_seen; // m, eye-space z of the centre and of the foam there
#else
uniform sampler2D t_foam_depth;
#endif

layout(location = 1) out float o_front;

float share_before(Fragment f)
{
#ifdef CENTRE
    return is_surface(v_seen.y) ? step(v_seen.y, v_seen.x) : u_open;
#else
    float foam = fetch(t_foam_depth, ivec2(gl_FragCoord.xy)).x;
    if (!is_surface(foam)) return u_open;
    return (f.front - clamp(foam, f.back, f.front)) / max(f.front - f.back, 1e-20);
#endif
}
#endif

void main()
{
    Fragment f = meet_sphere();
    float t = thickness_of(f);
#ifdef LAYERS
    float share = share_before(f);
    o_back = (1.0 - share) * t;
    o_front = share * t;
#else
    o_back = t;
#endif
}
