// SPDX-License-Identifier: MIT
// particles.glsl: where particles stand in eye space. Positions are relative to their packet, whose eye-space centre
// was formed in double.

layout(std430, binding = 0) readonly buffer Positions { float positions[]; };
layout(std430, binding = 1) readonly buffer Offsets { vec4 offsets[]; }; // a packet each

layout(location = 0) uniform ivec2 u_layout; // floats from one position to the next, and before the first

const int PACKET = 64; // SSFR_PACKET of ssfr.h

vec3 eye_from_world(vec3 v) { return vec3(dot(frame.right.xyz, v), dot(frame.up.xyz, v), dot(frame.back.xyz, v)); }

vec3 eye_position(int i)
{
    int at = u_layout.y + u_layout.x * i;
    vec3 p = vec3(positions[at], positions[at + 1], positions[at + 2]);
    return offsets[i / PACKET].xyz + eye_from_world(p);
}

#ifdef CENTRE
uniform sampler2D t_foam_depth;
flat out vec2 v_seen; // m, eye-space z of the centre and of the foam there

// The foam where a centre is seen: outside the image at its nearest pixel; a centre before the near plane as if in it.
vec2 see_foam(vec3 c)
{
    vec2 at = 0.5 * frame.image.xy + vec2(c.x, -c.y) / max(-c.z, frame.horizon.w) / frame.image.zw;
    return vec2(c.z, fetch(t_foam_depth, ivec2(clamp(at, vec2(0), frame.image.xy))).x);
}
#endif
