/* SPDX-License-Identifier: GPL-3.0-or-later */
/* disk.h: what tests of saving use: a disk that is full, and a look at what was left lying about. */
#ifndef SSFR_TESTS_DISK_H
#define SSFR_TESTS_DISK_H

#include <stddef.h>

/* From here on no file may grow beyond `size` bytes: more fails, as on a full disk. SIZE_MAX lifts the limit. */
void test_limit_file_size(size_t size);

/* Files in the folder of `path` whose names hold `text`. */
int test_count_files(const char *path, const char *text);

#endif
