/* SPDX-License-Identifier: GPL-3.0-or-later */
/* catalogue.c: finding a scene by its name. */
#include "experiments/scenes/embedded.h"
#include "experiments/scenes/scenes.h"
#include "experiments/sequence.h"

#include <strings.h>
#include <unistd.h>

static const char ending[] = ".yaml";

static bool is_scene_file(const char *path)
{
    const size_t length = strlen(path), n = strlen(ending);
    return length > n && strcasecmp(path + length - n, ending) == 0;
}

static void set_embedded(const ssfr_embedded *file, ssfr_scene_source *out)
{
    *out = (ssfr_scene_source){.kind = SSFR_SCENE_DESCRIBED, .embedded = file};
    snprintf(out->name, sizeof out->name, "%.*s", (int)(strlen(file->name) - strlen(ending)), file->name);
}

bool ssfr_scene_at(int i, ssfr_scene_source *out)
{
    const ssfr_embedded *found = NULL;
    int n = 0;
    for (int k = 0; ssfr_embedded_at(k) && !found; k++)
        if (is_scene_file(ssfr_embedded_at(k)->name) && n++ == i) found = ssfr_embedded_at(k);
    if (found) set_embedded(found, out);
    return found != NULL;
}

/* ---- by name ----------------------------------------------------------------------------------------------------- */

/* "wave" is the last part of "imai2016/wave". */
static bool ends_in(const char *name, const char *word)
{
    const char *slash = strrchr(name, '/');
    return slash && strcmp(slash + 1, word) == 0;
}

/* True when the word is a whole name, else how many names end in it, with the first of them in *out. */
static bool match(const char *word, int *n_ending, ssfr_scene_source *out)
{
    ssfr_scene_source s;
    bool whole = false;
    *n_ending = 0;
    for (int i = 0; ssfr_scene_at(i, &s) && !whole; i++) {
        whole = strcmp(s.name, word) == 0;
        if (whole || (ends_in(s.name, word) && (*n_ending)++ == 0)) *out = s;
    }
    return whole;
}

static ssfr_result fail_ambiguous(const char *word)
{
    ssfr_scene_source s;
    char names[256] = "";
    size_t used = 0;
    for (int i = 0; ssfr_scene_at(i, &s) && used < sizeof names; i++)
        if (ends_in(s.name, word))
            used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", used ? " and " : "", s.name);
    return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: there are %s", word, names);
}

static ssfr_result fail_unknown(const char *word)
{
    ssfr_scene_source s;
    char names[768] = "";
    size_t used = 0;
    for (int i = 0; ssfr_builtin_at(i); i++) ssfr_list_name(names, sizeof names, &used, ssfr_builtin_at(i)->name);
    for (int i = 0; ssfr_scene_at(i, &s); i++) ssfr_list_name(names, sizeof names, &used, s.name);
    return ssfr_fail(SSFR_ERR_UNKNOWN, "%s: no such file, and not a built-in scene (%s)", word, names);
}

ssfr_result ssfr_scene_find(const char *word, ssfr_scene_source *out)
{
    int n_ending = 0;
    *out = (ssfr_scene_source){.builtin = ssfr_builtin_find(word)};
    if (strlen(word) >= sizeof out->name)
        return ssfr_fail(SSFR_ERR_VALUE, "a scene's name of %zu bytes: expected fewer than %zu", strlen(word),
                         sizeof out->name);
    if (!out->builtin && (match(word, &n_ending, out) || n_ending == 1)) return SSFR_OK;
    if (n_ending > 1) return fail_ambiguous(word);
    snprintf(out->name, sizeof out->name, "%s", word);
    if (out->builtin) return SSFR_OK;
    if (ssfr_sequence_is(word)) {
        out->kind = SSFR_SCENE_SEQUENCE;
        return ssfr_sequence_check(word);
    }
    out->kind = is_scene_file(word) ? SSFR_SCENE_DESCRIBED : SSFR_SCENE_PARTICLES;
    return access(word, F_OK) == 0 ? SSFR_OK : fail_unknown(word);
}

ssfr_result ssfr_scene_describe(const ssfr_scene_source *source, ssfr_scale scale, ssfr_description **out)
{
    const ssfr_embedded *file = source->embedded;
    if (!file) return ssfr_description_load(out, source->name, scale);
    return ssfr_description_parse(out, source->name, file->begin, scale, ssfr_embedded_mesh);
}
