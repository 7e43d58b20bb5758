#version 450
// SPDX-License-Identifier: MIT
// splat.vert: a particle as a POINT, as a QUAD around its disc, or as a quad around its EXACT perspective outline.
#include "common.glsl"
#include "particles.glsl"

uniform float u_radius;       // m
uniform float u_max_point_px;
uniform int u_by_distance;    // shrink by the distance, not by the depth

flat out vec3 v_centre;       // m, eye space
flat out vec4 v_disc;         // centre and radius of the disc, px
flat out float v_half;        // px, half a point's side
flat out uint v_particle;

#ifdef EXACT
// Tangents from the eye to the sphere's circle in the plane of one image axis, px; the whole image when it has none.
vec2 outline(float c, float d, float per_pixel, float size)
{
    float power = c * c + d * d - u_radius * u_radius;
    if (d <= u_radius || power <= 0.0) return vec2(0.0, size);
    float root = u_radius * sqrt(power), below = (d * d - u_radius * u_radius) * per_pixel;
    return 0.5 * size + vec2(c * d - root, c * d + root) / below + vec2(-1.0, 1.0);
}
#endif

void main()
{
#ifdef POINT
    int i = gl_VertexID;
#else
    int i = gl_VertexID / 6;
    const vec2 corners[6] = vec2[](vec2(0, 0), vec2(1, 0), vec2(0, 1), vec2(0, 1), vec2(1, 0), vec2(1, 1));
    vec2 corner = corners[gl_VertexID % 6];
#endif
    vec3 c = eye_position(i);
    vec2 image = frame.image.xy, lo, hi;
    bool keep;
    v_centre = c;
    v_particle = uint(i);
    v_disc = vec4(0);
    v_half = EMPTY;
#ifdef EXACT
    keep = -c.z + u_radius >= frame.horizon.w; // some of it before the near plane
    vec2 x = outline(c.x, -c.z, frame.image.z, image.x), y = outline(-c.y, -c.z, frame.image.w, image.y);
    lo = vec2(x.x, y.x);
    hi = vec2(x.y, y.y);
#else
    float away = u_by_distance != 0 ? length(c) : -c.z;
    keep = c.z <= -frame.horizon.w;
    v_disc.xy = 0.5 * image + vec2(c.x, -c.y) / -c.z / frame.image.zw;
    v_disc.zw = u_radius / (frame.image.zw * away);
    lo = v_disc.xy - v_disc.zw - 1.0;
    hi = v_disc.xy + v_disc.zw + 1.0;
#endif
#ifdef POINT
    v_half = 0.5 * min(2.0 * max(v_disc.z, v_disc.w) + 2.0, u_max_point_px);
    keep = keep && all(greaterThanEqual(v_disc.xy, vec2(0))) && all(lessThanEqual(v_disc.xy, image));
    gl_PointSize = 2.0 * v_half;
    vec2 p = v_disc.xy;
#else
    vec2 p = mix(clamp(lo, vec2(0), image), clamp(hi, vec2(0), image), corner);
#endif
    gl_Position = keep ? vec4(2.0 * p.x / image.x - 1.0, 1.0 - 2.0 * p.y / image.y, 0.0, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
}
