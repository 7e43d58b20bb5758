/* SPDX-License-Identifier: GPL-3.0-or-later */
/* description_motion.c: where solids and emitters of a description are at a time. */
#include "experiments/scenes/description.h"

typedef struct pose {
    double turn[3][3]; /* rows */
    double move[3];    /* m */
} pose;

/* Turns about a unit axis (Rodrigues). */
static void set_turn(const double axis[3], double angle_deg, double turn[3][3])
{
    const double angle = fmod(angle_deg, 360) * acos(-1) / 180, c = cos(angle), s = sin(angle);
    const double across[3][3] = {{0, -axis[2], axis[1]}, {axis[2], 0, -axis[0]}, {-axis[1], axis[0], 0}};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) turn[i][k] = c * (i == k) + (1 - c) * axis[i] * axis[k] + s * across[i][k];
}

/* The key at a time: one of the motion's exactly, where it has one then. */
static ssfr_pose_key key_at(const ssfr_motion *motion, double time)
{
    const double t = motion->period > 0 ? fmod(fmax(time, 0), motion->period) : time;
    int next = 0;
    while (next < motion->n_keys && motion->keys[next].time <= t) next++;
    if (next == 0 || next == motion->n_keys) return motion->keys[ssfr_max_int(next - 1, 0)];
    const ssfr_pose_key *a = &motion->keys[next - 1], *b = &motion->keys[next];
    const double u = (t - a->time) / (b->time - a->time);
    const double share = motion->easing == SSFR_EASE_SMOOTH ? u * u * (3 - 2 * u) : u;
    ssfr_pose_key key = {.time = t, .turn_deg = ssfr_mix(a->turn_deg, b->turn_deg, share)};
    for (int k = 0; k < 3; k++) key.move[k] = ssfr_mix(a->move[k], b->move[k], share);
    return key;
}

static pose pose_at(const ssfr_motion *motion, double time)
{
    const ssfr_pose_key key = key_at(motion, time);
    pose p = {.move = {key.move[0], key.move[1], key.move[2]}};
    set_turn(motion->axis, key.turn_deg, p.turn);
    return p;
}

static void turn_direction(const pose *p, double v[3])
{
    const double w[3] = {v[0], v[1], v[2]};
    for (int k = 0; k < 3; k++) v[k] = ssfr_dot(p->turn[k], w);
}

static void carry_point(const pose *p, const double pivot[3], double v[3])
{
    for (int k = 0; k < 3; k++) v[k] -= pivot[k];
    turn_direction(p, v);
    for (int k = 0; k < 3; k++) v[k] += pivot[k] + p->move[k];
}

ssfr_solid ssfr_body_at(const ssfr_description *description, const ssfr_body *body, double time)
{
    ssfr_solid solid = body->solid;
    if (body->motion < 0) return solid;
    const ssfr_motion *motion = &description->motions[body->motion];
    const pose p = pose_at(motion, time);
    carry_point(&p, motion->pivot, solid.centre);
    for (int k = 0; k < 3; k++) turn_direction(&p, solid.axis[k]);
    return solid;
}

ssfr_emitter ssfr_emitter_at(const ssfr_description *description, const ssfr_emitter *emitter, double time)
{
    ssfr_emitter e = *emitter;
    if (emitter->motion < 0) return e;
    const ssfr_motion *motion = &description->motions[emitter->motion];
    const pose p = pose_at(motion, time);
    carry_point(&p, motion->pivot, e.centre);
    turn_direction(&p, e.direction);
    turn_direction(&p, e.up);
    return e;
}
