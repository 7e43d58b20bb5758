/* SPDX-License-Identifier: MIT */
/* soup.h: triangles as files have them, polygon by polygon, before they are a mesh. */
#ifndef SSFR_SOUP_H
#define SSFR_SOUP_H

#include "scene/reader.h"

enum { SSFR_SOUP_CORNERS = 4096 /* of a polygon, at most */ };

typedef struct ssfr_soup {
    const char *path;
    size_t n_vertices, cap_vertices, n_triangles, cap_triangles;
    double *vertices;    /* m */
    uint32_t *triangles; /* vertices, counter-clockwise seen from outside */
} ssfr_soup;

typedef ssfr_result ssfr_soup_reader(ssfr_soup *soup);
ssfr_soup_reader ssfr_obj_read, ssfr_stl_read, ssfr_ply_read_mesh;

SSFR_MUST ssfr_result ssfr_soup_vertex(ssfr_soup *soup, const double at[3]);
/* Cuts a polygon of n vertices, which there are, into n - 2 triangles; n is at least 3. It may be concave. */
SSFR_MUST ssfr_result ssfr_soup_polygon(ssfr_soup *soup, int n, const uint32_t *corners);
/* Vertices in the same place become one. */
SSFR_MUST ssfr_result ssfr_soup_weld(ssfr_soup *soup);
void ssfr_soup_finish(ssfr_soup *soup);

#endif
