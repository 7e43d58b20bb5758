/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_integrators_spec.c: reading what the bench of integrators measures; errors name file, line and column. */
#include "experiments/bench_integrators.h"
#include "experiments/yaml_tree.h"

#include "base/param.h"

/* The built-in study. The assembler reads the file, relative to the folder that make runs in. */
__asm__(".pushsection .rodata\nssfr_study_text: .incbin \"experiments/truth/integrators.yaml\"\n"
        "ssfr_study_text_end: .byte 0\n.popsection\n");
extern const char ssfr_study_text[], ssfr_study_text_end[];

const char *const ssfr_study_integrals[] = {"density", "radiance", NULL};

/* ---- readers ----------------------------------------------------------------------------------------------------- */

static ssfr_result expect_list(const ssfr_yaml_node *node, size_t most)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_yaml_expect(node, SSFR_YAML_LIST));
    if (node->n == 0 || node->n > most)
        result = ssfr_yaml_fail(node, SSFR_ERR_FORMAT, "%s: %zu values, there are 1 to %zu", node->name, node->n, most);
end:
    return result;
}

static ssfr_result read_numbers(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    ssfr_study_numbers *numbers = to;
    SSFR_TRY(expect_list(node, SSFR_STUDY_NUMBERS));
    for (size_t i = 0; i < node->n; i++) SSFR_TRY(ssfr_yaml_read_real(node->values[i], row, &numbers->values[i]));
    numbers->n = node->n;
end:
    return result;
}

static ssfr_result read_whole_numbers(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    size_t count;
    SSFR_TRY(read_numbers(node, row, to));
    for (size_t i = 0; i < node->n; i++) SSFR_TRY(ssfr_yaml_read_count(node->values[i], row, &count));
end:
    return result;
}

static ssfr_result read_scenes(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    ssfr_study *study = to;
    SSFR_TRY(expect_list(node, SSFR_STUDY_SCENES));
    for (size_t i = 0; i < node->n; i++) {
        SSFR_TRY(ssfr_yaml_read_text(node->values[i], row, &study->scenes[i]));
        study->n_scenes = i + 1;
    }
end:
    return result;
}

static ssfr_result read_range(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    ssfr_result result = SSFR_OK;
    const double *range = to;
    SSFR_TRY(ssfr_yaml_read_real2(node, row, to));
    if (range[0] > range[1])
        result = ssfr_yaml_fail(node, SSFR_ERR_VALUE, "%s: from %g to %g there is nothing", node->name, range[0],
                                range[1]);
end:
    return result;
}

static const char *const orders[] = {"random", "most", NULL};

static ssfr_result read_kind(const ssfr_yaml_node *node, ssfr_ray_kind *kind)
{
    static const ssfr_yaml_row rows[] = {
        SSFR_YAML_ROW("count", ssfr_yaml_read_count, ssfr_ray_kind, count, .min = 1, .max = SSFR_STUDY_RAYS),
        SSFR_YAML_ROW("content", read_range, ssfr_ray_kind, content, .min = 0, .max = 1e300),
        SSFR_YAML_ROW("regions", read_range, ssfr_ray_kind, regions, .min = 0, .max = 1e6),
        SSFR_YAML_ROW("order", ssfr_yaml_read_word, ssfr_ray_kind, most, .words = orders),
        SSFR_YAML_ROW_END,
    };
    ssfr_result result = SSFR_OK;
    kind->count = 16;
    kind->content[1] = kind->regions[1] = INFINITY;
    SSFR_TRY(ssfr_yaml_copy(&kind->name, "", node->key->text));
    SSFR_TRY(ssfr_yaml_read_map(node, rows, kind));
end:
    return result;
}

static ssfr_result read_kinds(const ssfr_yaml_node *node, ssfr_study *study, ssfr_study_integral integral)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_yaml_expect(node, SSFR_YAML_MAP));
    if (node->n > SSFR_STUDY_KINDS)
        return ssfr_yaml_fail(node->keys[SSFR_STUDY_KINDS], SSFR_ERR_FORMAT, "%s: more than %d kinds of rays",
                              node->name, SSFR_STUDY_KINDS);
    for (size_t i = 0; i < node->n; i++) {
        study->n_kinds[integral] = i + 1; /* also of one that is refused, so that it is freed */
        SSFR_TRY(read_kind(node->values[i], &study->kinds[integral][i]));
    }
end:
    return result;
}

static ssfr_result read_density(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    (void)row;
    return read_kinds(node, to, SSFR_STUDY_DENSITY);
}

static ssfr_result read_radiance(const ssfr_yaml_node *node, const ssfr_yaml_row *row, void *to)
{
    (void)row;
    return read_kinds(node, to, SSFR_STUDY_RADIANCE);
}

/* ---- all of it --------------------------------------------------------------------------------------------------- */

static const ssfr_yaml_row rows[] = {
    SSFR_YAML_ROW("title", ssfr_yaml_read_text, ssfr_study, title, .needed = true),
    SSFR_YAML_ROW_ALL("scenes", read_scenes, .needed = true),
    SSFR_YAML_ROW("size", ssfr_yaml_read_real2, ssfr_study, size, .unit = "px", .min = 1, .max = SSFR_MAX_SIZE),
    SSFR_YAML_ROW("fluid", ssfr_yaml_read_params, ssfr_study, fluid, .params = ssfr_continuum_rows),
    SSFR_YAML_ROW("extinction", ssfr_yaml_read_params, ssfr_study, extinction, .params = ssfr_extinction_rows),
    SSFR_YAML_ROW("candidates", ssfr_yaml_read_count, ssfr_study, candidates, .min = 1, .max = 1e5),
    SSFR_YAML_ROW_ALL("density", read_density),
    SSFR_YAML_ROW_ALL("radiance", read_radiance),
    SSFR_YAML_ROW("integrators", ssfr_yaml_read_words, ssfr_study, integrators, .needed = true,
                  .words = ssfr_integrator_names),
    SSFR_YAML_ROW("tolerances", read_numbers, ssfr_study, tolerances, .min = 1e-15, .max = 1),
    SSFR_YAML_ROW("points", read_whole_numbers, ssfr_study, points, .min = 1, .max = 64),
    SSFR_YAML_ROW("steps", read_whole_numbers, ssfr_study, steps, .min = 1, .max = 1 << 24),
    SSFR_YAML_ROW_END,
};

/* The list that an integrator takes its settings from; NULL for none. */
static const ssfr_study_numbers *list_of(const ssfr_study *study, ssfr_study_integral integral, ssfr_integrator_id id)
{
    if (id == SSFR_INTEGRATOR_gauss) return &study->points;
    if (id == SSFR_INTEGRATOR_steps) return &study->steps;
    return id == SSFR_INTEGRATOR_chords && integral == SSFR_STUDY_DENSITY ? NULL : &study->tolerances;
}

static const char *name_of(const ssfr_study *study, const ssfr_study_numbers *list)
{
    return list == &study->points ? "points" : list == &study->steps ? "steps" : "tolerances";
}

static ssfr_result check(const ssfr_study *study, const ssfr_yaml_node *root)
{
    if (study->n_kinds[SSFR_STUDY_DENSITY] + study->n_kinds[SSFR_STUDY_RADIANCE] == 0)
        return ssfr_yaml_fail(root, SSFR_ERR_FORMAT, "density or radiance must be given, with kinds of rays");
    for (int id = 0; id < SSFR_N_INTEGRATORS; id++)
        for (int k = 0; k < SSFR_N_STUDY_INTEGRALS; k++) {
            const ssfr_study_numbers *list = list_of(study, (ssfr_study_integral)k, (ssfr_integrator_id)id);
            if (study->integrators[id] && study->n_kinds[k] && list && list->n == 0)
                return ssfr_yaml_fail(ssfr_yaml_find(root, "integrators"), SSFR_ERR_FORMAT, "%s needs %s",
                                      ssfr_integrators[id].name, name_of(study, list));
        }
    return SSFR_OK;
}

ssfr_result ssfr_study_read(ssfr_study *out, const char *path, const char *text, size_t size)
{
    ssfr_result result = SSFR_OK;
    ssfr_yaml *tree = NULL;
    *out = (ssfr_study){.size = {1280, 720}, .candidates = 4096};
    ssfr_params_default(ssfr_continuum_rows, &out->fluid);
    ssfr_params_default(ssfr_extinction_rows, &out->extinction);
    SSFR_TRY(ssfr_yaml_parse(&tree, path, "study", text, size));
    SSFR_TRY(ssfr_yaml_read_map(ssfr_yaml_root(tree), rows, out));
    SSFR_TRY(check(out, ssfr_yaml_root(tree)));
end:
    ssfr_yaml_destroy(&tree);
    if (result != SSFR_OK) ssfr_study_finish(out);
    return result;
}

ssfr_result ssfr_study_load(ssfr_study *out, const char *path, char **text)
{
    ssfr_result result = SSFR_OK;
    size_t size = 0;
    *out = (ssfr_study){0};
    *text = NULL;
    if (path)
        SSFR_TRY(ssfr_read_file(path, SSFR_YAML_FILE, text, &size));
    else
        SSFR_TRY(ssfr_yaml_copy(text, "", ssfr_study_text));
    SSFR_TRY(ssfr_study_read(out, path ? path : "the built-in study", *text, path ? size : strlen(*text)));
end:
    return result;
}

void ssfr_study_finish(ssfr_study *study)
{
    for (size_t i = 0; i < study->n_scenes; i++) free(study->scenes[i]);
    for (int k = 0; k < SSFR_N_STUDY_INTEGRALS; k++)
        for (size_t i = 0; i < study->n_kinds[k]; i++) free(study->kinds[k][i].name);
    free(study->title);
    *study = (ssfr_study){0};
}

ssfr_study_numbers ssfr_study_settings(const ssfr_study *study, ssfr_study_integral integral, ssfr_integrator_id id)
{
    const ssfr_study_numbers *list = list_of(study, integral, id);
    return list ? *list : (ssfr_study_numbers){1, {NAN}};
}
