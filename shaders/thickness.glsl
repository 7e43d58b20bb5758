// SPDX-License-Identifier: MIT
// thickness.glsl: length of the view ray inside the particle, for all passes that add it up. The twin is
// libssfr/passes/thickness_cpu.c. After splat.glsl or streak.glsl.

uniform sampler2D t_scene_depth;
uniform int u_exponential; // kernel: chord e^(-2 r^2) (listing A.15), else the chord
uniform int u_clipped;     // count only what lies before the scene, else all when the front does
uniform float u_scale;

// m, spread over f.area; f.back is then where that ends. Discards what is behind the scene.
float thickness_of(inout Fragment f)
{
    float scene = fetch(t_scene_depth, ivec2(gl_FragCoord.xy)).x, back = f.back;
    if (f.front < scene) discard;
    float t = f.chord * u_scale;
    if (u_exponential != 0) t *= exp(-2.0 * f.r2);
    t /= f.area;
    if (u_clipped != 0) {
        f.back = max(back, scene);
        t *= (f.front - f.back) / max(f.front - back, 1e-20);
    }
    return t;
}
