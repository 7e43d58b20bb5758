/* SPDX-License-Identifier: GPL-3.0-or-later */
/* hash.c: FNV-1a, 64 bit. */
#include "experiments/hash.h"

uint64_t ssfr_hash_bytes(uint64_t hash, const void *data, size_t size)
{
    const unsigned char *bytes = data;
    for (size_t i = 0; i < size; i++) hash = (hash ^ bytes[i]) * UINT64_C(0x100000001b3);
    return hash;
}

uint64_t ssfr_hash_text(uint64_t hash, const char *text)
{
    return ssfr_hash_bytes(hash, text, strlen(text) + 1);
}
