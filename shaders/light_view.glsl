// SPDX-License-Identifier: MIT
// light_view.glsl: what the light sees, the twin of libssfr/passes/light_view.c. After common.glsl; rays need
// environment.glsl before.

uniform vec3 u_light_x; // unit, world: along rows and columns of the light's images
uniform vec3 u_light_y;
uniform vec2 u_corner;  // m, from the eye along these: of the first texel
uniform float u_extent; // m, the square's side
uniform float u_top;    // m, from the eye towards the light: over all casters
uniform float u_range;  // m, below it
uniform int u_casters_0;
uniform int u_casters_1;

#ifdef SOLIDS
// The first caster that the light meets at p (m from the eye along the view's axes): how far towards the light, m.
float first_caster(vec2 p)
{
    float t = EMPTY;
    vec3 normal, origin = p.x * u_light_x + p.y * u_light_y + u_top * frame.light.xyz;
    int i = meet(uvec2(u_casters_0, u_casters_1), origin, -frame.light.xyz, t, normal);
    return i >= 0 ? u_top - t : -EMPTY;
}
#endif
