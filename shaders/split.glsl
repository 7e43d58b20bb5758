// SPDX-License-Identifier: MIT
// split.glsl: a surface read straight from the smoothed depth (Bagar 2010, listings A.17 to A.25); the twin of
// libssfr/passes/split.c. After common.glsl.

uniform sampler2D t_low;   // m
// Pixels of the frame a pixel of t_low; m, what bends more is a border; m, where more lies to the nearest of its
// neighbours a sample stands alone.
uniform vec3 u_low;
uniform int u_off_axis;    // inside: the surface's own normal, else listing A.18's
uniform int u_half_shift;  // B28 as printed

struct Split {     // a pixel of the frame
    bool border;   // the colours of four pixels of t_low are blended, else it has one surface
    ivec2 first;   // of the four
    vec2 f;        // how far it is from there to the last
    vec3 position; // inside; m, eye space
    vec3 n;
};

// One value for all that is no surface, so that lines of it do not bend, and lines that are partly of it do.
float low_at(ivec2 p)
{
    float z = depth_at(t_low, p);
    return is_surface(z) ? z : -EMPTY;
}

// Listing A.18, three pixels of a line, m: depth a pixel, depth, depth of the middle one, magnitude of the second
// difference. f goes from the middle of the first step to that of the second.
vec4 line_at(ivec2 p, ivec2 way, float f)
{
    float before = low_at(p - way), z = low_at(p), after = low_at(p + way);
    return vec4(mix(z - before, after - z, f), mix(0.5 * (z + before), 0.5 * (after + z), f), z,
                abs(before - 2.0 * z + after));
}

vec4 mix_lines(vec4 a, vec4 b, float f) { return vec4(mix(a.xyz, b.xyz, f), max(a.w, b.w)); }

// Listing A.25.
Split split_at(vec2 pixel)
{
    const ivec2 right = ivec2(1, 0), down = ivec2(0, 1);
    vec2 p = pixel / u_low.x, between = p - (u_half_shift != 0 ? 0.0 : 0.5);
    ivec2 c = ivec2(floor(p)), first = ivec2(floor(between));
    vec2 along = p - vec2(c), f = between - vec2(first);
    vec4 row = mix_lines(line_at(ivec2(c.x, first.y), right, along.x), line_at(ivec2(c.x, first.y + 1), right, along.x),
                         f.y);
    vec4 column = mix_lines(line_at(ivec2(first.x, c.y), down, along.y),
                            line_at(ivec2(first.x + 1, c.y), down, along.y), f.x);
    float z = 0.5 * (row.y + column.y);
    vec2 uv = slope_at(pixel), slope = vec2(row.x, -column.x) / (frame.image.zw * u_low.x);
    vec3 n = u_off_axis != 0 ? vec3(slope / z, 1.0 + dot(uv, slope) / z)
                             : vec3(slope / vec2(row.z, column.z), 1.0);
    return Split(max(row.w, column.w) > u_low.y, first, f, vec3(uv * -z, z), normalize(n));
}

// Listing A.17: eye space, m.
vec3 low_place(ivec2 p, float z) { return vec3(slope_at((vec2(p) + 0.5) * u_low.x) * -z, z); }

// Listing A.24: to the neighbour ahead or from that behind, whichever differs less in depth; flat where neither is of
// the same surface.
vec3 least_step(ivec2 p, ivec2 way, vec3 eye)
{
    float ahead = low_at(p + way), behind = low_at(p - way);
    int side = abs(eye.z - behind) < abs(ahead - eye.z) ? -1 : 1;
    float z = side < 0 ? behind : ahead;
    z = abs(z - eye.z) <= u_low.z ? z : eye.z;
    return float(side) * (low_place(p + side * way, z) - eye) / -eye.z;
}

// The k-th of the four pixels at a border: its share of the colour, and the surface that gives it.
float split_weight(Split at, int k)
{
    vec2 w = mix(1.0 - at.f, at.f, bvec2((k & 1) != 0, (k & 2) != 0));
    return w.x * w.y;
}

void split_sample(Split at, int k, out vec3 position, out vec3 n)
{
    ivec2 p = clamp(at.first + ivec2(k & 1, k >> 1), ivec2(0), textureSize(t_low, 0) - 1);
    position = low_place(p, low_at(p));
    n = normalize(cross(least_step(p, ivec2(1, 0), position), least_step(p, ivec2(0, -1), position)));
}
