#version 450
// SPDX-License-Identifier: MIT
// shadow_basis.frag: cosines and sines of a shadow map's depths (Annen et al. 2007), images of four values one below
// the other; then their means along one axis. in: light depth (m), or with BOX, the axis, what is to be filtered.
#include "common.glsl"
#include "light_view.glsl"

uniform sampler2D t_light_depth;
uniform float u_per_metre; // normalised depth, 1/m
uniform float u_damping;   // alpha / M^2
uniform int u_terms;       // M
uniform int u_radius;      // px

layout(location = 0) out vec4 o_basis;

const float PI = 3.14159265358979;

// Texels a side: of the outputs' h, the images' number is known.
int side_of(int h) { return h / ((2 * u_terms + 4) / 4); }

#ifdef BOX
// Inside each image: texels beyond its border are those of the border.
void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy), size = textureSize(t_light_depth, 0);
    int side = side_of(size.y), first = p.y - p.y % side;
    vec4 sum = vec4(0);
    for (int i = -u_radius; i <= u_radius; i++) {
        ivec2 q = p + i * BOX;
        sum += fetch(t_light_depth, ivec2(q.x, clamp(q.y, first, first + side - 1)));
    }
    o_basis = sum / float(2 * u_radius + 1);
}
#else
// Value i of a texel with its caster at normalised depth z.
float value(int i, float z)
{
    int k = (i + 1) / 2;
    float angular = PI * float(2 * k - 1), weight = 2.0 * exp(-u_damping * float(k * k)) / angular;
    if (i == 0) return 1.0;
    if (k > u_terms) return 0.0;
    return weight * (i % 2 == 1 ? cos(angular * z) : sin(angular * z));
}

void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    int side = textureSize(t_light_depth, 0).y;
    float depth = fetch(t_light_depth, ivec2(p.x, p.y % side)).x;
    float z = min(max((u_top - depth) * u_per_metre, 0.0), 1.0);
    o_basis = vec4(0);
    if (is_surface(depth))
        for (int k = 0; k < 4; k++) o_basis[k] = value(p.y / side * 4 + k, z);
}
#endif
