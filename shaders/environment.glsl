// SPDX-License-Identifier: MIT
// environment.glsl: sky or a map of it, chequered floor and solids, for any ray. The twins are
// libssfr/passes/environment.c and, for where rays enter solids, libssfr/scene/solid.c and mesh_tree.c.

// Before the file: what a frame needs of it. A software rasteriser runs also what its branches leave out.
// SOLIDS: 0 none, 1 boxes, 2 all shapes but meshes, 3 meshes too. MAP: 1 for a map in the place of the sky.
#ifndef SOLIDS
#define SOLIDS 0
#endif
#ifndef MAP
#define MAP 0
#endif

bool has_floor() { return frame.right.w > -SURFACE; }

#if MAP
layout(binding = 15) uniform sampler2D t_environment; // latitude and longitude

const float PI = 3.14159265358979;

vec3 map_texel(ivec2 p)
{
    ivec2 size = ivec2(frame.map.xy);
    return texelFetch(t_environment, ivec2((p.x + size.x) % size.x, clamp(p.y, 0, size.y - 1)), 0).rgb;
}

// Between four texels: around the globe they close up, at the poles they end. A zero vector is level, towards +z.
vec3 map_at(vec3 dir)
{
    float level = max(length(dir.xz), 1e-20), z = dir.x == 0.0 && dir.z == 0.0 ? 1.0 : dir.z;
    vec2 q = vec2(0.5 - atan(dir.x, z) / (2.0 * PI), atan(level, dir.y) / PI) * frame.map.xy - 0.5;
    vec2 f = floor(q), a = q - f;
    ivec2 i = ivec2(f);
    return mix(mix(map_texel(i), map_texel(i + ivec2(1, 0)), a.x),
               mix(map_texel(i + ivec2(0, 1)), map_texel(i + ivec2(1, 1)), a.x), a.y);
}
#endif

// Radiance of the sky in a unit world direction. Below the horizon, the horizon's; the map's own without a floor.
vec3 sky(vec3 dir)
{
#if MAP
    return map_at(has_floor() ? vec3(dir.x, max(dir.y, 0.0), dir.z) : dir);
#else
    return mix(frame.horizon.rgb, frame.zenith.rgb, sqrt(max(dir.y, 0.0)));
#endif
}

float lambert(vec3 normal)
{
    return frame.fluid.w + (1.0 - frame.fluid.w) * frame.light.w * max(dot(normal, frame.light.xyz), 0.0);
}

// The tiles' contrast fades where one of them is no wider than a few pixels: no aliasing.
vec3 floor_color(vec3 p, float footprint)
{
    vec2 q = floor(vec2(frame.up.w + p.x, frame.back.w + p.z) / frame.ground.x);
    float odd = mod(q.x + q.y, 2.0), contrast = clamp(1.5 - 4.0 * footprint / frame.ground.x, 0.0, 1.0);
    float mean = 0.5 * (frame.ground.y + frame.ground.z), side = 0.5 * (frame.ground.y - frame.ground.z);
    return vec3((mean + (odd < 0.5 ? side : -side) * contrast) * lambert(vec3(0, 1, 0)));
}

#if SOLIDS
// ---- where rays enter solids, in the solid's axes -----------------------------------------------------------------

const int BOX = 0, CYLINDER = 1, SPHERE = 2, RAMP = 3, PLANE = 4, MESH = 5; // ssfr_shape
const float NEVER = -EMPTY;

// The part of a ray in a convex region, in lengths of its direction, and the normal where it enters.
struct Span {
    float enter, leave;
    vec3 normal;
};

// Keeps what lies where n . p <= c; before: n . origin - c.
void clip_plane(inout Span s, float before, float slope, vec3 n)
{
    float t = -before / slope;
    if (slope < 0.0 && t > s.enter) {
        s.enter = t;
        s.normal = n;
    }
    if (slope > 0.0) s.leave = min(s.leave, t);
    if (slope == 0.0 && before > 0.0) s.leave = NEVER;
}

void clip_interval(inout Span s, vec3 o, vec3 d, int k, float extent)
{
    vec3 n = vec3(0);
    n[k] = d[k] > 0.0 ? -1.0 : 1.0;
    clip_plane(s, n[k] * o[k] - extent, n[k] * d[k], n);
    clip_plane(s, -n[k] * o[k] - extent, -n[k] * d[k], -n);
}

#if SOLIDS > 1
// The endless cylinder around y, or the ball: `in_y` is 0 or 1.
void clip_round(inout Span s, vec3 o, vec3 d, float in_y, float radius)
{
    vec3 across = vec3(1.0, in_y, 1.0), along = d * across;
    float dd = max(dot(along, along), 1e-30), middle = -dot(o * across, along) / dd;
    vec3 p = o * across + middle * along;
    float inside = radius * radius - dot(p, p), extent = sqrt(max(inside, 0.0) / dd);
    if (inside <= 0.0) s.leave = NEVER;
    if (inside > 0.0 && middle - extent > s.enter) {
        s.enter = middle - extent;
        s.normal = (o * across + s.enter * along) / radius;
    }
    s.leave = min(s.leave, middle + extent);
}

// From the hole the ray comes in where it leaves the hole while still in the cylinder.
void clip_hole(inout Span s, vec3 o, vec3 d, float inner, float first)
{
    Span hole = Span(NEVER, EMPTY, vec3(0));
    clip_round(hole, o, d, 0.0, inner);
    bool outside = s.enter < s.leave && s.enter > first && (s.enter < hole.enter || s.enter > hole.leave);
    if (hole.enter < hole.leave && !outside) {
        if (hole.leave < s.enter) s.leave = NEVER;
        s.enter = hole.leave;
        vec3 p = o + s.enter * d;
        s.normal = vec3(-p.x, 0.0, -p.z) / inner;
    }
}

#endif

#if SOLIDS > 2
struct Node { // ssfr_mesh_node
    vec3 lo;
    uint skip;
    vec3 hi;
    uint leaf; // 8 first triangle + triangles
};

layout(std430, binding = 5) readonly buffer Nodes { Node nodes[]; };
layout(std430, binding = 6) readonly buffer Triangles { vec4 triangles[]; }; // three corners; w: the normal

bool meets_box(Node node, vec3 o, vec3 inverse, float first, float last)
{
    vec3 a = (node.lo - o) * inverse, b = (node.hi - o) * inverse, near = min(a, b), far = max(a, b);
    return max(max(near.x, near.y), max(near.z, first)) <= min(min(far.x, far.y), min(far.z, last));
}

// Twice the area of a triangle at the ray, to the left of a side: for the side run backwards, exactly the opposite.
float left_of(vec2 a, vec2 b)
{
    precise float area = a.x * b.y - a.y * b.x;
    return area;
}

// The corner seen along the ray: one place for all its triangles.
vec2 seen(vec3 corner, vec3 o, vec3 x, vec3 y, vec3 z, vec2 shear)
{
    vec3 c = corner - o;
    precise vec2 p = vec2(dot(c, x), dot(c, y)) - shear * dot(c, z);
    return p;
}

// Woop, Benthin and Wald, Watertight ray/triangle intersection (2013). The inner loop goes on to the next leaf that the
// ray meets, so that rays that run side by side look at triangles at the same time.
Span enter_mesh(uint root, vec3 o, vec3 d, float first)
{
    Span s = Span(NEVER, EMPTY, vec3(0));
    vec3 size = abs(d), inverse = 1.0 / mix(d, vec3(1e-30), lessThan(size, vec3(1e-30)));
    vec3 z = size.x >= size.y && size.x >= size.z ? vec3(1, 0, 0) : size.y >= size.z ? vec3(0, 1, 0) : vec3(0, 0, 1);
    vec3 x = dot(d, z) > 0.0 ? z.zxy : z.yzx, y = dot(d, z) > 0.0 ? z.yzx : z.zxy;
    vec2 shear = vec2(dot(d, x), dot(d, y)) / dot(d, z);
    for (uint i = root, end = nodes[root].skip; i < end;) {
        uint leaf = 0u;
        while (leaf == 0u && i < end) {
            Node node = nodes[i];
            bool meets = meets_box(node, o, inverse, first, s.leave);
            leaf = meets ? node.leaf : 0u;
            i = meets ? i + 1u : node.skip;
        }
        for (uint k = leaf >> 3; k < (leaf >> 3) + (leaf & 7u); k++) {
            vec4 a = triangles[3u * k], b = triangles[3u * k + 1u], c = triangles[3u * k + 2u];
            vec3 n = vec3(a.w, b.w, c.w);
            float slope = dot(n, d), t = dot(n, a.xyz - o) / slope;
            if (!(slope < 0.0 && t > first && t < s.leave)) continue;
            vec2 p = seen(a.xyz, o, x, y, z, shear), q = seen(b.xyz, o, x, y, z, shear);
            vec2 r = seen(c.xyz, o, x, y, z, shear);
            if (left_of(p, q) > 0.0 || left_of(q, r) > 0.0 || left_of(r, p) > 0.0) continue;
            s = Span(t, t, n);
        }
    }
    return Span(s.enter, EMPTY, s.normal);
}

#endif

Span span_of(int i, vec3 o, vec3 d, float first)
{
    Span s = Span(NEVER, EMPTY, vec3(0));
    int shape = int(frame.solid[i].kind.x);
    vec3 extent = vec3(frame.solid[i].axis[0].w, frame.solid[i].axis[1].w, frame.solid[i].axis[2].w);
    if (SOLIDS == 1 || shape == BOX || shape == RAMP)
        for (int k = 0; k < 3; k++) clip_interval(s, o, d, k, extent[k]);
#if SOLIDS > 1
    if (shape == RAMP) {
        vec3 n = vec3(-extent.y, extent.x, 0.0) / length(extent.xy);
        clip_plane(s, dot(n, o), dot(n, d), n);
    }
    if (shape == SPHERE) clip_round(s, o, d, 1.0, extent.x);
    if (shape == PLANE) clip_plane(s, o.y, d.y, vec3(0, 1, 0));
    if (shape == CYLINDER) {
        clip_round(s, o, d, 0.0, extent.x);
        clip_interval(s, o, d, 1, extent.y);
        if (frame.solid[i].kind.y > 0.0) clip_hole(s, o, d, frame.solid[i].kind.y, first);
    }
#endif
#if SOLIDS > 2
    if (shape == MESH) s = enter_mesh(uint(frame.solid[i].kind.z), o, d, first);
#endif
    return s;
}

// Where a ray enters solid i, in lengths of dir, or a negative number; and the normal there. Measured from where the
// ray is nearest to the solid's centre: far away there are no differences of large numbers.
float enter_solid(int i, vec3 origin, vec3 dir, out vec3 normal)
{
    vec4 centre = frame.solid[i].centre;
    vec3 to = centre.xyz - origin;
    float moved = dot(to, dir) / dot(dir, dir);
    vec3 o = moved * dir - to;
    normal = vec3(0);
    if (dot(o, o) > centre.w || (moved < 0.0 && dot(to, to) > centre.w)) return -1.0;
    mat3 axes = mat3(frame.solid[i].axis[0].xyz, frame.solid[i].axis[1].xyz, frame.solid[i].axis[2].xyz);
    Span s = span_of(i, o * axes, dir * axes, -moved);
    normal = axes * s.normal;
    return s.enter < s.leave ? moved + s.enter : -1.0;
}
#endif

// ---- the scene ----------------------------------------------------------------------------------------------------

const float HAZES = 16.0;

// The first of these solids that the ray origin + dir * [0, t] enters, -1 for none; where, and the normal there.
int meet(uvec2 solids, vec3 origin, vec3 dir, inout float t, out vec3 normal)
{
    int first = -1;
    normal = vec3(0);
#if SOLIDS
    while ((solids.x | solids.y) != 0u) {
        int i = solids.x != 0u ? findLSB(solids.x) : 32 + findLSB(solids.y);
        solids = solids.x != 0u ? uvec2(solids.x & (solids.x - 1u), solids.y) : uvec2(0u, solids.y & (solids.y - 1u));
        vec3 n;
        float hit = enter_solid(i, origin, dir, n);
        if (hit > 0.0 && hit < t) {
            first = i;
            t = hit;
            normal = n;
        }
    }
#endif
    return first;
}

// Radiance along origin + t dir (relative to the eye, world axes; dir of any length), of the floor, the solids whose
// bits are set, and the sky; t of the hit, EMPTY for the sky.
vec3 trace_some(uvec2 solids, vec3 origin, vec3 dir, out float t)
{
    vec3 color = sky(normalize(dir));
    t = EMPTY;
    float floor_t = (frame.right.w - origin.y) / dir.y;
    // Nothing is left of the floor beyond HAZES times the haze: it ends there, before its depth loses all digits.
    if (has_floor() && dir.y != 0.0 && floor_t > 0.0 && floor_t * length(dir) < HAZES * frame.ground.w) {
        t = floor_t;
        float footprint = t * frame.image.w * dot(dir, dir) / max(abs(dir.y), 1e-6);
        color = mix(color, floor_color(origin + t * dir, footprint), exp(-t * length(dir) / frame.ground.w));
    }
    vec3 normal;
    int i = meet(solids, origin, dir, t, normal);
    if (i >= 0) color = frame.solid[i].color.rgb * lambert(normal);
    return color;
}

uvec2 all_solids()
{
    int n = int(frame.zenith.w);
    return uvec2(n < 32 ? (1u << n) - 1u : ~0u, n < 32 ? 0u : n < 64 ? (1u << (n - 32)) - 1u : ~0u);
}

vec3 trace(vec3 origin, vec3 dir, out float t) { return trace_some(all_solids(), origin, dir, t); }
