/* SPDX-License-Identifier: GPL-3.0-or-later */
/* counted_memory.h: memory that is counted and may run out, for tests that are linked so (see the Makefile): the linker
 * puts these in front of malloc and its kin. What the GL driver, GSL, cmocka and the C library take is not counted. */
#ifndef SSFR_TESTS_COUNTED_MEMORY_H
#define SSFR_TESTS_COUNTED_MEMORY_H

#include <malloc.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>

void *__real_malloc(size_t size);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *memory, size_t size);
void __real_free(void *memory);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_realloc(void *memory, size_t size);
void __wrap_free(void *memory);

static atomic_long n_made, n_live;    /* allocations so far, and those that are not freed */
static atomic_long bytes, peak_bytes; /* that are held; the most since peak_bytes was set */
static long fails_at = -1;            /* the allocation that fails, -1: none */

static bool runs_out(void)
{
    return atomic_fetch_add(&n_made, 1) == fails_at;
}

static void *count(void *memory)
{
    if (!memory) return NULL;
    const long size = (long)malloc_usable_size(memory), held = atomic_fetch_add(&bytes, size) + size;
    long peak = atomic_load(&peak_bytes);
    while (peak < held && !atomic_compare_exchange_weak(&peak_bytes, &peak, held)) continue;
    atomic_fetch_add(&n_live, 1);
    return memory;
}

static void uncount(void *memory)
{
    if (!memory) return;
    atomic_fetch_sub(&bytes, (long)malloc_usable_size(memory));
    atomic_fetch_sub(&n_live, 1);
}

void *__wrap_malloc(size_t size)
{
    return runs_out() ? NULL : count(__real_malloc(size));
}

void *__wrap_calloc(size_t n, size_t size)
{
    return runs_out() ? NULL : count(__real_calloc(n, size));
}

void *__wrap_realloc(void *memory, size_t size)
{
    if (runs_out()) return NULL;
    uncount(memory);
    return count(__real_realloc(memory, size));
}

void __wrap_free(void *memory)
{
    uncount(memory);
    __real_free(memory);
}

#endif
