#version 450
// SPDX-License-Identifier: MIT
// splat.vert: a particle as a POINT, as a QUAD around its disc, or as a quad around its EXACT perspective outline;
// under SIZES each particle's radius is multiplied by a size of its own, and 0 draws nothing; under SPARE_FOAM what is
// foam at all is not drawn; under CENTRE the foam is looked up where the particle's centre is seen.
#include "common.glsl"
#include "particles.glsl"

uniform float u_radius;       // m
uniform float u_max_point_px;
uniform int u_by_distance;    // shrink by the distance, not by the depth

#ifdef EXACT
flat out vec3 v_centre; // m, eye space
#else
flat out vec4 v_disc;   // centre and radius of the disc, px
flat out float v_z;     // m, of the centre
#endif
#ifdef PARTICLE
flat out uint v_particle;
#endif
#ifdef SIZES
layout(std430, binding = 4) readonly buffer Sizes { float sizes[]; }; // SSFR_BIND_VALUES
flat out float v_radius; // m
#endif
#ifdef SPARE_FOAM
layout(std430, binding = 5) readonly buffer Foam { float foam[]; }; // after the sizes
#endif

#ifdef EXACT
// Tangents from the eye to the sphere's circle in the plane of one image axis, px; the whole image when it has none.
vec2 outline(float c, float d, float radius, float per_pixel, float size)
{
    float power = c * c + d * d - radius * radius;
    if (d <= radius || power <= 0.0) return vec2(0.0, size);
    float root = radius * sqrt(power), below = (d * d - radius * radius) * per_pixel;
    return 0.5 * size + vec2(c * d - root, c * d + root) / below + vec2(-1.0, 1.0);
}
#endif

void main()
{
#ifdef POINT
    int i = gl_VertexID;
#else
    int i = gl_VertexID >> 2; // four vertices, drawn by index
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1 & 1);
#endif
    vec3 c = eye_position(i);
    vec2 image = frame.image.xy, lo, hi;
    bool keep;
    float radius = u_radius;
#ifdef SIZES
    float size = sizes[min(i, sizes.length() - 1)]; // a neutral one has one entry
    radius *= size;
    v_radius = radius;
#endif
#ifdef PARTICLE
    v_particle = uint(i);
#endif
#ifdef EXACT
    v_centre = c;
    keep = -c.z + radius >= frame.horizon.w; // some of it before the near plane
    vec2 x = outline(c.x, -c.z, radius, frame.image.z, image.x);
    vec2 y = outline(-c.y, -c.z, radius, frame.image.w, image.y);
    lo = vec2(x.x, y.x);
    hi = vec2(x.y, y.y);
#else
    float away = u_by_distance != 0 ? length(c) : -c.z;
    v_z = c.z;
    keep = c.z <= -frame.horizon.w;
    v_disc.xy = 0.5 * image + vec2(c.x, -c.y) / -c.z / frame.image.zw;
    v_disc.zw = radius / (frame.image.zw * away);
    lo = v_disc.xy - v_disc.zw - 1.0;
    hi = v_disc.xy + v_disc.zw + 1.0;
#endif
#ifdef POINT
    keep = keep && all(greaterThanEqual(v_disc.xy, vec2(0))) && all(lessThanEqual(v_disc.xy, image));
    gl_PointSize = min(2.0 * max(v_disc.z, v_disc.w) + 2.0, u_max_point_px);
    vec2 p = v_disc.xy;
#else
    vec2 p = mix(clamp(lo, vec2(0), image), clamp(hi, vec2(0), image), corner);
#endif
    gl_Position = vec4(2.0 * p.x / image.x - 1.0, 1.0 - 2.0 * p.y / image.y, 0.0, 1.0);
#ifdef SIZES
    keep = keep && size > 0.0;
#endif
#ifdef SPARE_FOAM
    keep = keep && !(foam[min(i, foam.length() - 1)] > 0.0);
#endif
#ifdef CENTRE
    v_seen = see_foam(c);
#endif
    if (!keep) gl_Position = vec4(2.0, 2.0, 2.0, 1.0); // outside of all that is drawn
}
