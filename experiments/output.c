/* SPDX-License-Identifier: GPL-3.0-or-later */
/* output.c: endings, and whether a file or folder can be written. */
#include "experiments/output.h"

#include <errno.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

static bool ends_with(const char *path, const char *ending)
{
    const size_t length = strlen(path), n = strlen(ending);
    return length > n && strcasecmp(path + length - n, ending) == 0;
}

ssfr_output_kind ssfr_output_kind_of(const char *path)
{
    return ends_with(path, ".exr") ? SSFR_OUTPUT_EXR : ends_with(path, ".png") ? SSFR_OUTPUT_PNG : SSFR_OUTPUT_OTHER;
}

static bool is_folder(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

/* The folder that the path stands in can be written to. "new/" stands where "new" does. */
static ssfr_result check_parent(const char *path)
{
    ssfr_result result = SSFR_OK;
    size_t n = strlen(path);
    char *parent = NULL;
    SSFR_TRY(ssfr_alloc(&parent, n + 2, 1, "a path"));
    while (n > 1 && path[n - 1] == '/') n--;
    while (n > 0 && path[n - 1] != '/') n--;
    while (n > 1 && path[n - 1] == '/') n--;
    if (n > 0)
        memcpy(parent, path, n);
    else
        parent[0] = '.';
    if (access(parent, F_OK) == 0 && !is_folder(parent))
        result = ssfr_fail(SSFR_ERR_IO, "%s: %s is not a folder", path, parent);
    else if (access(parent, W_OK | X_OK) != 0)
        result = ssfr_fail(SSFR_ERR_IO, "%s: cannot be written: %s: %s", path, parent, strerror(errno));
end:
    free(parent);
    return result;
}

ssfr_result ssfr_output_check_file(const char *path)
{
    struct stat info;
    if (!path[0]) return ssfr_fail(SSFR_ERR_VALUE, "an empty file name");
    if (is_folder(path)) return ssfr_fail(SSFR_ERR_IO, "%s: is a folder", path);
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode))
        return ssfr_fail(SSFR_ERR_IO, "%s: is not a regular file", path);
    return check_parent(path);
}

ssfr_result ssfr_output_check_image(const char *path, bool png_too)
{
    const ssfr_output_kind kind = ssfr_output_kind_of(path);
    if (kind != SSFR_OUTPUT_EXR && !(png_too && kind == SSFR_OUTPUT_PNG))
        return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: the name must end in .exr%s", path, png_too ? " or .png" : "");
    return ssfr_output_check_file(path);
}

ssfr_result ssfr_output_check_folder(const char *path)
{
    if (access(path, F_OK) != 0) return check_parent(path);
    if (!is_folder(path)) return ssfr_fail(SSFR_ERR_IO, "%s: is not a folder", path);
    if (access(path, W_OK | X_OK) != 0) return ssfr_fail(SSFR_ERR_IO, "%s: %s", path, strerror(errno));
    return SSFR_OK;
}

ssfr_result ssfr_output_make_folder(const char *path)
{
    const int code = mkdir(path, 0777) == 0 ? 0 : errno;
    if (code == 0 || is_folder(path)) return SSFR_OK; /* asked afterwards: another process may make it, too */
    return ssfr_fail(SSFR_ERR_IO, "%s: %s", path, strerror(code));
}

ssfr_result ssfr_output_check_resume(bool resume, const char *output)
{
    if (resume && !output)
        return ssfr_fail(SSFR_ERR_VALUE, "--resume needs the table to go on with: -o FILE.csv");
    return SSFR_OK;
}
