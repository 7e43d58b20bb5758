#version 450
// SPDX-License-Identifier: MIT
// streak.vert: a particle as a quad along its velocity (Bagar 2010, listing A.10), or as a square on the screen.
// Under CENTRE the foam is looked up where the particle's centre is seen.
#include "common.glsl"
#include "particles.glsl"

layout(std430, binding = 4) readonly buffer Sizes { float sizes[]; }; // SSFR_BIND_VALUES, of a neutral value one entry
layout(std430, binding = 5) readonly buffer Velocities { float velocities[]; }; // m/s, world

uniform float u_radius;           // m
uniform float u_motion_threshold; // m/s
uniform float u_facing;           // cosine
uniform float u_stretch;
uniform int u_turned;
uniform int u_in_view; // turned quads are parallel to the image

flat out vec3 v_centre; // m, eye space
flat out vec3 v_along;  // unit vectors
flat out vec3 v_across;
flat out vec2 v_half;   // m, half axes
#ifdef PARTICLE
flat out uint v_particle;
#endif

// Unit vector of the motion; false when the particle is slower than the threshold, or where to cannot be told. By its
// largest component: squares of what a float holds may be more than it holds.
bool find_motion(int i, out vec3 motion)
{
    int at = 3 * min(i, velocities.length() / 3 - 1);
    vec3 v = vec3(velocities[at], velocities[at + 1], velocities[at + 2]);
    float largest = max(abs(v.x), max(abs(v.y), abs(v.z)));
    motion = vec3(0);
    if (!all(lessThanEqual(abs(v), vec3(3.402823466e38)))) return false; // FLT_MAX
    if (largest < 1e-30) return false; // m/s, which a GPU may take for 0
    motion = eye_from_world(v / largest);
    float speed = length(motion);
    motion /= speed;
    return largest * speed >= u_motion_threshold;
}

// The quad's axes along the motion; false, and those of a square, when it is not turned.
bool turn(int i, vec3 c)
{
    vec3 motion, view = normalize(-c);
    v_along = vec3(1.0, 0.0, 0.0);
    v_across = vec3(0.0, -1.0, 0.0);
    if (u_turned == 0 || !find_motion(i, motion)) return false;
    if (abs(dot(motion, view)) > u_facing) return false;
    if (u_in_view != 0) { // the motion as seen from the eye on the plane z = c_z
        v_along = vec3(normalize(motion.z * c.xy - motion.xy * c.z), 0.0);
        v_across = vec3(v_along.y, -v_along.x, 0.0);
    } else {
        v_along = motion;
        v_across = normalize(cross(motion, view));
    }
    return true;
}

void main()
{
    int i = gl_VertexID >> 2; // four vertices, drawn by index
    vec2 corner = 2.0 * vec2(gl_VertexID & 1, gl_VertexID >> 1 & 1) - 1.0;
    float size = sizes[min(i, sizes.length() - 1)], near = frame.horizon.w;
    v_centre = eye_position(i);
    v_half = vec2(turn(i, v_centre) ? u_stretch : 1.0, 1.0) * (u_radius * size);
#ifdef PARTICLE
    v_particle = uint(i);
#endif
#ifdef CENTRE
    v_seen = see_foam(v_centre);
#endif
    // A pixel wider, for the ellipse to have all its pixels. Clipped between the near plane, where fragments end, and
    // the eye: w + z >= 0.
    float pixel = max(frame.image.z, frame.image.w) * -v_centre.z;
    vec3 p = v_centre + corner.x * (v_half.x + pixel) * v_along + corner.y * (v_half.y + pixel) * v_across;
    gl_Position = vec4(2.0 * p.xy / (frame.image.xy * frame.image.zw), -0.5 * near, -p.z);
    // A quad stands where its centre is: outside of all that is drawn without that before the near plane.
    if (!(size > 0.0) || v_centre.z > -near) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}
