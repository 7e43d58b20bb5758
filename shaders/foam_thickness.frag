#version 450
// SPDX-License-Identifier: MIT
// foam_thickness.frag: length of the view ray inside the foam particle times its noise (m), and the same of what is
// near the front of the foam; both summed by blending (Bagar 2010, listing A.16).
#include "common.glsl"
#include "perlin.glsl"
#include "streak.glsl"
#include "thickness.glsl"

layout(std430, binding = 3) readonly buffer Ids { uint ids[]; };
layout(std430, binding = 6) readonly buffer Lifetimes { float lifetimes[]; }; // s; of a neutral value one entry

#ifdef CENTRE
flat in vec2 v_seen; // m, eye-space z of the centre and of the foam there
#else
uniform sampler2D t_foam_depth;
#endif
uniform float u_noise_rate; // 1/s
uniform float u_delta_foam; // m
uniform int u_kept;         // a turned quad spreads its foam
uniform int u_by_id;
uniform int u_has_ids;
#ifdef NOISE_TEXTURE
uniform sampler3D t_foam_perlin;
#endif

layout(location = 0) out float o_foam_thickness;
layout(location = 1) out float o_foam_front;

float place_in_time()
{
    float lifetime = lifetimes[min(int(v_particle), lifetimes.length() - 1)];
    float periods = (lifetime > 0.0 ? min(lifetime, 1e9) : 0.0) * u_noise_rate; // SSFR_FOAM_OLDEST
    uint id = u_has_ids != 0 ? ids[v_particle] : v_particle;
    return fract(periods) + (u_by_id != 0 ? lattice_share(id) : 0.0);
}

float noise_at(vec2 at)
{
#ifdef NOISE_TEXTURE
    return textureLod(t_foam_perlin, vec3(0.5 + 0.5 * at, place_in_time()), 0.0).x;
#elif defined(NOISE)
    return foam_noise(vec3(0.5 + 0.5 * at, place_in_time()), 0u);
#else
    return 0.5;
#endif
}

// The foam's front is told from the particle's CENTRE, or from its own front at each pixel.
bool is_in_front(float front)
{
#ifdef CENTRE
    return v_seen.x >= v_seen.y - u_delta_foam;
#else
    return front >= fetch(t_foam_depth, ivec2(gl_FragCoord.xy)).x - u_delta_foam;
#endif
}

void main()
{
    Fragment f = meet_quad();
    if (u_kept == 0) f.area = 1.0;
    float t = thickness_of(f) * noise_at(f.at);
    o_foam_thickness = t;
    o_foam_front = is_in_front(f.front) ? t : 0.0;
}
