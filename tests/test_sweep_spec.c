/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_sweep_spec.c: axes, products and YAML; every malformed sweep is refused with file, line and column. */
#include "experiments/sweep_spec.h"
#include "tests/util.h"

#include <unistd.h>

static ssfr_sweep_spec *new_spec(void)
{
    ssfr_sweep_spec *spec = NULL;
    assert_int_equal(ssfr_sweep_spec_create(&spec), SSFR_OK);
    return spec;
}

/* The values of one axis, with spaces between. */
static void assert_axis(const char *text, const char *expected)
{
    ssfr_sweep_spec *spec = new_spec();
    char joined[512] = "";
    assert_int_equal(ssfr_sweep_spec_vary_text(spec, "--vary", text), SSFR_OK);
    const ssfr_axis *axis = &spec->axes[0];
    for (size_t i = 0; i < axis->n; i++) {
        const size_t used = strlen(joined);
        snprintf(joined + used, sizeof joined - used, "%s%s", i ? " " : "", axis->values[i]);
    }
    assert_string_equal(joined, expected);
    ssfr_sweep_spec_destroy(&spec);
    assert_null(spec);
}

static void a_list_keeps_its_values_to_the_letter(void **state)
{
    (void)state;
    assert_axis("splat.kind=point,quad,exact", "point quad exact");
    assert_axis("flow.step=0.30, 2.385 ,1e-3", "0.30 2.385 1e-3");
    assert_axis("backend=gl,cpu", "gl cpu");
    assert_axis("scene=a:b:c,/tmp/x=y.ply", "a:b:c /tmp/x=y.ply");
}

static void a_range_includes_its_end_when_it_is_hit(void **state)
{
    (void)state;
    assert_axis("flow.iterations=0:80:20", "0 20 40 60 80");
    assert_axis("flow.iterations=0:79:20", "0 20 40 60");
    assert_axis("flow.step=0:0.3:0.1", "0 0.1 0.2 0.3");
    assert_axis("flow.step=1:0:-0.25", "1 0.75 0.5 0.25 0");
    assert_axis("flow.step=2.385:2.385:1", "2.385");
    assert_axis("flow.step=0:0.29999999999:0.1", "0 0.1 0.2 0.3");
    assert_axis("flow.step=0:0.29999999:0.1", "0 0.1 0.2");
    assert_axis("flow.step=-0.3:0.3:0.3", "-0.3 0 0.3");
    assert_axis("flow.step=-0.3:0.1:0.1", "-0.3 -0.2 -0.1 0 0.1");
}

static void a_logarithmic_range_has_equal_ratios(void **state)
{
    (void)state;
    assert_axis("flow.step=0.001:1000:7 log", "0.001 0.01 0.1 1 10 100 1000");
    assert_axis("flow.step=9:1:3 log", "9 3 1");
    assert_axis("flow.step=1e-12:1e-10:3 log", "1e-12 1e-11 1e-10");
}

static void malformed_axes_are_refused(void **state)
{
    (void)state;
    static const struct {
        ssfr_result code;
        const char *text, *message;
    } cases[] = {
        {SSFR_ERR_VALUE, "flow.step", "--vary flow.step: expected key=value"},
        {SSFR_ERR_VALUE, "=1,2", "--vary =1,2: expected key=value"},
        {SSFR_ERR_VALUE, "", "--vary : expected key=value"},
        {SSFR_ERR_UNKNOWN, "speed=1,2", "no axis speed"},
        {SSFR_ERR_VALUE, "flow.step=", "--vary: flow.step: value 1 is empty"},
        {SSFR_ERR_VALUE, "flow.step=1,,3", "value 2 is empty"},
        {SSFR_ERR_VALUE, "flow.step=1, ", "value 2 is empty"},
        {SSFR_ERR_VALUE, "flow.step=1,2,1", "flow.step: 1 stands twice"},
        {SSFR_ERR_VALUE, "flow.step=0:80", "flow.step=0:80: expected lo:hi:step"},
        {SSFR_ERR_VALUE, "flow.step=0:80:1:2", "expected lo:hi:step"},
        {SSFR_ERR_VALUE, "flow.step=0:x:1", "expected lo:hi:step"},
        {SSFR_ERR_VALUE, "flow.step=0:nan:1", "expected lo:hi:step"},
        {SSFR_ERR_VALUE, "flow.step=::", "expected lo:hi:step"},
        {SSFR_ERR_VALUE, "flow.step=0:80:0", "the step never reaches the end"},
        {SSFR_ERR_VALUE, "flow.step=0:80:-1", "the step never reaches the end"},
        {SSFR_ERR_VALUE, "flow.step=0:80:1e-9", "80000000001 values, at most 10000"},
        {SSFR_ERR_VALUE, "flow.step=-1e308:1e308:1e-300", "inf values, at most 10000"},
        {SSFR_ERR_VALUE, "flow.step=0:1:3 log", "both ends of a logarithmic range must be positive"},
        {SSFR_ERR_VALUE, "flow.step=1:2:1 log", "a whole number of values, at least 2"},
        {SSFR_ERR_VALUE, "flow.step=1:2:2.5 log", "a whole number of values, at least 2"},
        {SSFR_ERR_VALUE, "flow.step=1:2:1e6 log", "1000000 values, at most 10000"},
        {SSFR_ERR_VALUE, "flow.step=1:1.0000000001:3 log", "1 stands twice"},
    };
    ssfr_sweep_spec *spec = new_spec();
    for (size_t i = 0; i < SSFR_COUNT(cases); i++)
        assert_fails(cases[i].code, ssfr_sweep_spec_vary_text(spec, "--vary", cases[i].text), cases[i].message);
    assert_int_equal(spec->n_axes, 0);
    ssfr_sweep_spec_destroy(&spec);
}

static void an_axis_of_too_many_values_or_too_many_axes_are_refused(void **state)
{
    (void)state;
    ssfr_sweep_spec *spec = new_spec();
    char *text = NULL;
    assert_int_equal(ssfr_alloc(&text, 20100, 1, "a list"), SSFR_OK);
    strcpy(text, "a.b=");
    for (int i = 0; i <= SSFR_MAX_VALUES; i++) strcpy(text + 4 + 2 * i, "1,");
    assert_fails(SSFR_ERR_VALUE, ssfr_sweep_spec_vary_text(spec, "--vary", text),
                 "a.b has 10002 values, at most 10000");
    free(text);
    for (int i = 0; i < SSFR_MAX_AXES; i++) {
        char key[16];
        snprintf(key, sizeof key, "a.b%d", i);
        assert_int_equal(ssfr_sweep_spec_vary(spec, "--vary", key, "1,2"), SSFR_OK);
    }
    assert_fails(SSFR_ERR_VALUE, ssfr_sweep_spec_vary(spec, "--vary", "a.c", "1"), "a.c: more than 16 axes");
    assert_int_equal(ssfr_sweep_spec_vary(spec, "--vary", "a.b0", "3"), SSFR_OK);
    ssfr_sweep_spec_destroy(&spec);
}

static void an_axis_given_again_is_replaced_in_its_place(void **state)
{
    (void)state;
    ssfr_sweep_spec *spec = new_spec();
    assert_int_equal(ssfr_sweep_spec_vary_text(spec, "spec", "a.b=1,2"), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_vary_text(spec, "spec", "backend=gl,cpu"), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_vary_text(spec, "--vary", "a.b=5,6,7"), SSFR_OK);
    assert_int_equal(spec->n_axes, 2);
    assert_int_equal(spec->axes[0].n, 3);
    assert_string_equal(spec->axes[0].values[2], "7");
    assert_ptr_equal(ssfr_sweep_spec_axis(spec, "backend"), &spec->axes[1]);
    assert_null(ssfr_sweep_spec_axis(spec, "size"));
    ssfr_sweep_spec_destroy(&spec);
}

static void the_product_runs_with_the_last_axis_fastest(void **state)
{
    (void)state;
    ssfr_sweep_spec *spec = new_spec();
    size_t n = 0, index[SSFR_MAX_AXES];
    assert_int_equal(ssfr_sweep_spec_count(spec, &n), SSFR_OK);
    assert_int_equal(n, 1);
    assert_int_equal(ssfr_sweep_spec_vary(spec, "", "a.b", "1,2"), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_vary(spec, "", "a.c", "0:4:2"), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_vary(spec, "", "backend", "gl,cpu"), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_count(spec, &n), SSFR_OK);
    assert_int_equal(n, 12);
    for (size_t i = 0; i < n; i++) {
        ssfr_sweep_spec_run(spec, i, index);
        assert_int_equal(index[0], i / 6);
        assert_int_equal(index[1], i / 2 % 3);
        assert_int_equal(index[2], i % 2);
    }
    ssfr_sweep_spec_destroy(&spec);
}

static void a_product_without_end_is_refused(void **state)
{
    (void)state;
    ssfr_sweep_spec *spec = new_spec();
    size_t n = 2385;
    for (int i = 0; i < 5; i++) {
        const char key[] = {'a', '.', (char)('a' + i), '\0'};
        assert_int_equal(ssfr_sweep_spec_vary(spec, "--vary", key, "1:10000:1"), SSFR_OK);
    }
    assert_fails(SSFR_ERR_VALUE, ssfr_sweep_spec_count(spec, &n), "with a.b the sweep has more than 10000000 runs");
    assert_int_equal(n, 2385);
    ssfr_sweep_spec_destroy(&spec);
}

static void settings_are_split_at_the_first_equals_sign(void **state)
{
    (void)state;
    ssfr_sweep_spec *spec = new_spec();
    assert_int_equal(ssfr_sweep_spec_set_text(spec, "--set", "a.b=c=d"), SSFR_OK);
    assert_string_equal(spec->settings.items[0].key, "a.b");
    assert_string_equal(spec->settings.items[0].value, "c=d");
    assert_string_equal(spec->settings.items[0].where, "--set");
    assert_fails(SSFR_ERR_VALUE, ssfr_sweep_spec_set_text(spec, "--set", "a.b"), "--set a.b: expected key=value");
    for (int i = 1; i < SSFR_MAX_SETTINGS; i++) assert_int_equal(ssfr_sweep_spec_set_text(spec, "", "a.b=1"), SSFR_OK);
    assert_fails(SSFR_ERR_VALUE, ssfr_sweep_spec_set_text(spec, "--set", "a.b=1"), "more than 256 settings");
    ssfr_sweep_spec_destroy(&spec);
}

static void a_sweep_is_completed_by_what_it_lacks(void **state)
{
    (void)state;
    ssfr_sweep_spec *spec = new_spec();
    size_t n = 0;
    assert_int_equal(ssfr_sweep_spec_vary_text(spec, "", "size=640x360,64x48"), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_complete(spec), SSFR_OK);
    assert_int_equal(spec->n_axes, 4);
    assert_string_equal(spec->axes[0].key, "size");
    assert_string_equal(spec->axes[1].values[0], "vanderlaan2009");
    assert_string_equal(spec->axes[2].values[0], "splash");
    assert_string_equal(spec->axes[3].key, "backend");
    assert_string_equal(spec->axes[3].values[0], "gl");
    assert_int_equal(ssfr_sweep_spec_complete(spec), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_count(spec, &n), SSFR_OK);
    assert_int_equal(n, 2);
    ssfr_sweep_spec_destroy(&spec);
}

static void a_reference_is_there_once_it_has_a_setting(void **state)
{
    (void)state;
    ssfr_sweep_spec *spec = new_spec();
    assert_int_equal(spec->compared_with, SSFR_REFERENCE_NONE);
    assert_int_equal(ssfr_sweep_spec_reference_text(spec, "--reference", "flow.step=2.385"), SSFR_OK);
    assert_int_equal(spec->compared_with, SSFR_REFERENCE_FRAME);
    assert_string_equal(spec->reference.items[0].value, "2.385");
    assert_fails(SSFR_ERR_VALUE, ssfr_sweep_spec_reference_text(spec, "--reference", "flow"),
                 "--reference flow: expected");
    ssfr_sweep_spec_destroy(&spec);
}

static void the_reference_is_the_truth_or_a_frame(void **state)
{
    (void)state;
    ssfr_sweep_spec *spec = new_spec();
    assert_int_equal(ssfr_sweep_spec_reference_text(spec, "--reference", "truth"), SSFR_OK);
    assert_int_equal(spec->compared_with, SSFR_REFERENCE_TRUTH);
    assert_fails(SSFR_ERR_VALUE, ssfr_sweep_spec_reference_text(spec, "--reference", "flow.step=2.385"),
                 "--reference flow.step=2.385: the reference is the truth");
    assert_int_equal(spec->reference.n, 0);
    ssfr_sweep_spec_destroy(&spec);
    spec = new_spec();
    assert_int_equal(ssfr_sweep_spec_reference_text(spec, "--reference", "flow.step=2.385"), SSFR_OK);
    assert_fails(SSFR_ERR_VALUE, ssfr_sweep_spec_reference_text(spec, "--reference", "truth"),
                 "--reference truth: beside flow.step=2.385");
    ssfr_sweep_spec_destroy(&spec);
}

static void a_frame_of_the_file_yields_to_the_truth_of_the_command_line(void **state)
{
    (void)state;
    ssfr_sweep_spec *spec = new_spec();
    assert_int_equal(ssfr_sweep_spec_reference_text(spec, "spec.yaml:7:3", "flow.step=2.385"), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_reference_text(spec, "--reference", "truth"), SSFR_OK);
    assert_int_equal(spec->compared_with, SSFR_REFERENCE_TRUTH);
    assert_int_equal(spec->reference.n, 0);
    ssfr_sweep_spec_destroy(&spec);
}

/* A completed sweep's kind of truth; "" when it has no such axis. */
static const char *kind_of(ssfr_sweep_spec *spec, char text[64])
{
    assert_int_equal(ssfr_sweep_spec_complete(spec), SSFR_OK);
    const ssfr_axis *axis = ssfr_sweep_spec_axis(spec, "truth.kind");
    snprintf(text, 64, "%s", axis ? axis->values[axis->n - 1] : "");
    assert_string_equal(spec->axes[spec->n_axes - 1].key, "backend");
    ssfr_sweep_spec_destroy(&spec);
    return text;
}

static void every_table_names_its_truth(void **state)
{
    (void)state;
    char text[64];
    ssfr_sweep_spec *spec = new_spec();
    assert_string_equal(kind_of(spec, text), "");
    spec = new_spec();
    assert_int_equal(ssfr_sweep_spec_reference_text(spec, "", "truth"), SSFR_OK);
    assert_string_equal(kind_of(spec, text), "density");
    spec = new_spec();
    assert_int_equal(ssfr_sweep_spec_reference_text(spec, "", "truth"), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_set_text(spec, "", "truth.kind=zhu_bridson"), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_set_text(spec, "", "truth.kind=spheres"), SSFR_OK);
    assert_string_equal(kind_of(spec, text), "spheres");
    spec = new_spec();
    assert_int_equal(ssfr_sweep_spec_reference_text(spec, "", "truth"), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_set_text(spec, "", "truth.kind=spheres"), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_vary_text(spec, "", "truth.kind=density,anisotropic"), SSFR_OK);
    assert_string_equal(kind_of(spec, text), "anisotropic");
}

static const char whole[] = "# a comment\n"
                            "title: What a step costs\n"
                            "pipeline: [vanderlaan2009, bagar2010]\n"
                            "scene: splash\n"
                            "size: [320x180, 640x360]\n"
                            "set: {floor.tile: 0.5}\n"
                            "vary:\n"
                            "  flow.iterations: 0:80:40\n"
                            "  flow.step: [0.3, 0.6]\n"
                            "  pass.as_printed: [none, \"B10,B11\"]\n"
                            "backend: gl, cpu\n"
                            "reference:\n"
                            "  flow.iterations: 60\n"
                            "plot: {title: Work, x: ref_psnr, y: ms_median, lines: [flow.step, backend]}\n"
                            "curves:\n"
                            "  - {x: flow.iterations, y: ref_psnr, lines: [flow.step], only: {backend: [cpu, gl]}}\n"
                            "  - {title: Time, x: flow.iterations, y: ms_median, y_label: t, log: [y]}\n"
                            "published: {file: tab1.csv, on: {place: scene, n: flow.iterations}, column: ms}\n"
                            "variants:\n"
                            "  base: {}\n"
                            "  close: {camera: near, frame: 3, size: 64x49, set: {flow.step: 0.5}}\n"
                            "path: {camera: zoom, views: 30, frames: follow}\n"
                            "leave_out: [true, false]\n"
                            "against: {variant: base, leave_out: true}\n"
                            "added: [ref_psnr, ref_flip]\n"
                            "quick:\n"
                            "  title: Less\n"
                            "  set: {floor.tile: 0.7}\n"
                            "  vary: {flow.iterations: [40]}\n";

static ssfr_result load_text(ssfr_sweep_spec **spec, const char *text, size_t size)
{
    static const char *path;
    if (!path) path = test_path("spec.yaml");
    test_write_file(path, text, size);
    return ssfr_sweep_spec_load(spec, path);
}

static void assert_new_axes(const ssfr_sweep_spec *spec)
{
    assert_string_equal(spec->axes[7].key, "variant");
    assert_string_equal(spec->axes[7].values[1], "close");
    const ssfr_variant *close = ssfr_sweep_spec_variant(spec, "close");
    assert_string_equal(ssfr_variant_own(close, "camera")->value, "near");
    assert_string_equal(ssfr_variant_own(close, "frame")->value, "3");
    assert_null(ssfr_variant_own(close, "scene"));
    assert_string_equal(close->settings.items[0].value, "0.5");
    assert_int_equal(ssfr_sweep_spec_variant(spec, "base")->own.n, 0);
    assert_null(ssfr_sweep_spec_variant(spec, "clos"));
    assert_string_equal(spec->axes[8].key, "camera");
    assert_string_equal(spec->axes[8].values[0], "zoom");
    assert_string_equal(spec->axes[9].key, "view");
    assert_string_equal(spec->axes[9].values[29], "29");
    assert_int_equal(spec->path.views, 30);
    assert_int_equal(spec->path.frames, SSFR_PATH_FOLLOW);
    assert_string_equal(spec->axes[10].values[1], "false");
    assert_int_equal(spec->against.cells.n, 2);
    assert_string_equal(spec->against.cells.items[0].value, "base");
    assert_int_equal(spec->against.n_added, 2);
    assert_string_equal(spec->against.added[1], "ref_flip");
}

static void assert_whole(const ssfr_sweep_spec *spec)
{
    size_t n = 0;
    assert_string_equal(spec->title, "What a step costs");
    assert_int_equal(spec->n_axes, 11);
    assert_string_equal(spec->axes[0].values[1], "bagar2010");
    assert_string_equal(spec->axes[3].key, "flow.iterations");
    assert_string_equal(spec->axes[5].values[1], "B10,B11");
    assert_string_equal(spec->axes[6].values[1], "cpu");
    assert_int_equal(ssfr_sweep_spec_count(spec, &n), SSFR_OK);
    assert_int_equal(n, 2 * 2 * 3 * 2 * 2 * 2 * 2 * 1 * 30 * 2);
    assert_new_axes(spec);
    assert_int_equal(spec->settings.n, 1);
    assert_int_equal(spec->compared_with, SSFR_REFERENCE_FRAME);
    assert_string_equal(spec->reference.items[0].value, "60");
    assert_string_equal(spec->plot.x, "ref_psnr");
    assert_string_equal(spec->plot.title, "Work");
    assert_int_equal(spec->plot.n_lines, 2);
    assert_string_equal(spec->plot.lines[1], "backend");
    assert_int_equal(spec->n_curves, 2);
    assert_string_equal(spec->curves[0].only[0].column, "backend");
    assert_string_equal(spec->curves[0].only[0].cell, "cpu");
    assert_string_equal(spec->curves[0].only[1].column, "backend");
    assert_string_equal(spec->curves[0].only[1].cell, "gl");
    assert_null(spec->curves[0].title);
    assert_string_equal(spec->curves[1].y, "ms_median");
    assert_string_equal(spec->curves[1].y_label, "t");
    assert_null(spec->curves[1].x_label);
    assert_true(!spec->curves[1].log[0] && spec->curves[1].log[1]);
    assert_int_equal(spec->curves[1].n_lines, 0);
    assert_string_equal(spec->published.file, "tab1.csv");
    assert_string_equal(spec->published.column, "ms");
    assert_int_equal(spec->published.n_on, 2);
    assert_string_equal(spec->published.on[1], "n");
    assert_string_equal(spec->published.with[1], "flow.iterations");
    assert_string_equal(spec->quick->title, "Less");
}

static void a_whole_sweep_is_read(void **state)
{
    (void)state;
    ssfr_sweep_spec *spec = NULL;
    assert_int_equal(load_text(&spec, whole, sizeof whole - 1), SSFR_OK);
    assert_whole(spec);
    assert_non_null(strstr(spec->axes[3].where, "spec.yaml:8:3"));
    assert_non_null(strstr(spec->settings.items[0].where, "spec.yaml:6:7"));
    ssfr_sweep_spec_destroy(&spec);
}

static void truth_is_a_word_and_its_parameters_stand_beside_the_others(void **state)
{
    (void)state;
    static const char text[] = "set: {truth.level: 0.4, truth.parts: \"surface,colour\"}\n"
                               "vary:\n  truth.kind: [density, spheres]\n  extinction.radius: 0.5:1.5:0.5\n"
                               "reference: truth\n"
                               "curves: {x: ms_median, y: ref_iou}\n";
    ssfr_sweep_spec *spec = NULL;
    size_t n = 0;
    assert_int_equal(load_text(&spec, text, sizeof text - 1), SSFR_OK);
    assert_int_equal(spec->compared_with, SSFR_REFERENCE_TRUTH);
    assert_int_equal(spec->settings.n, 2);
    assert_string_equal(spec->settings.items[1].value, "surface,colour");
    assert_int_equal(spec->n_curves, 1);
    assert_int_equal(ssfr_sweep_spec_complete(spec), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_count(spec, &n), SSFR_OK);
    assert_int_equal(n, 6);
    ssfr_sweep_spec_destroy(&spec);
}

/* What a size is at quick scale, with the text of the spec before it. */
static void assert_quick_sizes(const char *text, const char *expected)
{
    ssfr_sweep_spec *spec = NULL;
    char joined[200] = "";
    assert_int_equal(ssfr_sweep_spec_parse(&spec, "spec.yaml", text, strlen(text)), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_complete(spec), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_quicken(spec), SSFR_OK);
    const ssfr_axis *axis = ssfr_sweep_spec_axis(spec, "size");
    for (size_t i = 0; i < axis->n; i++) strcat(strcat(joined, i ? " " : ""), axis->values[i]);
    assert_string_equal(joined, expected);
    ssfr_sweep_spec_destroy(&spec);
}

static void quick_scale_halves_sizes_unless_it_says_them(void **state)
{
    (void)state;
    assert_quick_sizes("title: x", "640x360");
    assert_quick_sizes("size: [640x361, 2x1]", "320x180 1x1");
    assert_quick_sizes("size: 64x48x2", "64x48x2"); /* refused later */
    assert_quick_sizes("{size: 640x360, quick: {title: y}}", "320x180");
    assert_quick_sizes("{size: 640x360, quick: {size: [64x48, 32x24]}}", "64x48 32x24");
    ssfr_sweep_spec *spec = NULL;
    assert_int_equal(ssfr_sweep_spec_parse(&spec, "spec.yaml", "size: [3x3, 2x2]", 16), SSFR_OK);
    assert_fails(SSFR_ERR_VALUE, ssfr_sweep_spec_quicken(spec), "spec.yaml:1:1: size: 1x1 stands twice");
    ssfr_sweep_spec_destroy(&spec);
}

static void what_quick_says_replaces_what_is_said_above(void **state)
{
    (void)state;
    ssfr_sweep_spec *spec = NULL;
    size_t n = 0;
    assert_int_equal(load_text(&spec, whole, sizeof whole - 1), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_complete(spec), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_quicken(spec), SSFR_OK);
    assert_string_equal(spec->title, "Less");
    assert_string_equal(spec->axes[3].key, "flow.iterations");
    assert_int_equal(spec->axes[3].n, 1);
    assert_int_equal(ssfr_sweep_spec_count(spec, &n), SSFR_OK);
    assert_int_equal(n, 2 * 2 * 1 * 2 * 2 * 2 * 2 * 1 * 12 * 2);
    assert_int_equal(spec->path.views, 12);
    assert_string_equal(ssfr_variant_own(ssfr_sweep_spec_variant(spec, "close"), "size")->value, "32x24");
    assert_string_equal(spec->settings.items[spec->settings.n - 1].value, "0.7"); /* the last one counts */
    ssfr_sweep_spec_destroy(&spec);
}

static void quick_scale_may_have_variants_and_a_path_of_its_own(void **state)
{
    (void)state;
    static const char text[] = "variants: {a: {size: 64x48}, b: {}}\npath: {views: 40}\n"
                               "quick: {variants: {c: {size: 64x48}}, path: {views: 20}, frame: 3}\n";
    ssfr_sweep_spec *spec = NULL;
    assert_int_equal(ssfr_sweep_spec_parse(&spec, "spec.yaml", text, strlen(text)), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_complete(spec), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_quicken(spec), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_axis(spec, "variant")->n, 1);
    assert_null(ssfr_sweep_spec_variant(spec, "a"));
    assert_string_equal(ssfr_variant_own(ssfr_sweep_spec_variant(spec, "c"), "size")->value, "64x48");
    assert_int_equal(spec->path.views, 20);
    assert_int_equal(ssfr_sweep_spec_axis(spec, "view")->n, 20);
    assert_int_equal(ssfr_sweep_spec_axis(spec, "frame")->n, 1);
    ssfr_sweep_spec_destroy(&spec);
}

static void what_a_variant_has_counts_for_more_than_the_axis(void **state)
{
    (void)state;
    static const char text[] = "scene: block\nframe: [1, 2]\nvariants: {a: {}, b: {scene: sphere, camera: top}}\n";
    ssfr_sweep_spec *spec = NULL;
    size_t index[SSFR_MAX_AXES];
    assert_int_equal(ssfr_sweep_spec_parse(&spec, "spec.yaml", text, strlen(text)), SSFR_OK);
    ssfr_sweep_spec_run(spec, 2, index); /* frame 2, variant a */
    assert_string_equal(ssfr_sweep_spec_value(spec, index, "scene"), "block");
    assert_string_equal(ssfr_sweep_spec_value(spec, index, "frame"), "2");
    assert_null(ssfr_sweep_spec_value(spec, index, "camera"));
    assert_string_equal(ssfr_sweep_spec_variant_of(spec, index)->name, "a");
    ssfr_sweep_spec_run(spec, 3, index);
    assert_string_equal(ssfr_sweep_spec_value(spec, index, "scene"), "sphere");
    assert_string_equal(ssfr_sweep_spec_where(spec, index, "scene"), "spec.yaml:3:23");
    assert_string_equal(ssfr_sweep_spec_value(spec, index, "camera"), "top");
    assert_string_equal(ssfr_sweep_spec_value(spec, index, "variant"), "b");
    ssfr_sweep_spec_destroy(&spec);
}

static void a_part_of_the_axes_has_a_product_of_its_own(void **state)
{
    (void)state;
    static const char *const keys[] = {"variant", "a.c", "scene"};
    ssfr_sweep_spec *spec = new_spec();
    size_t index[SSFR_MAX_AXES] = {0}, n = 1;
    assert_int_equal(ssfr_sweep_spec_vary(spec, "", "scene", "a,b"), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_vary(spec, "", "a.b", "1,2,3"), SSFR_OK);
    assert_int_equal(ssfr_sweep_spec_vary(spec, "", "a.c", "1,2,3"), SSFR_OK);
    for (; ssfr_sweep_spec_next(spec, 3, keys, index); n++) {
        assert_int_equal(index[0], n % 2);
        assert_int_equal(index[1], 0);
        assert_int_equal(index[2], n / 2);
    }
    assert_int_equal(n, 6);
    assert_true(index[0] == 0 && index[2] == 0);
    ssfr_sweep_spec_destroy(&spec);
}

static void a_sweep_is_read_from_standard_input(void **state)
{
    (void)state;
    const char *path = test_path("stdin.yaml");
    ssfr_sweep_spec *spec = NULL;
    test_write_file(path, whole, sizeof whole - 1);
    const int kept = dup(STDIN_FILENO);
    assert_non_null(freopen(path, "r", stdin));
    assert_int_equal(ssfr_sweep_spec_load(&spec, "-"), SSFR_OK);
    dup2(kept, STDIN_FILENO);
    close(kept);
    assert_whole(spec);
    ssfr_sweep_spec_destroy(&spec);
}

static void malformed_sweeps_are_refused_with_their_place(void **state)
{
    (void)state;
    static const struct {
        ssfr_result code;
        const char *text, *message;
    } cases[] = {
        {SSFR_ERR_FORMAT, "", "spec.yaml:1:1: an empty file"},
        {SSFR_ERR_FORMAT, "# nothing\n", "spec.yaml:1:1: an empty file"},
        {SSFR_ERR_FORMAT, "- a\n", "spec.yaml:1:1: the sweep: expected a map"},
        {SSFR_ERR_FORMAT, "just words\n", "spec.yaml:1:1: the sweep: expected a map"},
        {SSFR_ERR_FORMAT, "title: x\nscenes: y\n",
         "spec.yaml:2:1: no key scenes: a sweep has title, pipeline, variants, scene"},
        {SSFR_ERR_FORMAT, "title: x\ntitle: y\n", "spec.yaml:2:1: title stands twice"},
        {SSFR_ERR_FORMAT, "title: [x]\n", "spec.yaml:1:8: title: expected one value"},
        {SSFR_ERR_FORMAT, "pipeline: {a: b}\n", "spec.yaml:1:11: pipeline: expected one value"},
        {SSFR_ERR_FORMAT, "variants: a\n", "spec.yaml:1:11: variants: expected a map"},
        {SSFR_ERR_FORMAT, "variants: {}\n", "spec.yaml:1:11: variants: expected 1 to 64 variants"},
        {SSFR_ERR_FORMAT, "variants: {a: b}\n", "spec.yaml:1:15: a: expected a map"},
        {SSFR_ERR_FORMAT, "variants: {a: {backend: gl}}\n",
         "spec.yaml:1:16: a: no key backend: it has pipeline, scene, camera, frame, size, set"},
        {SSFR_ERR_FORMAT, "variants: {a: {scene: [b]}}\n", "spec.yaml:1:23: scene: expected one value"},
        {SSFR_ERR_FORMAT, "variants: {a: {set: b}}\n", "spec.yaml:1:21: set: expected a map"},
        {SSFR_ERR_VALUE, "variants: {\"\": {}}\n", "variant: value 1 is empty"},
        {SSFR_ERR_FORMAT, "path: zoom\n", "spec.yaml:1:7: path: expected a map"},
        {SSFR_ERR_FORMAT, "path: {camera: zoom}\n", "spec.yaml:1:1: path: views must be given"},
        {SSFR_ERR_VALUE, "path: {views: 0}\n", "spec.yaml:1:15: views: 0 is out of range [1, 10000]"},
        {SSFR_ERR_VALUE, "path: {views: 1.5}\n", "spec.yaml:1:15: views: 1.5 is not a whole number"},
        {SSFR_ERR_VALUE, "path: {views: 2, frames: run}\n", "spec.yaml:1:26: frames: \"run\" is none of stand, follow"},
        {SSFR_ERR_FORMAT, "camera: a\npath: {camera: b, views: 2}\n", "spec.yaml:2:8: camera is varied twice"},
        {SSFR_ERR_FORMAT, "against: base\n", "spec.yaml:1:10: against: expected a map"},
        {SSFR_ERR_FORMAT, "against: {}\n", "spec.yaml:1:10: against: expected a map of axes to cells"},
        {SSFR_ERR_FORMAT, "against: {a: [b]}\n", "spec.yaml:1:14: a: expected one value"},
        {SSFR_ERR_FORMAT, "added: ref_flip\n", "spec.yaml:1:8: added: expected a list"},
        {SSFR_ERR_FORMAT, "added: [a, [b]]\n", "spec.yaml:1:12: added: expected one value"},
        {SSFR_ERR_FORMAT, "added: [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q]\n",
         "spec.yaml:1:57: added: more than 16 columns"},
        {SSFR_ERR_FORMAT, "scene: {a: b}\n", "spec.yaml:1:8: scene: expected one value"},
        {SSFR_ERR_FORMAT, "scene: []\n", "spec.yaml:1:8: scene: an empty list"},
        {SSFR_ERR_FORMAT, "scene: [[a]]\n", "spec.yaml:1:9: scene: expected one value"},
        {SSFR_ERR_VALUE, "scene: [a, a]\n", "spec.yaml:1:1: scene: a stands twice"},
        {SSFR_ERR_VALUE, "scene:\n", "spec.yaml:1:1: scene: value 1 is empty"},
        {SSFR_ERR_FORMAT, "vary: 3\n", "spec.yaml:1:7: vary: expected a map"},
        {SSFR_ERR_FORMAT, "vary:\n  [a]: 1\n", "spec.yaml:2:3: vary: expected one value"},
        {SSFR_ERR_UNKNOWN, "vary:\n  speed: 1\n", "spec.yaml:2:3: no axis speed"},
        {SSFR_ERR_UNKNOWN, "vary:\n  speed: [1]\n", "spec.yaml:2:3: no axis speed"},
        {SSFR_ERR_VALUE, "vary:\n  a.b: 0:80\n", "spec.yaml:2:3: a.b=0:80: expected lo:hi:step"},
        {SSFR_ERR_FORMAT, "scene: a\nvary:\n  scene: b\n", "spec.yaml:3:3: scene is varied twice"},
        {SSFR_ERR_FORMAT, "set: [a]\n", "spec.yaml:1:6: set: expected a map"},
        {SSFR_ERR_FORMAT, "set:\n  a.b: [1]\n", "spec.yaml:2:8: a.b: expected one value"},
        {SSFR_ERR_FORMAT, "reference: 1\n", "spec.yaml:1:12: reference: expected truth, or a map"},
        {SSFR_ERR_FORMAT, "reference: Truth\n", "spec.yaml:1:12: reference: expected truth, or a map"},
        {SSFR_ERR_FORMAT, "reference: [truth]\n", "spec.yaml:1:12: reference: expected truth, or a map"},
        {SSFR_ERR_FORMAT, "reference:\n  a.b: [1]\n", "spec.yaml:2:8: a.b: expected one value"},
        {SSFR_ERR_FORMAT, "plot: {x: a}\n", "spec.yaml:1:1: plot: x and y must be given"},
        {SSFR_ERR_FORMAT, "plot: {x: a, y: b, z: c}\n", "spec.yaml:1:20: plot: no key z"},
        {SSFR_ERR_FORMAT, "plot: {x: a, y: b, lines: c}\n", "spec.yaml:1:27: lines: expected a list of columns"},
        {SSFR_ERR_FORMAT, "plot: {x: a, y: b, lines: [a, b, c, d, e]}\n", "spec.yaml:1:40: lines: more than 4 columns"},
        {SSFR_ERR_FORMAT, "plot: {x: a, y: b, log: [x]}\n", "spec.yaml:1:20: log: is of curves"},
        {SSFR_ERR_FORMAT, "curves: {x: a, y: b, log: x}\n", "spec.yaml:1:27: log: expected a list"},
        {SSFR_ERR_VALUE, "curves: {x: a, y: b, log: [x, z]}\n", "spec.yaml:1:31: log: z: expected x or y"},
        {SSFR_ERR_FORMAT, "plot: {x: a, y: b, only: c}\n", "spec.yaml:1:26: only: expected a map"},
        {SSFR_ERR_FORMAT, "plot: {x: a, y: b, only: {c: {d: e}}}\n", "spec.yaml:1:30: c: expected one value"},
        {SSFR_ERR_FORMAT, "plot: {x: a, y: b, only: {c: [d, [e]]}}\n", "spec.yaml:1:34: c: expected one value"},
        {SSFR_ERR_FORMAT, "plot: {x: a, y: b, only: {a: a, b: [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11], c: c}}\n",
         "spec.yaml:1:76: only: more than 12 cells"},
        {SSFR_ERR_FORMAT, "curves: a\n", "spec.yaml:1:9: curves: expected a map"},
        {SSFR_ERR_FORMAT, "curves: [{x: a, y: b}, {x: a}]\n", "spec.yaml:1:24: curves: x and y must be given"},
        {SSFR_ERR_FORMAT, "curves: [{x: a, y: b, z: c}]\n", "spec.yaml:1:23: curves: no key z"},
        {SSFR_ERR_FORMAT,
         "curves:\n - &p {x: a, y: b}\n - *p\n - *p\n - *p\n - *p\n - *p\n - *p\n - *p\n - *p\n",
         "curves: more than 8 panels"},
        {SSFR_ERR_FORMAT, "published: tab1.csv\n", "spec.yaml:1:12: published: expected a map"},
        {SSFR_ERR_FORMAT, "published: {file: a, on: [b]}\n", "spec.yaml:1:1: published: column must be given"},
        {SSFR_ERR_FORMAT, "published: {file: a, on: b, column: c}\n", "spec.yaml:1:26: on: expected a list of columns"},
        {SSFR_ERR_FORMAT, "published: {on: []}\n", "spec.yaml:1:17: on: expected a list of columns"},
        {SSFR_ERR_FORMAT, "published: {on: [a, [b]]}\n", "spec.yaml:1:21: on: expected one value"},
        {SSFR_ERR_FORMAT, "published: {on: {a: [b]}}\n", "spec.yaml:1:21: a: expected one value"},
        {SSFR_ERR_FORMAT, "published: {on: [a, b, c, d, e]}\n", "spec.yaml:1:30: on: more than 4 columns"},
        {SSFR_ERR_FORMAT, "quick: less\n", "spec.yaml:1:8: quick: expected a map"},
        {SSFR_ERR_FORMAT, "quick: {backend: gl}\n",
         "spec.yaml:1:9: quick: no key backend: it has title, variants, scene"},
        {SSFR_ERR_FORMAT, "quick: {size: []}\n", "spec.yaml:1:15: size: an empty list"},
        {SSFR_ERR_FORMAT, "title: \"a\\0b\"\n", "spec.yaml:1:8: title: a zero byte in the value"},
        {SSFR_ERR_FORMAT, "title: [x\n", "spec.yaml:2:1: did not find expected ',' or ']'"},
        {SSFR_ERR_FORMAT, "title: x\n\tscene: y\n", "spec.yaml:2:1: found"},
        {SSFR_ERR_FORMAT, "title: *x\n", "spec.yaml:1:8: found undefined alias"},
        {SSFR_ERR_FORMAT, "title: \xff\n", "byte 7: invalid leading UTF-8 octet"},
        {SSFR_ERR_FORMAT, "title: x\n---\ntitle: y\n", "spec.yaml:3:1: a second document"},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_sweep_spec *spec = NULL;
        assert_fails(cases[i].code, load_text(&spec, cases[i].text, strlen(cases[i].text)), cases[i].message);
        assert_null(spec);
    }
    ssfr_sweep_spec *spec = NULL;
    assert_fails(SSFR_ERR_IO, ssfr_sweep_spec_load(&spec, test_path("absent.yaml")), "absent.yaml");
}

static void a_sweep_cut_at_any_byte_gives_a_sweep_or_an_error(void **state)
{
    (void)state;
    int n_loaded = 0;
    for (size_t n = 0; n < sizeof whole; n++) {
        ssfr_sweep_spec *spec = NULL;
        test_clear_log();
        const ssfr_result result = load_text(&spec, whole, n);
        assert_int_equal(result == SSFR_OK, spec != NULL);
        assert_int_equal(test_n_errors(), result == SSFR_OK ? 0 : 1);
        n_loaded += spec != NULL;
        ssfr_sweep_spec_destroy(&spec);
    }
    assert_true(n_loaded > 10);
}

static void an_alias_that_holds_itself_is_refused(void **state)
{
    (void)state;
    ssfr_sweep_spec *spec = NULL;
    static const char text[] = "vary: &a\n  flow.step: [*a]\n";
    assert_fails(SSFR_ERR_FORMAT, load_text(&spec, text, sizeof text - 1), "expected one value");
    assert_null(spec);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_list_keeps_its_values_to_the_letter),
        cmocka_unit_test(a_range_includes_its_end_when_it_is_hit),
        cmocka_unit_test(a_logarithmic_range_has_equal_ratios),
        cmocka_unit_test(malformed_axes_are_refused),
        cmocka_unit_test(an_axis_of_too_many_values_or_too_many_axes_are_refused),
        cmocka_unit_test(an_axis_given_again_is_replaced_in_its_place),
        cmocka_unit_test(the_product_runs_with_the_last_axis_fastest),
        cmocka_unit_test(a_product_without_end_is_refused),
        cmocka_unit_test(settings_are_split_at_the_first_equals_sign),
        cmocka_unit_test(a_sweep_is_completed_by_what_it_lacks),
        cmocka_unit_test(a_reference_is_there_once_it_has_a_setting),
        cmocka_unit_test(the_reference_is_the_truth_or_a_frame),
        cmocka_unit_test(a_frame_of_the_file_yields_to_the_truth_of_the_command_line),
        cmocka_unit_test(every_table_names_its_truth),
        cmocka_unit_test(truth_is_a_word_and_its_parameters_stand_beside_the_others),
        cmocka_unit_test(a_whole_sweep_is_read),
        cmocka_unit_test(quick_scale_halves_sizes_unless_it_says_them),
        cmocka_unit_test(what_quick_says_replaces_what_is_said_above),
        cmocka_unit_test(quick_scale_may_have_variants_and_a_path_of_its_own),
        cmocka_unit_test(what_a_variant_has_counts_for_more_than_the_axis),
        cmocka_unit_test(a_part_of_the_axes_has_a_product_of_its_own),
        cmocka_unit_test(a_sweep_is_read_from_standard_input),
        cmocka_unit_test(malformed_sweeps_are_refused_with_their_place),
        cmocka_unit_test(a_sweep_cut_at_any_byte_gives_a_sweep_or_an_error),
        cmocka_unit_test(an_alias_that_holds_itself_is_refused),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}
