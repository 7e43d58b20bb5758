/* SPDX-License-Identifier: GPL-3.0-or-later */
/* particle_files.h: what the tests of the particle readers share: making files and damaging them. */
#ifndef SSFR_TESTS_PARTICLE_FILES_H
#define SSFR_TESTS_PARTICLE_FILES_H

#include "scene/reader.h"
#include "tests/util.h"

/* A file in the making. */
typedef struct bytes {
    char data[8192];
    size_t n;
} bytes;

__attribute__((format(printf, 2, 3))) void put_text(bytes *b, const char *format, ...);
/* A binary number, built byte by byte from its value and so independent of how the readers take it apart. */
void put_number(bytes *b, ssfr_scalar type, bool big_endian, double value);

/* Writes the file into the test's folder and gives its path. The same name gives the same path. */
const char *particle_file(const char *name, const void *data, size_t size);
const char *text_file(const char *name, const char *text);

/* The index of the one particle within 1e-6 m of the place; fails when there is none or another. */
size_t find_particle(const ssfr_particles *particles, double x, double y, double z);

/* Loads what must load. */
ssfr_particles *load(const char *path);

/* The same, and keeps the lines that are told beside errors. */
ssfr_particles *load_and_listen(void **state, const char *path);
extern char told[512];

/* Does not load what must not load. */
void check_refused(const char *path, ssfr_result code, const char *text);
/* Saves what must be saved. */
void save(const ssfr_particles *particles, const char *path);

/* Every start of the file gives particles or one error line; the whole file gives particles. */
void check_truncations(const char *name, const void *data, size_t size);
/* So does the file with a byte replaced, for many bytes and values. */
void check_damage(const char *name, const void *data, size_t size);
/* Missing files, folders and empty files are errors. */
void check_no_files(const char *ending);

#endif
