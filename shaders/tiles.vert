#version 450
// SPDX-License-Identifier: MIT
// tiles.vert: covers the tiles that may hold fluid with two triangles each, or the whole target with one.
// Screen passes take their coordinates from gl_FragCoord alone, so both give the same bits.

layout(std430, binding = 2) readonly buffer Tiles { uint tiles[]; };

layout(location = 0) uniform ivec4 u_tile; // px of a tile's side in the target, by tiles or whole, target w and h in px

void main()
{
    const ivec2 corners[6] = ivec2[](ivec2(0, 0), ivec2(1, 0), ivec2(0, 1), ivec2(0, 1), ivec2(1, 0), ivec2(1, 1));
    vec2 p = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0;
    if (u_tile.y != 0) {
        uint tile = tiles[gl_VertexID / 6];
        ivec2 px = (ivec2(tile & 0xffffu, tile >> 16) + corners[gl_VertexID % 6]) * u_tile.x;
        p = vec2(px) / vec2(u_tile.zw);
    }
    gl_Position = vec4(2.0 * p.x - 1.0, 1.0 - 2.0 * p.y, 0.0, 1.0);
}
