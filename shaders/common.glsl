// SPDX-License-Identifier: MIT
// common.glsl: the frame's block and how images are read. Row 0 is the top row; gl_FragCoord.y grows downwards.

struct Solid {
    vec4 centre; // relative to the eye, world axes; w: square of a radius around it that holds it
    vec4 axis[3]; // w: half extent
    vec4 color;
    vec4 kind;   // shape, inner radius, first node of the mesh
};

layout(std140, binding = 0) uniform Frame { // ssfr_block of graph/frame.h, vec4 by vec4
    vec4 image;      // w px, h px, c_x, c_y
    vec4 right;      // eye axes in world; w: floor's height over the eye
    vec4 up;         // w: eye x modulo two tiles
    vec4 back;       // w: eye z modulo two tiles
    vec4 light;      // towards the light, world; w: intensity
    vec4 absorption; // rgb 1/m; w: index of refraction
    vec4 fluid;      // rgb; w: ambient
    vec4 zenith;     // rgb; w: number of solids
    vec4 horizon;    // rgb; w: near
    vec4 ground;     // tile m, light, dark, haze m
    vec4 map;        // w px, h px of the environment's map; 0: none
    Solid solid[64];
} frame;

const float EMPTY = 1e30;
const float SURFACE = 1e29;

bool is_surface(float z) { return abs(z) < SURFACE; }

// The pixel nearest to p: a 1x1 image of a neutral value serves any size.
vec4 fetch(sampler2D t, ivec2 p) { return texelFetch(t, clamp(p, ivec2(0), textureSize(t, 0) - 1), 0); }

// A depth image's value; outside the image there is no surface.
float depth_at(sampler2D t, ivec2 p)
{
    bool within = all(greaterThanEqual(p, ivec2(0))) && all(lessThan(p, textureSize(t, 0)));
    return within ? texelFetch(t, p, 0).x : -EMPTY;
}

// Between the four pixels around p, in pixels; centres stand at halves.
vec4 fetch_linear(sampler2D t, vec2 p)
{
    vec2 q = p - 0.5, f = floor(q), a = q - f;
    ivec2 i = ivec2(f);
    return mix(mix(fetch(t, i), fetch(t, i + ivec2(1, 0)), a.x),
               mix(fetch(t, i + ivec2(0, 1)), fetch(t, i + ivec2(1, 1)), a.x), a.y);
}

// Eye-space x and y at unit distance of a place in the full-resolution image, in pixels.
vec2 slope_at(vec2 p) { return vec2(p.x - 0.5 * frame.image.x, 0.5 * frame.image.y - p.y) * frame.image.zw; }

vec3 world_from_eye(vec3 v) { return v.x * frame.right.xyz + v.y * frame.up.xyz + v.z * frame.back.xyz; }
