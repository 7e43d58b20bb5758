#version 450
// SPDX-License-Identifier: MIT
// background.frag: the scene without the fluid. out: color, eye-space z (m; empty for the sky).
#include "common.glsl"
#include "environment.glsl"

const int TILE = 32; // px, SSFR_TILE

layout(std430, binding = 4) readonly buffer SolidTiles { uvec2 solid_tiles[]; }; // bit i: solid i may be seen there

// Precise: a tile's program, which leaves out what the tile does not show, gives the same bits as the one with all.
layout(location = 0) precise out vec4 o_color;
layout(location = 1) precise out float o_depth;

void main()
{
    float t;
    vec3 dir = world_from_eye(vec3(slope_at(gl_FragCoord.xy), -1.0));
    ivec2 tile = ivec2(gl_FragCoord.xy) / TILE;
    uvec2 solids = SOLIDS > 0 ? solid_tiles[tile.y * ((int(frame.image.x) + TILE - 1) / TILE) + tile.x] : uvec2(0);
    o_color = vec4(trace_some(solids, vec3(0), dir, t), 1.0);
    o_depth = -t;
}
