/* SPDX-License-Identifier: GPL-3.0-or-later */
/* counted_memory.h: memory that is counted and may run out, for tests that are linked so (see the Makefile): the linker
 * puts these in front of malloc and its kin. No two threads may call them at once. */
#ifndef SSFR_TESTS_COUNTED_MEMORY_H
#define SSFR_TESTS_COUNTED_MEMORY_H

#include <stdlib.h>

void *__real_malloc(size_t size);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *memory, size_t size);
void __real_free(void *memory);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_realloc(void *memory, size_t size);
void __wrap_free(void *memory);

static long n_made, fails_at = -1; /* allocations so far; the one that fails, -1: none */

void *__wrap_malloc(size_t size)
{
    return n_made++ == fails_at ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t n, size_t size)
{
    return n_made++ == fails_at ? NULL : __real_calloc(n, size);
}

void *__wrap_realloc(void *memory, size_t size)
{
    return n_made++ == fails_at ? NULL : __real_realloc(memory, size);
}

void __wrap_free(void *memory)
{
    __real_free(memory);
}

#endif
