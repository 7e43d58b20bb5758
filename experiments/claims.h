/* SPDX-License-Identifier: GPL-3.0-or-later */
/* claims.h: what a paper claims, as rules over tables that were fixed before measuring, and what came of them.
 *
 *      - id: bagar-cost
 *        where: Tab. 5.1
 *        statement: with foam a frame costs at most 1.45 times that of van der Laan
 *        published: 1.14, 1.36, 1.42          # may be missing, as unit and note
 *        unit: "1"
 *        rule: max(ratio(tab5_1.ms_median, variant=bagar2010, variant=vanderlaan2009)) <= 1.45
 *        note: what to know of it */
#ifndef SSFR_CLAIMS_H
#define SSFR_CLAIMS_H

#include "experiments/expression.h"

typedef struct ssfr_claim {
    char *id, *where, *statement, *published, *unit, *rule, *note; /* published, unit, note: NULL when not given */
    ssfr_expression *expression;
    ssfr_verdict verdict; /* after ssfr_claims_judge */
} ssfr_claim;

typedef struct ssfr_claims {
    char *paper;
    size_t n;
    ssfr_claim *claims;
} ssfr_claims;

/* Reads the claims of a paper from the text of its claims.yaml; path is what errors call it. */
SSFR_MUST ssfr_result ssfr_claims_parse(ssfr_claims **out, const char *paper, const char *path, const char *text,
                                        size_t size);
void ssfr_claims_destroy(ssfr_claims **claims);

/* Holds them to the tables <folder>/<paper>/<name>.csv. */
SSFR_MUST ssfr_result ssfr_claims_judge(ssfr_claims *claims, const char *folder);
/* "yes", "no" or "not measured". */
const char *ssfr_claim_holds(const ssfr_claim *claim);

/* Writes them into <folder>/claims.csv, in the place of what stands there of this paper; other rows stay. The file is
 * written aside and renamed when complete. */
SSFR_MUST ssfr_result ssfr_claims_save(const ssfr_claims *claims, const char *folder);

#endif
