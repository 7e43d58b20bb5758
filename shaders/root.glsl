// SPDX-License-Identifier: MIT
// root.glsl: the square root of u in [0, 1]: sqrt, or under RAMP and RAMP_PRINTED looked up in 128 texels (Bagar 2010,
// sec. 4.1). The twin is libssfr/passes/root.c.

#ifdef RAMP
uniform sampler2D t_root_ramp;
float root(float u) { return textureLod(t_root_ramp, vec2((127.0 * u + 0.5) / 128.0, 0.5), 0.0).x; }
#elif defined(RAMP_PRINTED)
uniform sampler2D t_root_ramp_printed;
float root(float u) { return textureLod(t_root_ramp_printed, vec2(u, 0.5), 0.0).x; }
#else
float root(float u) { return sqrt(u); }
#endif
