/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_defaults.c: the numbers that the papers give are where passes begin; the others are those of the docs, because
 * what was measured was measured with them. */
#include "graph/graph.h"
#include "tests/util.h"

typedef struct begins {
    const char *key, *value; /* without a dot: a node, of which all parameters follow */
} begins;

static const begins bagar2010[] = {
    {"weber", NULL}, /* fades and shares: listings A.1, A.2; the lag: A.3; the threshold: erratum B15; the others: B33 */
    {"transition", "time"}, {"start", "implied"}, {"threshold", "1900"}, {"length", "1"}, {"tension", "1"},
    {"band", "0.5"}, {"fade_in_min", "0.25"}, {"fade_in_max", "0.5"}, {"lifetime", "1"}, {"lifetime_share_min", "0.5"},
    {"lifetime_share_max", "1.5"}, {"lag", "1"}, {"seed", "0"},
    {"sparse", NULL}, /* the shrink: listing A.8; the threshold: docs/pipelines.md, what is spray */
    {"density_threshold", "400"}, {"point_shrink", "0.5"}, {"by_foam", "1"},
    {"sphere_depth", NULL}, /* point sprites: sec. 4.5; the size: erratum B16; the root: B31 */
    {"splat", "point"}, {"size", "depth"}, {"root", "exact"}, {"radius_scale", "1"}, {"max_point_px", "255"},
    {"downsample", NULL}, /* half resolution: chapter 5; the rule: erratum B34 */
    {"factor", "2"}, {"rule", "mean"},
    {"adaptive_flow", NULL}, /* steps and queries: listing A.11; the count: A.12; the radius: adaptive_flow.c */
    {"radius", "10"}, {"iterations", "256"}, {"constant", "paper"}, {"count", "current"}, {"evolution", "curvature"},
    {"step", "0.9"}, {"reference", "mean"}, {"dt", "0"}, {"unstable", "limit"}, {"depth_falloff", "5"},
    {"cross_term", "1"}, {"off_axis", "0"}, {"threshold_min", "0"}, {"stop", "tiles"}, {"query_interval", "5"},
    {"copy", "0"},
    {"upsample", NULL},
    {"filter", "cubic"}, {"depth_falloff", "5"},
    {"normals", NULL},
    {"edge", "smaller"}, {"depth_falloff", "5"}, {"off_axis", "1"},
    {NULL, NULL},
};

static const begins vanderlaan2009[] = {
    {"curvature_flow", NULL}, /* Bagar 2010, sec. 2.5.3: 40 iterations */
    {"iterations", "40"}, {"step", "0.9"}, {"reference", "mean"}, {"dt", "0"}, {"unstable", "limit"},
    {"depth_falloff", "5"}, {"cross_term", "1"}, {"off_axis", "0"},
    {NULL, NULL},
};

/* The parameters of a node; those of its off switch are not among them. */
static int count_keys(const ssfr_graph *graph, const char *node)
{
    const size_t length = strlen(node);
    int n = 0;
    for (int i = 0; ssfr_graph_key_at(graph, i); i++) {
        const char *key = ssfr_graph_key_at(graph, i);
        n += strncmp(key, node, length) == 0 && key[length] == '.' && strcmp(key + length, ".off") != 0;
    }
    return n;
}

static void assert_begins(const char *pipeline, const begins *rows)
{
    ssfr_graph *graph = NULL;
    const char *node = NULL;
    int left = 0;
    assert_int_equal(ssfr_graph_create(&graph, ssfr_pipeline_find(pipeline), NULL), SSFR_OK);
    for (const begins *row = rows; row->key; row++) {
        char key[64], text[64];
        if (!row->value) {
            assert_int_equal(left, 0); /* each parameter of the node before has a row */
            node = row->key;
            left = count_keys(graph, node);
            continue;
        }
        snprintf(key, sizeof key, "%s.%s", node, row->key);
        assert_int_equal(ssfr_graph_get(graph, key, text, sizeof text), SSFR_OK);
        if (strcmp(text, row->value) != 0) fail_msg("%s begins with %s, not %s", key, text, row->value);
        left--;
    }
    assert_int_equal(left, 0);
    ssfr_graph_destroy(&graph);
}

static void passes_begin_with_what_the_papers_and_the_docs_say(void **state)
{
    (void)state;
    assert_begins("bagar2010", bagar2010);
    assert_begins("vanderlaan2009", vanderlaan2009);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(passes_begin_with_what_the_papers_and_the_docs_say)};
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}
