// SPDX-License-Identifier: MIT
// environment.glsl: sky, chequered floor and boxes, for any ray. The twin is libssfr/passes/environment.c.

// Radiance of the sky in a unit world direction; below the horizon the horizon's.
vec3 sky(vec3 dir) { return mix(frame.horizon.rgb, frame.zenith.rgb, sqrt(max(dir.y, 0.0))); }

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

// Where a ray enters box i, in lengths of dir, or -1; normal is that of the face it enters by.
float enter_solid(int i, vec3 origin, vec3 dir, out vec3 normal)
{
    float enter = -EMPTY, leave = EMPTY;
    normal = vec3(0);
    vec3 to = frame.solid[5 * i].xyz - origin;
    for (int k = 0; k < 3; k++) {
        vec4 axis = frame.solid[5 * i + 1 + k];
        float d = dot(dir, axis.xyz), c = dot(to, axis.xyz);
        float t0 = (c - sign(d) * axis.w) / d, t1 = (c + sign(d) * axis.w) / d;
        if (d == 0.0) {
            if (abs(c) > axis.w) leave = -EMPTY;
        } else {
            if (t0 > enter) {
                enter = t0;
                normal = -sign(d) * axis.xyz;
            }
            leave = min(leave, t1);
        }
    }
    return enter < leave && enter > 0.0 ? enter : -1.0;
}

const float HAZES = 16.0;

// Radiance along origin + t dir (relative to the eye, world axes; dir of any length); t of the hit, EMPTY for the sky.
vec3 trace(vec3 origin, vec3 dir, out float t)
{
    vec3 color = sky(normalize(dir)), normal;
    t = EMPTY;
    float floor_t = (frame.right.w - origin.y) / dir.y;
    // Nothing is left of the floor beyond HAZES times the haze: it ends there, before its depth loses all digits.
    if (frame.right.w > -SURFACE && dir.y != 0.0 && floor_t > 0.0 && floor_t * length(dir) < HAZES * frame.ground.w) {
        t = floor_t;
        float footprint = t * frame.image.w * dot(dir, dir) / max(abs(dir.y), 1e-6);
        color = mix(color, floor_color(origin + t * dir, footprint), exp(-t * length(dir) / frame.ground.w));
    }
    for (int i = 0; i < int(frame.zenith.w); i++) {
        float hit = enter_solid(i, origin, dir, normal);
        if (hit > 0.0 && hit < t) {
            t = hit;
            color = frame.solid[5 * i + 4].rgb * lambert(normal);
        }
    }
    return color;
}
