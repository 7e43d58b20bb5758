/* SPDX-License-Identifier: GPL-3.0-or-later */
/* papers.h: which papers can be reproduced: folders of sweeps and claims, on disk or inside the program.
 *
 * A folder with a claims.yaml is a paper, each other .yaml in it an item, and published/ holds the paper's own tables.
 * Where ./experiments holds papers, as in the source tree, these are read: what is edited is what is run. Elsewhere it
 * is those that the program was built with, so that it reproduces them without any file. The two are never mixed. */
#ifndef SSFR_PAPERS_H
#define SSFR_PAPERS_H

#include "base/base.h"

typedef struct ssfr_paper {
    char *name;
    size_t n_items;
    char **items; /* sorted, without ".yaml" */
} ssfr_paper;

typedef struct ssfr_papers {
    bool on_disk;
    size_t n;
    ssfr_paper *papers; /* sorted */
} ssfr_papers;

SSFR_MUST ssfr_result ssfr_papers_create(ssfr_papers **out);
void ssfr_papers_destroy(ssfr_papers **papers);

/* What errors call the file <paper>/<name> (in a folder of the paper: "published/tab1.csv"). */
enum { SSFR_PAPER_PATH = 1024 };
const char *ssfr_papers_path(const ssfr_papers *papers, const char *paper, const char *name,
                             char path[SSFR_PAPER_PATH]);
/* Its text, with a closing zero byte. */
SSFR_MUST ssfr_result ssfr_papers_read(const ssfr_papers *papers, const char *paper, const char *name, char **text,
                                       size_t *size);

#endif
