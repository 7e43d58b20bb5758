// SPDX-License-Identifier: MIT
// fragment.glsl: where this pixel's ray meets what is drawn of a particle. The twin is ssfr_fragment of
// libssfr/passes/splat.h.

struct Fragment {
    vec2 at;     // place on the sprite, right and down, in radii; on a streak, along and across, in half axes
    float r2;    // |at|^2
    float front; // m, eye-space z
    float back;
    float chord; // m
    float area;  // in the image, of a streak in that of its square; 1 for spheres
};

// What the ray sees of it begins at the near plane. Discards what is behind that.
void cut_front(inout Fragment f)
{
    float near = -frame.horizon.w;
    if (f.back > near) discard;
    if (f.front > near) { // the eye is inside
        f.chord *= (near - f.back) / (f.front - f.back);
        f.front = near;
    }
}
