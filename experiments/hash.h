/* SPDX-License-Identifier: GPL-3.0-or-later */
/* hash.h: FNV-1a, 64 bit: tells contents apart that nobody makes alike on purpose. */
#ifndef SSFR_HASH_H
#define SSFR_HASH_H

#include "base/base.h"

/* The hash of nothing: begin with it. */
#define SSFR_HASH UINT64_C(0xcbf29ce484222325)

uint64_t ssfr_hash_bytes(uint64_t hash, const void *data, size_t size);
uint64_t ssfr_hash_text(uint64_t hash, const char *text); /* with its closing zero, so that texts do not run together */

#endif
