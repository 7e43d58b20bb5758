/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cache.c: folders and locks of what is kept on disk. */
#include "experiments/cache.h"
#include "experiments/interrupt.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

ssfr_result ssfr_cache_find(char **out, const char *given, const char *kind)
{
    enum { MAX_LENGTH = 1023 }; /* bytes: names of files follow */
    const char *xdg = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    char text[MAX_LENGTH + 1];
    int length;
    *out = NULL;
    if (given)
        length = snprintf(text, sizeof text, "%s", given);
    else if (xdg && xdg[0] == '/') /* a relative one is to be ignored, says the standard */
        length = snprintf(text, sizeof text, "%s/ssfr/%s", xdg, kind);
    else if (home && home[0])
        length = snprintf(text, sizeof text, "%s/.cache/ssfr/%s", home, kind);
    else
        return ssfr_fail(SSFR_ERR_IO, "neither XDG_CACHE_HOME nor HOME says where %s are kept: give --cache DIR", kind);
    if (length < 1 || length > MAX_LENGTH)
        return ssfr_fail(SSFR_ERR_VALUE, "the folder for %s has a name of %d bytes: expected 1 to %d", kind, length,
                         MAX_LENGTH);
    return ssfr_text_print(out, "a path", "%s", text);
}

ssfr_result ssfr_cache_make_folders(const char *path)
{
    ssfr_result result = SSFR_OK;
    char *part = NULL;
    SSFR_TRY(ssfr_alloc(&part, strlen(path) + 1, 1, "a path"));
    for (size_t n = 1; result == SSFR_OK; n++) {
        if (path[n] == '/' || path[n] == '\0') {
            memcpy(part, path, n);
            if (mkdir(part, 0777) != 0 && errno != EEXIST)
                result = ssfr_fail(SSFR_ERR_IO, "%s: the folder cannot be made: %s", part, strerror(errno));
        }
        if (path[n] == '\0') break;
    }
end:
    free(part);
    return result;
}

ssfr_result ssfr_cache_hold(const char *path, const char *what, int *fd)
{
    ssfr_result result = SSFR_OK;
    const struct timespec pause = {.tv_nsec = 100000000}; /* ns */
    bool said = false;
    *fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (*fd < 0) return ssfr_fail(SSFR_ERR_IO, "%s: %s", path, strerror(errno));
    while (result == SSFR_OK && flock(*fd, LOCK_EX | LOCK_NB) != 0) {
        if (errno != EWOULDBLOCK && errno != EINTR) {
            result = ssfr_fail(SSFR_ERR_IO, "%s: %s", path, strerror(errno));
        } else if (ssfr_interrupt_came()) {
            result = ssfr_fail(SSFR_ERR_IO, "interrupted while another process makes %s", what);
        } else {
            if (!said) ssfr_log(SSFR_WARNING, "waiting for another process that makes %s", what);
            said = true;
            nanosleep(&pause, NULL);
        }
    }
    if (result == SSFR_OK) return SSFR_OK;
    close(*fd);
    *fd = -1;
    return result;
}
