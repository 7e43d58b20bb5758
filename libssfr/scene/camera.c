/* SPDX-License-Identifier: MIT */
/* camera.c: a camera from where it stands and what it looks at. */
#include "base/base.h"

/* Normalises v, however long or short it is; false for a zero vector. */
static bool find_direction(double v[3])
{
    const double most = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    if (most == 0) return false;
    for (int k = 0; k < 3; k++) v[k] /= most; /* else squares overflow */
    ssfr_normalize(v);
    return true;
}

ssfr_result ssfr_camera_look(ssfr_camera *out, const double eye[3], const double target[3], const double up[3],
                             double fov_y, int w, int h)
{
    ssfr_camera c = {.near = 0.01, .far = 1000, .w = w, .h = h};
    double upwards[3] = {up[0], up[1], up[2]};
    if (!(fov_y > 0 && fov_y < M_PI))
        return ssfr_fail(SSFR_ERR_VALUE, "field of view of %g rad is not in (0, pi)", fov_y);
    if (w < 1 || h < 1 || w > SSFR_MAX_SIZE || h > SSFR_MAX_SIZE)
        return ssfr_fail(SSFR_ERR_VALUE, "image of %d x %d pixels: sides go from 1 to %d", w, h, SSFR_MAX_SIZE);
    if (!ssfr_all_finite(eye) || !ssfr_all_finite(target) || !ssfr_all_finite(up))
        return ssfr_fail(SSFR_ERR_VALUE, "camera: eye, target and up must be finite");
    for (int k = 0; k < 3; k++) c.eye[k] = eye[k], c.back[k] = 0.5 * eye[k] - 0.5 * target[k];
    if (!find_direction(c.back))
        return ssfr_fail(SSFR_ERR_VALUE, "camera: eye and target are the same point %g,%g,%g", eye[0], eye[1], eye[2]);
    find_direction(upwards);
    ssfr_cross(upwards, c.back, c.right);
    if (!(ssfr_normalize(c.right) > 1e-12))
        return ssfr_fail(SSFR_ERR_VALUE, "camera: up %g,%g,%g is along the view", up[0], up[1], up[2]);
    /* An up almost along the view leaves right few true digits: what of it lies along the view is taken off. */
    const double along = ssfr_dot(c.right, c.back);
    if (fabs(along) > 1e-15) {
        for (int k = 0; k < 3; k++) c.right[k] -= along * c.back[k];
        ssfr_normalize(c.right);
    }
    ssfr_cross(c.back, c.right, c.up);
    c.tan_y = tan(fov_y / 2);
    c.tan_x = c.tan_y * w / h;
    *out = c;
    return SSFR_OK;
}
