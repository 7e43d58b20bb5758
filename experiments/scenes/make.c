/* SPDX-License-Identifier: GPL-3.0-or-later */
/* make.c: frames of a simulation on disk: where they are, which are missing, and how to go on. */
#include "experiments/scenes/make.h"
#include "experiments/cache.h"
#include "experiments/console.h"
#include "experiments/hash.h"
#include "experiments/interrupt.h"
#include "experiments/json.h"
#include "experiments/scenes/simulation.h"

#include "scene/mesh.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <unistd.h>

static const char state_name[] = "state.bin";

const char *const ssfr_scale_words[] = {"quick", "full", NULL};

/* ---- where ------------------------------------------------------------------------------------------------------- */

/* 64 bits are enough: only versions of one scene, of one name and scale, must not meet. What code decides is in
 * SSFR_SOLVER_VERSION: raise it when a change to the filling of pools, to emission, steps, foam, solids or meshes gives
 * the same scene other bits, or the state another format. */
uint64_t ssfr_make_key(const ssfr_description *description, uint64_t seed)
{
    const int32_t numbers[] = {(int32_t)description->scale, SSFR_SOLVER_VERSION};
    uint64_t hash = ssfr_hash_text(SSFR_HASH, description->text);
    hash = ssfr_hash_bytes(hash, numbers, sizeof numbers);
    hash = ssfr_hash_bytes(hash, &seed, sizeof seed);
    for (int i = 0; i < description->n_bodies; i++) {
        const ssfr_mesh *mesh = description->bodies[i].mesh;
        for (size_t t = 0; mesh && t < mesh->n_triangles; t++)
            hash = ssfr_hash_bytes(hash, mesh->triangles[t].corner, sizeof mesh->triangles[t].corner);
    }
    return hash;
}

/* "bagar2010/waterfall" gives "bagar2010-waterfall", "../my scene.yaml" gives "my_scene". */
static void name_folder(const char *name, char *text, size_t size)
{
    const size_t length = strlen(name);
    const bool is_file = length > 5 && strcmp(name + length - 5, ".yaml") == 0;
    const char *from = is_file && strrchr(name, '/') ? strrchr(name, '/') + 1 : name;
    const size_t n = strlen(from) - (is_file ? 5 : 0);
    snprintf(text, size, "%.*s", (int)n, from);
    for (char *at = text; *at; at++) {
        const bool plain = (*at >= 'a' && *at <= 'z') || (*at >= 'A' && *at <= 'Z') || (*at >= '0' && *at <= '9');
        if (*at == '/')
            *at = '-';
        else if (!plain && *at != '-')
            *at = '_';
    }
}

ssfr_result ssfr_make_folder(const ssfr_description *description, const char *cache, uint64_t seed, char **out)
{
    ssfr_result result = SSFR_OK;
    char *root = NULL, name[128];
    *out = NULL;
    SSFR_TRY(ssfr_cache_find(&root, cache, "scenes"));
    name_folder(description->name, name, sizeof name);
    SSFR_TRY(ssfr_text_print(out, "a path", "%s/%s-%s-%016" PRIx64, root, name, ssfr_scale_words[description->scale],
                             ssfr_make_key(description, seed)));
end:
    free(root);
    return result;
}

static ssfr_result frame_path(const char *folder, const char *what, int frame, const char *ending, char **out)
{
    return ssfr_text_print(out, "a path", "%s/%s_%04d%s", folder, what, frame, ending);
}

ssfr_result ssfr_make_path(const char *folder, int frame, bool foam, char **out)
{
    return frame_path(folder, foam ? "foam" : "fluid", frame, ".h5", out);
}

/* Beside the frame and not in it: files of the same particles have the same bytes. */
static ssfr_result time_path(const char *folder, int frame, char **out)
{
    return frame_path(folder, "time", frame, ".ms", out);
}

double ssfr_make_time(const char *folder, int frame)
{
    double ms = NAN;
    char *path = NULL;
    FILE *file = time_path(folder, frame, &path) == SSFR_OK ? fopen(path, "r") : NULL;
    if (file && fscanf(file, "%lf", &ms) != 1) ms = NAN;
    if (file) fclose(file);
    free(path);
    return ms;
}

int ssfr_make_count(const char *folder)
{
    int n = 0;
    for (bool there = true; there; n += there) {
        char *path = NULL;
        there = ssfr_make_path(folder, n, false, &path) == SSFR_OK && access(path, R_OK) == 0;
        free(path);
    }
    return n;
}

/* ---- the work ---------------------------------------------------------------------------------------------------- */

typedef struct making {
    const ssfr_description *d;
    const ssfr_make_options *o;
    uint64_t key;
    char *folder;
    int lock;        /* file descriptor; -1 for none */
    ssfr_simulation *simulation;
    int last;        /* the last frame to be made */
    double frame_ms; /* wall time that the simulation of the last frame took */
    double seconds;  /* of work until the last frame, by all processes that were at it */
    double begun;    /* clock when they were counted last */
    char about[192]; /* what the log's lines are about */
} making;

/* One process at a time: what the second waits for, it then need not make. */
static ssfr_result lock(making *m)
{
    ssfr_result result = SSFR_OK;
    char *path = NULL;
    SSFR_TRY(ssfr_text_print(&path, "a path", "%s/lock", m->folder));
    SSFR_TRY(ssfr_cache_hold(path, m->folder, &m->lock));
end:
    free(path);
    return result;
}

static bool ends_in(const char *name, const char *ending)
{
    const size_t length = strlen(name), n = strlen(ending);
    return length > n && strcmp(name + length - n, ending) == 0;
}

static bool is_made(const char *name)
{
    return ends_in(name, ".h5") || ends_in(name, ".ms") || strcmp(name, state_name) == 0;
}

/* Removes what killed processes left half-written, which under the lock is nobody's; all: frames and state as well. */
static ssfr_result clean(const making *m, bool all)
{
    ssfr_result result = SSFR_OK;
    char *path = NULL;
    DIR *dir = opendir(m->folder);
    if (!dir) return ssfr_fail(SSFR_ERR_IO, "%s: %s", m->folder, strerror(errno));
    SSFR_TRY(ssfr_alloc(&path, strlen(m->folder) + sizeof((struct dirent *)0)->d_name + 2, 1, "a path"));
    for (const struct dirent *entry = readdir(dir); entry; entry = readdir(dir)) {
        const char *name = entry->d_name;
        if (!ends_in(name, ".part") && !(all && is_made(name))) continue;
        sprintf(path, "%s/%s", m->folder, name);
        if (unlink(path) != 0 && errno != ENOENT) {
            result = ssfr_fail(SSFR_ERR_IO, "%s: %s", path, strerror(errno));
            break;
        }
    }
end:
    closedir(dir);
    free(path);
    return result;
}

/* ---- the state --------------------------------------------------------------------------------------------------- */

/* In the file before the simulation's own bytes. */
typedef struct state_head {
    char magic[8];
    uint64_t key;
    uint64_t size, hash; /* of what follows, bytes */
    double seconds;
} state_head;

static const char magic[8] = "ssfrsim";

static ssfr_result state_path(const making *m, char **out)
{
    return ssfr_text_print(out, "a path", "%s/%s", m->folder, state_name);
}

static ssfr_result write_bytes(const char *path, const state_head *head, const char *bytes)
{
    FILE *file = fopen(path, "wb");
    const bool written = file && fwrite(head, sizeof *head, 1, file) == 1 &&
                         fwrite(bytes, 1, head->size, file) == head->size;
    const bool closed = file && fclose(file) == 0;
    return written && closed ? SSFR_OK : ssfr_fail(SSFR_ERR_IO, "%s: %s", path, strerror(errno));
}

static ssfr_result save_state(const making *m)
{
    ssfr_result result = SSFR_OK;
    ssfr_aside aside = {0};
    state_head head = {.key = m->key, .seconds = m->seconds};
    char *path = NULL, *bytes = NULL;
    size_t size = 0;
    FILE *memory = open_memstream(&bytes, &size);
    if (!memory) return ssfr_fail(SSFR_ERR_MEMORY, "no memory for the state of a simulation");
    result = ssfr_simulation_write(m->simulation, memory);
    if (fclose(memory) != 0 && result == SSFR_OK)
        result = ssfr_fail(SSFR_ERR_MEMORY, "no memory for the state of a simulation");
    if (result != SSFR_OK) goto end;
    memcpy(head.magic, magic, sizeof magic);
    head.size = size;
    head.hash = ssfr_hash_bytes(SSFR_HASH, bytes, size);
    SSFR_TRY(state_path(m, &path));
    SSFR_TRY(ssfr_aside_begin(&aside, path));
    result = write_bytes(aside.temporary, &head, bytes);
end:
    result = ssfr_aside_end(&aside, result);
    free(path);
    free(bytes);
    return result;
}

static ssfr_result look_at_state(const making *m, const char *path, bool *whole)
{
    enum { MAX_GIB = 16 };
    char *text = NULL;
    size_t size = 0;
    state_head head;
    const ssfr_result result = ssfr_read_file(path, (size_t)MAX_GIB << 30, &text, &size);
    *whole = result == SSFR_OK && size > sizeof head;
    if (*whole) {
        memcpy(&head, text, sizeof head);
        size -= sizeof head;
        *whole = memcmp(head.magic, magic, sizeof magic) == 0 && head.key == m->key && head.size == size &&
                 head.hash == ssfr_hash_bytes(SSFR_HASH, text + sizeof head, size);
    }
    free(text);
    return result;
}

/* From the file itself: the readers hold what it says against its size. */
static ssfr_result take_state(making *m, const char *path)
{
    ssfr_result result = SSFR_OK;
    state_head head;
    FILE *file = fopen(path, "rb");
    if (!file || fread(&head, sizeof head, 1, file) != 1) {
        result = ssfr_fail(SSFR_ERR_IO, "%s: %s", path, strerror(errno));
        goto end;
    }
    SSFR_TRY(ssfr_simulation_read(m->simulation, file));
    m->seconds = head.seconds;
end:
    if (file) fclose(file);
    return result;
}

/* Goes on from the state that was left, if one was, it is whole, and the frames before it are still there. Else the
 * simulation stays at its beginning. */
static ssfr_result resume(making *m)
{
    ssfr_result result = SSFR_OK;
    char *path = NULL;
    bool whole = false;
    SSFR_TRY(state_path(m, &path));
    if (access(path, F_OK) != 0) goto end;
    SSFR_TRY(look_at_state(m, path, &whole));
    if (whole)
        SSFR_TRY(take_state(m, path));
    else
        ssfr_log(SSFR_WARNING, "%s: damaged: all frames are made anew", path);
    if (ssfr_make_count(m->folder) <= ssfr_simulation_frame(m->simulation)) { /* some were removed */
        ssfr_simulation_destroy(&m->simulation);
        SSFR_TRY(ssfr_simulation_create(&m->simulation, m->d, m->o->seed));
        m->seconds = 0;
    }
end:
    free(path);
    return result;
}

/* ---- what stands beside the frames ------------------------------------------------------------------------------- */

static void write_meta(const making *m, FILE *file)
{
    const int frame = ssfr_simulation_frame(m->simulation);
    ssfr_json json;
    char key[24];
    snprintf(key, sizeof key, "%016" PRIx64, m->key);
    ssfr_json_init(&json, file);
    ssfr_json_object(&json, NULL);
    ssfr_json_text(&json, "scene", m->d->name);
    ssfr_json_text(&json, "title", m->d->title);
    ssfr_json_text(&json, "scale", ssfr_scale_words[m->d->scale]);
    ssfr_json_text(&json, "key", key);
    ssfr_json_integer(&json, "seed", (long long)m->o->seed);
    ssfr_json_text(&json, "ssfr", ssfr_version());
    ssfr_json_integer(&json, "solver_version", SSFR_SOLVER_VERSION);
    ssfr_json_number(&json, "radius", m->d->solver.radius);
    ssfr_json_number(&json, "frame_rate", m->d->frame_rate);
    ssfr_json_integer(&json, "frames", m->d->n_frames);
    ssfr_json_integer(&json, "frames_made", frame + 1);
    ssfr_json_integer(&json, "steps", ssfr_simulation_steps(m->simulation));
    ssfr_json_number(&json, "seconds", m->seconds);
    ssfr_json_close(&json);
}

/* A text, whole or not there. */
static ssfr_result save_text(const making *m, const char *path, void (*put)(const making *, FILE *))
{
    ssfr_result result = SSFR_OK;
    ssfr_aside aside = {0};
    FILE *file = NULL;
    SSFR_TRY(ssfr_aside_begin(&aside, path));
    file = fopen(aside.temporary, "w");
    if (file) put(m, file);
    const bool written = file && !ferror(file);
    const bool closed = file && fclose(file) == 0;
    if (!written || !closed) result = ssfr_fail(SSFR_ERR_IO, "%s: %s", path, strerror(errno));
end:
    return ssfr_aside_end(&aside, result);
}

static ssfr_result save_meta(const making *m)
{
    char *path = NULL;
    ssfr_result result = ssfr_text_print(&path, "a path", "%s/meta.json", m->folder);
    if (result == SSFR_OK) result = save_text(m, path, write_meta);
    free(path);
    return result;
}

/* ---- frames ------------------------------------------------------------------------------------------------------ */

static ssfr_result save_particles(const making *m, const ssfr_particles *particles, bool foam)
{
    char *path = NULL;
    ssfr_result result = ssfr_make_path(m->folder, ssfr_simulation_frame(m->simulation), foam, &path);
    if (result == SSFR_OK) result = ssfr_particles_save(particles, path);
    free(path);
    return result;
}

/* One number. */
static void write_time(const making *m, FILE *file)
{
    fprintf(file, "%.6g\n", m->frame_ms);
}

static ssfr_result save_time(const making *m)
{
    char *path = NULL;
    ssfr_result result = time_path(m->folder, ssfr_simulation_frame(m->simulation), &path);
    if (result == SSFR_OK) result = save_text(m, path, write_time);
    free(path);
    return result;
}

/* The fluid comes after its foam and its time: where a fluid is, the frame is whole. Without the state the frame would
 * be made again, with the same bits. */
static ssfr_result save_frame(making *m)
{
    ssfr_result result = SSFR_OK;
    const double now = ssfr_clock();
    ssfr_particles *fluid = NULL, *foam = NULL;
    SSFR_TRY(ssfr_simulation_export(m->simulation, &fluid, &foam));
    if (foam) SSFR_TRY(save_particles(m, foam, true));
    SSFR_TRY(save_time(m));
    SSFR_TRY(save_particles(m, fluid, false));
    m->seconds += now - m->begun;
    m->begun = now;
    SSFR_TRY(save_state(m));
    SSFR_TRY(save_meta(m));
end:
    ssfr_particles_destroy(&fluid);
    ssfr_particles_destroy(&foam);
    return result;
}

static ssfr_result make_frames(making *m)
{
    ssfr_result result = SSFR_OK;
    const int first = ssfr_simulation_frame(m->simulation) + 1;
    const size_t total = m->last < first ? 0 : (size_t)(m->last - first) + 1;
    m->begun = ssfr_clock();
    for (int frame = first; frame <= m->last; frame++) {
        snprintf(m->about, sizeof m->about, frame < 0 ? "%.128s, at rest" : "%.128s, frame %d", m->d->name, frame);
        ssfr_log_about(m->about);
        ssfr_console_progress(m->d->name, (size_t)(frame - first), total);
        const double start = ssfr_clock();
        SSFR_TRY(ssfr_simulation_advance(m->simulation));
        m->frame_ms = 1e3 * (ssfr_clock() - start);
        SSFR_TRY(frame < 0 ? save_state(m) : save_frame(m));
    }
end:
    ssfr_log_about(NULL);
    ssfr_console_progress(m->d->name, total, total);
    return result;
}

static ssfr_result run(making *m)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_cache_make_folders(m->folder));
    SSFR_TRY(lock(m));
    SSFR_TRY(clean(m, m->o->anew));
    if (ssfr_make_count(m->folder) > m->last) goto end;
    SSFR_TRY(ssfr_simulation_create(&m->simulation, m->d, m->o->seed));
    SSFR_TRY(resume(m));
    SSFR_TRY(make_frames(m));
end:
    return result;
}

ssfr_result ssfr_make(const ssfr_description *description, const ssfr_make_options *options)
{
    ssfr_result result = SSFR_OK;
    making m = {.d = description, .o = options, .lock = -1, .last = options->last};
    m.key = ssfr_make_key(description, options->seed);
    if (options->last < 0) m.last = description->n_frames - 1;
    if (m.last >= description->n_frames)
        return ssfr_fail(SSFR_ERR_VALUE, "%s: frame %d: there are frames 0 to %d", description->name, m.last,
                         description->n_frames - 1);
    SSFR_TRY(ssfr_make_folder(description, options->cache, options->seed, &m.folder));
    if (!options->anew && ssfr_make_count(m.folder) > m.last) goto end;
    ssfr_interrupt_begin();
    result = run(&m);
    ssfr_interrupt_end();
end:
    ssfr_simulation_destroy(&m.simulation);
    if (m.lock >= 0) close(m.lock);
    free(m.folder);
    return result;
}
