/* SPDX-License-Identifier: GPL-3.0-or-later */
/* embedded.c: files inside the binary; the build lists them in scene_files.def: X(number, name, path). */
#include "experiments/scenes/embedded.h"

#include <errno.h>
#include <unistd.h>

/* The assembler reads each file, relative to the folder that make runs in. */
#define X(i, name, path)                                                                               \
    __asm__(".pushsection .rodata\nscene_file_" #i "_begin: .incbin \"" path "\"\n"                    \
            "scene_file_" #i "_end: .byte 0\n.popsection\n");                                          \
    extern const char scene_file_##i##_begin[], scene_file_##i##_end[];
#include "scene_files.def"
#undef X

static const ssfr_embedded files[] = {
#define X(i, name, path) {name, scene_file_##i##_begin, scene_file_##i##_end},
#include "scene_files.def"
#undef X
};

const ssfr_embedded *ssfr_embedded_at(int i)
{
    return i >= 0 && (size_t)i < SSFR_COUNT(files) ? &files[i] : NULL;
}

const ssfr_embedded *ssfr_embedded_find(const char *name)
{
    const ssfr_embedded *found = NULL;
    for (size_t i = 0; i < SSFR_COUNT(files) && !found; i++)
        if (strcmp(files[i].name, name) == 0) found = &files[i];
    return found;
}

/* ---- through the readers, which take paths ----------------------------------------------------------------------- */

typedef struct unpacked { /* a file on disk, in a folder of its own */
    char folder[1024], path[1200];
} unpacked;

static ssfr_result write_bytes(const char *path, const ssfr_embedded *embedded)
{
    const size_t size = (size_t)(embedded->end - embedded->begin);
    FILE *file = fopen(path, "wb");
    const bool written = file && fwrite(embedded->begin, 1, size, file) == size;
    const bool closed = file && fclose(file) == 0;
    return written && closed ? SSFR_OK : ssfr_fail(SSFR_ERR_IO, "%s: %s", path, strerror(errno));
}

static ssfr_result unpack(unpacked *u, const char *name)
{
    const char *parent = getenv("TMPDIR"), *slash = strrchr(name, '/');
    const ssfr_embedded *embedded = ssfr_embedded_find(name);
    *u = (unpacked){0};
    if (!embedded) return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: no such file inside the program", name);
    snprintf(u->folder, sizeof u->folder, "%s/ssfr-XXXXXX", parent && parent[0] ? parent : "/tmp");
    if (!mkdtemp(u->folder)) {
        const ssfr_result result = ssfr_fail(SSFR_ERR_IO, "%s: %s", u->folder, strerror(errno));
        u->folder[0] = '\0';
        return result;
    }
    snprintf(u->path, sizeof u->path, "%s/%.128s", u->folder, slash ? slash + 1 : name);
    return write_bytes(u->path, embedded);
}

static void discard(const unpacked *u)
{
    if (u->path[0]) unlink(u->path);
    if (u->folder[0]) rmdir(u->folder);
}

ssfr_result ssfr_embedded_particles(ssfr_particles **out, const char *name)
{
    ssfr_result result = SSFR_OK;
    unpacked u;
    *out = NULL;
    SSFR_TRY(unpack(&u, name));
    SSFR_TRY(ssfr_particles_load(out, u.path, NULL));
end:
    discard(&u);
    return result;
}

ssfr_result ssfr_embedded_mesh(ssfr_mesh **out, const char *name)
{
    ssfr_result result = SSFR_OK;
    unpacked u;
    *out = NULL;
    SSFR_TRY(unpack(&u, name));
    SSFR_TRY(ssfr_mesh_load(out, u.path));
end:
    discard(&u);
    return result;
}
