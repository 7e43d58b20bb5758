#version 450
// SPDX-License-Identifier: MIT
// tiles.vert: covers the tiles that may hold fluid with two triangles each, or the whole target with one.
// Screen passes take their coordinates from gl_FragCoord alone, so both give the same bits. LIVE_TILES: of steps that
// follow each other only over the tiles that the last one marked (adaptive_flow.frag).

layout(std430, binding = 2) readonly buffer Tiles { uint tiles[]; };

layout(location = 0) uniform ivec4 u_tile; // px of a tile's side in the target, by tiles or whole, target w and h in px

#ifdef LIVE_TILES
layout(location = 1) uniform ivec2 u_step; // number of the step from 0
layout(std430, binding = 7) readonly buffer Marks { uint n_unstable_pixels, n_live_tiles, marks[]; };

bool is_live(uint tile)
{
    uint tiles_x = uint((u_tile.z + u_tile.x - 1) / u_tile.x);
    return u_step.x == 0 || marks[(tile >> 16) * tiles_x + (tile & 0xffffu)] == uint(u_step.x);
}
#else
bool is_live(uint tile) { return true; }
#endif

void main()
{
    const ivec2 corners[6] = ivec2[](ivec2(0, 0), ivec2(1, 0), ivec2(0, 1), ivec2(0, 1), ivec2(1, 0), ivec2(1, 1));
    vec2 p = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0;
    if (u_tile.y != 0) {
        uint tile = tiles[gl_VertexID / 6];
        ivec2 px = (ivec2(tile & 0xffffu, tile >> 16) + corners[gl_VertexID % 6]) * u_tile.x;
        p = is_live(tile) ? vec2(px) / vec2(u_tile.zw) : vec2(0.0);
    }
    gl_Position = vec4(2.0 * p.x - 1.0, 1.0 - 2.0 * p.y, 0.0, 1.0);
}
