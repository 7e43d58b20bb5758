/* SPDX-License-Identifier: MIT */
/* ply_file.h: PLY files, whatever they hold: elements with properties by name, and the values of their instances. */
#ifndef SSFR_PLY_FILE_H
#define SSFR_PLY_FILE_H

#include "scene/reader.h"

enum { SSFR_PLY_ELEMENTS = 32, SSFR_PLY_PROPERTIES = 256, SSFR_PLY_WORDS = 6 };

typedef struct ssfr_ply_property {
    const char *name;
    ssfr_scalar type;
    bool list;
    ssfr_scalar count_type; /* of a list */
} ssfr_ply_property;

typedef struct ssfr_ply_element {
    const char *name;
    size_t n;
    int first, n_properties;
} ssfr_ply_element;

typedef struct ssfr_ply {
    const char *path;
    const char *vertex; /* what a vertex is called in error lines */
    /* Gets the words of comments, the first is "comment", missing ones are empty; or NULL. */
    void (*comment)(void *user, char *words[SSFR_PLY_WORDS]);
    void *user;
    ssfr_stream stream;
    int line;
    bool has_format;
    int n_elements, n_properties;
    ssfr_ply_element elements[SSFR_PLY_ELEMENTS];
    ssfr_ply_property properties[SSFR_PLY_PROPERTIES];
} ssfr_ply;

/* Reads the header of a file, to be freed by the caller; path, vertex, comment and user are set. */
SSFR_MUST ssfr_result ssfr_ply_open(ssfr_ply *ply, char **file);

/* Value k of the n of property q (1, or a list's length, which may be 0: then it is not called) of instance i. */
typedef ssfr_result ssfr_ply_put(void *user, const ssfr_ply_property *q, size_t i, size_t k, size_t n, double value);

/* Refuses an element whose n instances, called `kinds`, the rest of the file cannot hold. */
SSFR_MUST ssfr_result ssfr_ply_check_size(const ssfr_ply *ply, const ssfr_ply_element *e, const char *kinds);
/* Reads the element's instances, which come next; put NULL: skips them. */
SSFR_MUST ssfr_result ssfr_ply_read_instances(ssfr_ply *ply, const ssfr_ply_element *e, ssfr_ply_put *put, void *user);
/* Refuses what follows the last instance of the file. */
SSFR_MUST ssfr_result ssfr_ply_check_end(ssfr_ply *ply);

#endif
