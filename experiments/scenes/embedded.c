/* SPDX-License-Identifier: GPL-3.0-or-later */
/* embedded.c: the shipped particle file inside the binary, so that `ssfr` needs no files where it is installed. */
#include "experiments/scenes/embedded.h"

#include <errno.h>
#include <unistd.h>

/* The assembler reads the file, relative to the folder that make runs in. */
__asm__(".pushsection .rodata\n"
        "splash_begin: .incbin \"experiments/scenes/data/splash.h5\"\n"
        "splash_end:\n"
        ".popsection\n");
extern const char splash_begin[], splash_end[];

static const struct {
    const char *name, *begin, *end;
} files[] = {
    {"splash.h5", splash_begin, splash_end},
};

static ssfr_result write_bytes(const char *path, const char *begin, const char *end)
{
    const size_t size = (size_t)(end - begin);
    FILE *file = fopen(path, "wb");
    const bool written = file && fwrite(begin, 1, size, file) == size;
    const bool closed = file && fclose(file) == 0;
    return written && closed ? SSFR_OK : ssfr_fail(SSFR_ERR_IO, "%s: %s", path, strerror(errno));
}

/* The readers take paths: the bytes go through a file in a folder of their own, which is removed again. */
static ssfr_result load_bytes(ssfr_particles **out, const char *name, const char *begin, const char *end)
{
    ssfr_result result = SSFR_OK;
    const char *parent = getenv("TMPDIR");
    char folder[1024], path[1200];
    snprintf(folder, sizeof folder, "%s/ssfr-XXXXXX", parent && parent[0] ? parent : "/tmp");
    if (!mkdtemp(folder)) return ssfr_fail(SSFR_ERR_IO, "%s: %s", folder, strerror(errno));
    snprintf(path, sizeof path, "%s/%s", folder, name);
    SSFR_TRY(write_bytes(path, begin, end));
    SSFR_TRY(ssfr_particles_load(out, path, NULL));
end:
    unlink(path);
    rmdir(folder);
    return result;
}

ssfr_result ssfr_embedded_load(ssfr_particles **out, const char *name)
{
    for (size_t i = 0; i < SSFR_COUNT(files); i++)
        if (strcmp(files[i].name, name) == 0) return load_bytes(out, name, files[i].begin, files[i].end);
    return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: no such embedded file", name);
}
