/* SPDX-License-Identifier: GPL-3.0-or-later */
/* disk.c: what tests of saving use: a disk that is full, and a look at what was left lying about. */
#include "tests/disk.h"

#include "tests/util.h"

#include <dirent.h>
#include <signal.h>
#include <sys/resource.h>

void test_limit_file_size(size_t size)
{
    struct rlimit limit;
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
    limit.rlim_cur = size < limit.rlim_max ? size : limit.rlim_max;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

int test_count_files(const char *path, const char *text)
{
    char folder[256];
    snprintf(folder, sizeof folder, "%.*s", (int)(strrchr(path, '/') - path), path);
    DIR *dir = opendir(folder);
    assert_non_null(dir);
    int n = 0;
    for (struct dirent *entry = readdir(dir); entry; entry = readdir(dir)) n += strstr(entry->d_name, text) ? 1 : 0;
    closedir(dir);
    return n;
}
