/* SPDX-License-Identifier: GPL-3.0-or-later */
/* truth_key.c: a hash of all that the truth of a stage depends on: the name of its file in the cache. */
#include "experiments/hash.h"
#include "experiments/truth/truth.h"

#include "base/param.h"
#include "scene/anisotropy.h"
#include "scene/mesh.h"

static uint64_t add_numbers(uint64_t hash, size_t n, const double *numbers)
{
    return ssfr_hash_bytes(hash, numbers, n * sizeof *numbers);
}

/* Names too: a parameter that is added, or meant otherwise, gives other keys. */
static uint64_t add_rows(uint64_t hash, const ssfr_param *rows, const void *params)
{
    for (const ssfr_param *row = rows; row->name; row++) {
        const double number = ssfr_param_number(row, params);
        hash = add_numbers(ssfr_hash_text(hash, row->name), 1, &number);
    }
    return hash;
}

static uint64_t add_particles(uint64_t hash, const ssfr_particles *p)
{
    const uint64_t n = p ? p->n : 0;
    hash = ssfr_hash_bytes(hash, &n, sizeof n);
    if (p) hash = add_numbers(hash, 1, &p->radius);
    for (size_t i = 0; i < n; i++) {
        double position[3];
        ssfr_particles_position(p, i, position);
        hash = add_numbers(hash, 3, position);
    }
    return hash;
}

/* Where it is and what it is, and its colour when that is seen. */
static uint64_t add_solid(uint64_t hash, const ssfr_solid *s, bool colour)
{
    const double shape = s->shape;
    hash = add_numbers(hash, 1, &shape);
    hash = add_numbers(hash, 3, s->centre);
    hash = add_numbers(hash, 9, s->axis[0]);
    hash = add_numbers(hash, 3, s->half);
    hash = add_numbers(hash, 1, &s->inner);
    for (size_t t = 0; s->mesh && t < s->mesh->n_triangles; t++)
        hash = add_numbers(hash, 9, s->mesh->triangles[t].corner[0]);
    return colour ? add_numbers(hash, 3, s->colour) : hash;
}

static uint64_t add_solids(uint64_t hash, const ssfr_scene *scene, bool colour)
{
    const double n = scene->n_solids;
    hash = add_numbers(add_numbers(hash, 1, &scene->floor), 1, &n);
    for (int i = 0; i < scene->n_solids; i++) hash = add_solid(hash, &scene->solids[i], colour);
    return hash;
}

static uint64_t add_camera(uint64_t hash, const ssfr_camera *c)
{
    const double numbers[] = {c->tan_x, c->tan_y, c->near, c->w, c->h};
    hash = add_numbers(hash, 3, c->eye);
    hash = add_numbers(hash, 3, c->right);
    hash = add_numbers(hash, 3, c->up);
    hash = add_numbers(hash, 3, c->back);
    return add_numbers(hash, SSFR_COUNT(numbers), numbers);
}

static uint64_t add_foam(uint64_t hash, const ssfr_particles *p, const ssfr_extinction_params *params)
{
    hash = add_particles(add_rows(hash, ssfr_extinction_rows, params), p);
    return p && p->kind ? ssfr_hash_bytes(hash, p->kind, p->n * sizeof *p->kind) : hash;
}

static uint64_t add_world(uint64_t hash, const ssfr_world *world, const ssfr_field *environment)
{
    const ssfr_param *rows;
    size_t offset;
    for (int i = 0; ssfr_world_group(i, &rows, &offset); i++) hash = add_rows(hash, rows, (const char *)world + offset);
    if (!environment) return hash;
    const int size[] = {environment->w, environment->h};
    hash = ssfr_hash_bytes(hash, size, sizeof size);
    return add_numbers(hash, (size_t)environment->w * (size_t)environment->h * (size_t)environment->c,
                       environment->data);
}

/* A surface alone has no integrals. */
static uint64_t add_casting(uint64_t hash, const ssfr_truth_cast_params *c)
{
    const double always[] = {c->parts, c->solids};
    const double integrals[] = {c->integrator, c->eps_abs, c->eps_rel, c->points, c->steps, c->judged};
    hash = add_numbers(hash, SSFR_COUNT(always), always);
    return c->parts & ~(unsigned)SSFR_TRUTH_SURFACE ? add_numbers(hash, SSFR_COUNT(integrals), integrals) : hash;
}

uint64_t ssfr_truth_key(const ssfr_stage *stage, const ssfr_truth_params *params, const ssfr_truth_options *options)
{
    const ssfr_scene *scene = &stage->scene;
    const unsigned parts = params->cast.parts;
    const bool foam = parts & (SSFR_TRUTH_FOAM | SSFR_TRUTH_COLOUR), colour = parts & SSFR_TRUTH_COLOUR;
    const uint64_t version = SSFR_TRUTH_VERSION, every = (uint64_t)options->every;
    uint64_t hash = ssfr_hash_bytes(SSFR_HASH, &version, sizeof version);
    hash = ssfr_hash_bytes(hash, &every, sizeof every);
    if (every > 1) hash = ssfr_hash_bytes(hash, &options->seed, sizeof options->seed);
    hash = add_camera(hash, &scene->camera);
    hash = add_casting(hash, &params->cast);
    hash = add_particles(hash, scene->particles);
    hash = add_rows(hash, ssfr_continuum_rows, &params->fluid);
    if (params->fluid.kind == SSFR_CONTINUUM_ANISOTROPIC)
        hash = add_rows(hash, ssfr_anisotropy_rows, &params->anisotropy);
    if (foam || params->cast.solids) hash = add_solids(hash, scene, colour);
    if (foam) hash = add_foam(hash, stage->foam, &params->extinction);
    if (colour) hash = add_rows(hash, ssfr_light_rows, &params->path);
    if (colour) hash = add_world(hash, &params->world, scene->environment);
    return hash;
}
