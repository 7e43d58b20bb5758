/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_gl.c: a context of ssfr's own: images, programs, targets, buffers, timers, and every way they fail. */
#include "gl/internal.h"
#include "tests/gl_host.h"

#include <dirent.h>

static ssfr_gl *gl;

/* A test that draws starts with this and has `end` for its teardown. */
static void begin(void)
{
    gl = test_gl_or_skip();
    assert_int_equal(ssfr_gl_begin(gl), SSFR_OK);
}

static int end(void **state)
{
    (void)state;
    unsetenv("SSFR_SHADER_DIR");
    if (!gl) return 0;
    assert_int_equal(ssfr_gl_end(gl, SSFR_OK), SSFR_OK);
    ssfr_gl_destroy(&gl);
    return 0;
}

static unsigned program(const char *vert, const char *frag, const char *defines)
{
    unsigned name;
    assert_int_equal(ssfr_program_get(gl, &name, vert, frag, defines), SSFR_OK);
    assert_int_not_equal(name, 0);
    return name;
}

static ssfr_texture texture(int w, int h, int c)
{
    ssfr_texture made;
    assert_int_equal(ssfr_texture_create(gl, &made, w, h, c, SSFR_STORE_FLOAT), SSFR_OK);
    assert_int_equal(made.w, w);
    assert_int_equal(made.h, h);
    assert_int_equal(made.c, c);
    return made;
}

static ssfr_field *field(int w, int h, int c)
{
    ssfr_field *made;
    assert_int_equal(ssfr_field_create(&made, w, h, c), SSFR_OK);
    return made;
}

static ssfr_field *read_back(const ssfr_texture *from)
{
    ssfr_field *made;
    assert_int_equal(ssfr_texture_read(from, &made), SSFR_OK);
    assert_int_equal(made->w, from->w);
    assert_int_equal(made->h, from->h);
    assert_int_equal(made->c, from->c);
    return made;
}

static void draw(unsigned name, const ssfr_texture *target)
{
    const ssfr_texture *const targets[] = {target};
    assert_int_equal(ssfr_gl_target(gl, 1, targets), SSFR_OK);
    glUseProgram(name);
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

static void fill(const ssfr_texture *target, float r, float g, float b, float a)
{
    const unsigned name = program("fill.vert", "fill.frag", NULL);
    glProgramUniform4f(name, glGetUniformLocation(name, "u_colour"), r, g, b, a);
    draw(name, target);
}

/* Puts a shader into a folder of the test's own, which SSFR_SHADER_DIR names from then on. */
static void put_shader(const char *name, const char *text)
{
    const char *path = test_path(name);
    char folder[256];
    test_write_file(path, text, strlen(text));
    snprintf(folder, sizeof folder, "%.*s", (int)(strrchr(path, '/') - path), path);
    assert_int_equal(setenv("SSFR_SHADER_DIR", folder, 1), 0);
}

/* ---- the context ------------------------------------------------------------------------------------------------- */

static void own_context_tells_what_it_is(void **state)
{
    (void)state;
    begin();
    const char *renderer = ssfr_gl_renderer(gl);
    assert_true(strlen(renderer) > 0);
    assert_true(strlen(ssfr_gl_vendor(gl)) > 0);
    assert_true(strlen(ssfr_gl_version(gl)) > 0);
    assert_int_equal(ssfr_gl_is_software(gl),
                     strstr(renderer, "llvmpipe") || strstr(renderer, "softpipe") || strstr(renderer, "swrast"));
    assert_true(ssfr_gl_get_limits(gl)->texture_px >= 8192);
    assert_true(ssfr_gl_get_limits(gl)->point_px >= 1);
    assert_true(epoxy_is_desktop_gl() && epoxy_gl_version() >= 45);
}

static int n_open_files(void)
{
    int n = 0;
    DIR *dir = opendir("/proc/self/fd");
    for (struct dirent *entry = dir ? readdir(dir) : NULL; entry; entry = readdir(dir)) n++;
    if (dir) closedir(dir);
    return n;
}

/* Memory is watched by the leak checker. */
static void own_context_comes_and_goes_twenty_times(void **state)
{
    (void)state;
    int n_files = 0;
    for (int i = 0; i < 20; i++) {
        ssfr_gl *one = test_gl_or_skip();
        assert_int_equal(ssfr_gl_begin(one), SSFR_OK);
        assert_int_equal(ssfr_gl_end(one, SSFR_OK), SSFR_OK);
        ssfr_gl_destroy(&one);
        assert_null(one);
        assert_ptr_equal(eglGetCurrentContext(), EGL_NO_CONTEXT);
        if (i == 1) n_files = n_open_files();
    }
    assert_int_equal(n_open_files(), n_files);
    ssfr_gl *none = NULL;
    ssfr_gl_destroy(&none);
    assert_null(none);
}

static void two_own_contexts_give_way_to_each_other(void **state)
{
    (void)state;
    begin();
    ssfr_gl *other = NULL;
    const EGLContext first = eglGetCurrentContext();
    assert_int_equal(ssfr_gl_create(&other, SSFR_GL_OWN), SSFR_OK);
    assert_ptr_equal(eglGetCurrentContext(), first);
    assert_int_equal(ssfr_gl_begin(other), SSFR_OK);
    assert_ptr_not_equal(eglGetCurrentContext(), first);
    assert_int_equal(ssfr_gl_end(other, SSFR_OK), SSFR_OK);
    assert_ptr_equal(eglGetCurrentContext(), first);
    ssfr_gl_destroy(&other);
    assert_ptr_equal(eglGetCurrentContext(), first);
}

/* Creates a context with SSFR_GL set to value, and puts the variable back. */
static ssfr_result create_forced(ssfr_gl **out, const char *value)
{
    const char *before = getenv("SSFR_GL");
    char kept[64] = "";
    snprintf(kept, sizeof kept, "%s", before ? before : "");
    setenv("SSFR_GL", value, 1);
    const ssfr_result result = ssfr_gl_create(out, SSFR_GL_OWN);
    setenv("SSFR_GL", kept, 1);
    return result;
}

static void environment_forces_software_or_device(void **state)
{
    (void)state;
    begin();
    ssfr_gl *forced = NULL;
    assert_fails(SSFR_ERR_VALUE, create_forced(&forced, "llvmpipe"), "SSFR_GL=llvmpipe: expected software or device");
    assert_null(forced);
    test_clear_log();
    if (create_forced(&forced, "software") == SSFR_OK) {
        assert_true(ssfr_gl_is_software(forced));
        ssfr_gl_destroy(&forced);
    } else {
        test_assert_logged("SSFR_GL=software", __FILE__, __LINE__);
    }
    test_clear_log();
    if (create_forced(&forced, "device") == SSFR_OK) {
        assert_false(ssfr_gl_is_software(forced));
        ssfr_gl_destroy(&forced);
    } else {
        test_assert_logged("SSFR_GL=device", __FILE__, __LINE__);
    }
}

static void errors_of_gl_become_the_result_of_end(void **state)
{
    (void)state;
    begin();
    glEnable(GL_TEXTURE_BUFFER);
    assert_fails(SSFR_ERR_GL, ssfr_gl_end(gl, SSFR_OK), "GL_INVALID_ENUM");
    assert_int_equal(ssfr_gl_begin(gl), SSFR_OK);
    ssfr_gl_push(gl, "bilateral");
    ssfr_gl_push(gl, "rows");
    glUseProgram(4711);
    glEnable(GL_TEXTURE_BUFFER);
    ssfr_gl_pop(gl);
    ssfr_gl_pop(gl);
    assert_fails(SSFR_ERR_GL, ssfr_gl_end(gl, SSFR_ERR_VALUE), "rows: GL_INVALID_VALUE");
    assert_int_equal(ssfr_gl_begin(gl), SSFR_OK);
    assert_int_equal(ssfr_gl_end(gl, SSFR_ERR_VALUE), SSFR_ERR_VALUE);
    assert_int_equal(ssfr_gl_end(gl, SSFR_OK), SSFR_OK); /* nothing is begun: nothing to end */
    assert_int_equal(ssfr_gl_begin(gl), SSFR_OK);
}

/* ---- images ------------------------------------------------------------------------------------------------------ */

/* NaN equals NaN here, whatever it carries. */
static void assert_same_field(const ssfr_field *a, const ssfr_field *b)
{
    const size_t n = (size_t)a->w * (size_t)a->h * (size_t)a->c;
    size_t n_differ = 0;
    assert_true(a->w == b->w && a->h == b->h && a->c == b->c);
    for (size_t i = 0; i < n; i++)
        n_differ += a->data[i] != b->data[i] && !(isnan(a->data[i]) && isnan(b->data[i]));
    assert_int_equal(n_differ, 0);
}

static void check_round_trip(int w, int h, int c)
{
    static const double special[] = {-SSFR_EMPTY, SSFR_EMPTY, INFINITY, -INFINITY, NAN, 1e-40, -0.0, 3.4e38};
    uint64_t seed = 2385;
    ssfr_texture image = texture(w, h, c);
    ssfr_field *written = field(w, h, c);
    for (int i = 0; i < w * h * c; i++)
        written->data[i] = i % 7 == 3 ? (double)(float)special[i / 7 % 8] : (double)(float)test_random(&seed, -9, 9);
    assert_int_equal(ssfr_texture_write(&image, written), SSFR_OK);
    ssfr_field *got = read_back(&image);
    assert_same_field(written, got);
    ssfr_texture_finish(&image);
    assert_int_equal(image.name, 0);
    ssfr_field_destroy(&written);
    ssfr_field_destroy(&got);
}

static void images_come_back_as_written(void **state)
{
    (void)state;
    begin();
    static const int sizes[][2] = {{1, 1}, {4097, 3}, {3, 4097}, {37, 41}, {1031, 517}};
    for (size_t i = 0; i < SSFR_COUNT(sizes); i++)
        for (int c = 1; c <= 4; c++) check_round_trip(sizes[i][0], sizes[i][1], c);
}

static void images_round_doubles_to_float(void **state)
{
    (void)state;
    begin();
    ssfr_texture image = texture(2, 1, 1);
    ssfr_field *written = field(2, 1, 1);
    written->data[0] = 0.1;
    written->data[1] = -2.385;
    assert_int_equal(ssfr_texture_write(&image, written), SSFR_OK);
    ssfr_field *got = read_back(&image);
    assert_true(got->data[0] == (double)0.1f && got->data[1] == (double)-2.385f);
    ssfr_texture_finish(&image);
    ssfr_field_destroy(&written);
    ssfr_field_destroy(&got);
}

/* Drivers may round what is written as they like; halves they keep. */
static void images_of_halves_hold_halves(void **state)
{
    (void)state;
    begin();
    static const double special[] = {INFINITY, -INFINITY, NAN, 65504, 0x1p-24, -0.0};
    for (int c = 1; c <= 4; c++) {
        ssfr_texture image;
        ssfr_field *written = field(37, 41, c);
        uint64_t seed = 2385;
        for (int i = 0; i < 37 * 41 * c; i++)
            written->data[i] = i % 7 == 3 ? special[i / 7 % 6] : ssfr_half_round(test_random(&seed, -9, 9));
        assert_int_equal(ssfr_texture_create(gl, &image, 37, 41, c, SSFR_STORE_HALF), SSFR_OK);
        assert_int_equal(ssfr_texture_write(&image, written), SSFR_OK);
        ssfr_field *got = read_back(&image);
        assert_same_field(written, got);
        ssfr_field_destroy(&got);
        ssfr_field_fill(written, 0.1);
        assert_int_equal(ssfr_texture_write(&image, written), SSFR_OK);
        got = read_back(&image);
        for (int i = 0; i < 37 * 41 * c; i++) {
            assert_close(got->data[i], 0.1, 0, 0x1p-10);
            assert_true(got->data[i] == ssfr_half_round(got->data[i]));
        }
        ssfr_field_destroy(&got);
        ssfr_field_destroy(&written);
        ssfr_texture_finish(&image);
    }
}

static void images_of_wrong_size_are_refused(void **state)
{
    (void)state;
    begin();
    const int most = ssfr_min_int(ssfr_gl_get_limits(gl)->texture_px, SSFR_MAX_SIZE);
    const int wrong[][3] = {{0, 5, 1}, {5, 0, 1}, {-1, 5, 1}, {most + 1, 5, 1}, {5, most + 1, 1}, {5, 5, 0}, {5, 5, 5}};
    ssfr_texture image;
    for (size_t i = 0; i < SSFR_COUNT(wrong); i++) {
        const int w = wrong[i][0], h = wrong[i][1], c = wrong[i][2];
        char text[64];
        snprintf(text, sizeof text, "GPU image of %d x %d pixels and %d channels", w, h, c);
        assert_fails(SSFR_ERR_VALUE, ssfr_texture_create(gl, &image, w, h, c, SSFR_STORE_FLOAT), text);
        assert_int_equal(image.name, 0);
    }
}

static void fields_of_another_size_are_not_written(void **state)
{
    (void)state;
    begin();
    static const int wrong[][3] = {{12, 7, 2}, {13, 8, 2}, {13, 7, 3}, {7, 13, 2}};
    ssfr_texture image = texture(13, 7, 2);
    for (size_t i = 0; i < SSFR_COUNT(wrong); i++) {
        ssfr_field *other = field(wrong[i][0], wrong[i][1], wrong[i][2]);
        assert_fails(SSFR_ERR_VALUE, ssfr_texture_write(&image, other), "does not fit a GPU image of 13 x 7 x 2");
        ssfr_field_destroy(&other);
    }
    ssfr_texture_finish(&image);
}

/* 4 GiB: more than the software rasteriser gives, and no trouble for a large GPU. */
static void running_out_of_memory_is_one_error_and_no_harm(void **state)
{
    (void)state;
    begin();
    ssfr_texture image;
    test_clear_log();
    if (ssfr_gl_get_limits(gl)->texture_px < 16384) skip();
    const ssfr_result result = ssfr_texture_create(gl, &image, 16384, 16384, 4, SSFR_STORE_FLOAT);
    if (result != SSFR_OK) {
        assert_int_equal(result, SSFR_ERR_MEMORY);
        test_assert_logged("16384 x 16384 pixels and 4 channels: GL_OUT_OF_MEMORY", __FILE__, __LINE__);
        assert_int_equal(image.name, 0);
    }
    ssfr_texture_finish(&image);
    assert_int_equal(ssfr_gl_end(gl, SSFR_OK), SSFR_OK);
    assert_int_equal(ssfr_gl_begin(gl), SSFR_OK);
}

static void clearing_sets_every_pixel(void **state)
{
    (void)state;
    begin();
    static const float value[4] = {-1e30f, 2.385f, 0.1f, -7.25f};
    for (int c = 1; c <= 4; c++) {
        ssfr_texture image = texture(67, 31, c);
        ssfr_texture_clear(&image, value);
        ssfr_field *got = read_back(&image);
        for (int i = 0; i < 67 * 31 * c; i++) assert_true(got->data[i] == (double)value[i % c]);
        ssfr_field_destroy(&got);
        ssfr_texture_finish(&image);
    }
}

static void borrowed_images_are_not_deleted(void **state)
{
    (void)state;
    begin();
    ssfr_texture image = texture(5, 4, 1), borrowed = image;
    const unsigned name = image.name;
    borrowed.borrowed = true;
    ssfr_texture_finish(&borrowed);
    assert_int_equal(borrowed.name, 0);
    assert_true(glIsTexture(name));
    ssfr_texture_finish(&image);
    assert_false(glIsTexture(name));
}

/* ---- drawing ----------------------------------------------------------------------------------------------------- */

static void filling_writes_every_pixel_exactly(void **state)
{
    (void)state;
    begin();
    ssfr_texture image = texture(1031, 257, 4);
    fill(&image, 2.385f, -1e30f, 0.1f, 4.5f);
    ssfr_field *got = read_back(&image);
    const double expected[4] = {(double)2.385f, (double)-1e30f, (double)0.1f, 4.5};
    for (int i = 0; i < 1031 * 257 * 4; i++) assert_true(got->data[i] == expected[i % 4]);
    ssfr_field_destroy(&got);
    ssfr_texture_finish(&image);
}

static void row_0_is_the_top_row(void **state)
{
    (void)state;
    begin();
    put_shader("place.frag", "#version 450 core\nlayout(location = 0) out vec2 o;\n"
                             "void main() { o = gl_FragCoord.xy; }\n");
    put_shader("upper.vert", "#version 450 core\nvoid main() { /* clip y from 0.5 upwards */\n"
                             "float x = gl_VertexID == 1 ? 9.0 : -9.0;\n"
                             "gl_Position = vec4(x, gl_VertexID == 2 ? 9.0 : 0.5, 0, 1); }\n");
    ssfr_texture image = texture(16, 8, 2);
    ssfr_texture_clear(&image, (const float[4]){-1, -1, -1, -1});
    draw(program("upper.vert", "place.frag", NULL), &image);
    ssfr_field *got = read_back(&image);
    for (int y = 0; y < 8; y++) {
        const bool drawn = y < 2; /* the top quarter of the image */
        assert_true(ssfr_field_at(got, 0, y)[0] == (drawn ? 0.5 : -1));
        assert_true(ssfr_field_at(got, 0, y)[1] == (drawn ? y + 0.5 : -1));
    }
    ssfr_field_destroy(&got);
    ssfr_texture_finish(&image);
}

/* A point at clip (0, 0.5) of 5 px: around row 4 of 16. */
static void points_are_squares_whose_coordinates_grow_rightwards_and_upwards(void **state)
{
    (void)state;
    begin();
    put_shader("point.vert", "#version 450 core\nvoid main() { gl_Position = vec4(0.0625, 0.4375, 0, 1);\n"
                             "gl_PointSize = 5; }\n");
    put_shader("coord.frag", "#version 450 core\nlayout(location = 0) out vec4 o;\n"
                             "void main() { o = vec4(gl_PointCoord, 1, 1); }\n");
    const unsigned name = program("point.vert", "coord.frag", NULL);
    ssfr_texture image = texture(16, 16, 4);
    const ssfr_texture *const targets[] = {&image};
    ssfr_texture_clear(&image, (const float[4]){0, 0, 0, 0});
    assert_int_equal(ssfr_gl_target(gl, 1, targets), SSFR_OK);
    glUseProgram(name);
    glDrawArrays(GL_POINTS, 0, 1);
    ssfr_field *got = read_back(&image);
    for (int y = 0; y < 16; y++)
        for (int x = 0; x < 16; x++) {
            const bool inside = x >= 6 && x < 11 && y >= 2 && y < 7; /* the centre is that of pixel (8, 4) */
            const double *v = ssfr_field_at(got, x, y);
            assert_true(v[2] == (inside ? 1 : 0));
            if (inside) assert_close(v[0], (x - 6 + 0.5) / 5, 1e-6, 0);
            if (inside) assert_close(v[1], (7 - y - 0.5) / 5, 1e-6, 0);
        }
    ssfr_field_destroy(&got);
    ssfr_texture_finish(&image);
}

static void several_targets_are_drawn_at_once(void **state)
{
    (void)state;
    begin();
    put_shader("many.frag", "#version 450 core\nlayout(location = 0) out float o_a;\n"
                            "layout(location = 1) out vec2 o_b;\nlayout(location = 2) out vec4 o_c;\n"
                            "layout(location = 3) out vec4 o_d;\n"
                            "void main() { o_a = 1.5; o_b = vec2(2.5); o_c = vec4(3.5); o_d = vec4(4.5); }\n");
    const unsigned name = program("fill.vert", "many.frag", NULL);
    ssfr_texture images[4];
    const ssfr_texture *targets[4];
    for (int i = 0; i < 4; i++) {
        images[i] = texture(19, 11, i + 1);
        targets[i] = &images[i];
    }
    for (int n = 4; n >= 1; n--) { /* fewer targets leave the rest alone */
        for (int i = 0; i < 4; i++) ssfr_texture_clear(&images[i], (const float[4]){9, 9, 9, 9});
        assert_int_equal(ssfr_gl_target(gl, n, targets), SSFR_OK);
        glUseProgram(name);
        glDrawArrays(GL_TRIANGLES, 0, 3);
        for (int i = 0; i < 4; i++) {
            ssfr_field *got = read_back(&images[i]);
            for (int k = 0; k < 19 * 11 * (i + 1); k++) assert_true(got->data[k] == (i < n ? i + 1.5 : 9));
            ssfr_field_destroy(&got);
        }
    }
    for (int i = 0; i < 4; i++) ssfr_texture_finish(&images[i]);
}

static void targets_that_do_not_fit_are_refused(void **state)
{
    (void)state;
    begin();
    ssfr_texture image = texture(8, 6, 1), other = texture(8, 7, 1);
    const ssfr_texture *const targets[] = {&image, &other, &image, &image, &image};
    assert_fails(SSFR_ERR_VALUE, ssfr_gl_target(gl, 0, targets), "0 images to draw into");
    assert_fails(SSFR_ERR_VALUE, ssfr_gl_target(gl, 5, targets), "5 images to draw into");
    assert_fails(SSFR_ERR_VALUE, ssfr_gl_target(gl, 2, targets), "image 1 to draw into has 8 x 7 pixels");
    ssfr_texture shared = {.w = 8, .h = 6, .c = 3, .borrowed = true};
    const ssfr_texture *const borrowed[] = {&shared};
    glCreateTextures(GL_TEXTURE_2D, 1, &shared.name);
    glTextureStorage2D(shared.name, 1, GL_RGB9_E5, 8, 6); /* a format that nobody draws into */
    assert_fails(SSFR_ERR_GL, ssfr_gl_target(gl, 1, borrowed), "cannot draw into 1 images of 8 x 6 pixels");
    glDeleteTextures(1, &shared.name);
    ssfr_texture_finish(&image);
    ssfr_texture_finish(&other);
}

static void no_pass_leaks_state_into_the_next(void **state)
{
    (void)state;
    begin();
    ssfr_texture image = texture(23, 17, 4);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    glBlendEquation(GL_FUNC_REVERSE_SUBTRACT);
    glColorMask(GL_TRUE, GL_FALSE, GL_TRUE, GL_FALSE);
    glEnable(GL_SCISSOR_TEST);
    glScissor(3, 3, 2, 2);
    glEnable(GL_CULL_FACE);
    glCullFace(GL_FRONT_AND_BACK);
    glEnable(GL_RASTERIZER_DISCARD);
    glPolygonMode(GL_FRONT_AND_BACK, GL_POINT);
    glPixelStorei(GL_PACK_ROW_LENGTH, 5);
    glPixelStorei(GL_UNPACK_SKIP_PIXELS, 5);
    glBindVertexArray(0);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    ssfr_gl_baseline(gl);
    fill(&image, 2.385f, 1, 2, 3);
    ssfr_field *got = read_back(&image);
    const double expected[4] = {(double)2.385f, 1, 2, 3};
    for (int i = 0; i < 23 * 17 * 4; i++) assert_true(got->data[i] == expected[i % 4]);
    ssfr_field_destroy(&got);
    ssfr_texture_finish(&image);
}

/* ---- programs ---------------------------------------------------------------------------------------------------- */

#define HEAD "/* a comment */\n#version 450 core\nlayout(location = 0) out vec4 o;\n"

static void program_fails(ssfr_result code, const char *frag, const char *defines, const char *text)
{
    unsigned name = 1;
    const long before = ssfr_gl_allocations(gl);
    assert_fails(code, ssfr_program_get(gl, &name, "fill.vert", frag, defines), text);
    assert_int_equal(name, 0);
    assert_int_equal(ssfr_gl_allocations(gl), before);
    assert_int_equal(glGetError(), GL_NO_ERROR);
}

static void programs_are_made_once(void **state)
{
    (void)state;
    begin();
    const long before = ssfr_gl_allocations(gl);
    const unsigned plain = program("fill.vert", "fill.frag", NULL);
    assert_int_equal(ssfr_gl_allocations(gl), before + 1);
    assert_int_equal(program("fill.vert", "fill.frag", NULL), plain);
    assert_int_equal(program("fill.vert", "fill.frag", ""), plain);
    assert_int_equal(ssfr_gl_allocations(gl), before + 1);
    const unsigned defined = program("fill.vert", "fill.frag", "#define SSFR_TEST 1\n");
    assert_int_not_equal(defined, plain);
    assert_int_equal(program("fill.vert", "fill.frag", "#define SSFR_TEST 1\n"), defined);
    assert_int_equal(ssfr_gl_allocations(gl), before + 2);
}

static void folder_of_shaders_comes_before_the_binary(void **state)
{
    (void)state;
    begin();
    put_shader("fill.frag", HEAD "void main() { o = vec4(2.5, 3.5, 4.5, 5.5); }"); /* no newline at the end */
    ssfr_texture image = texture(3, 2, 4);
    draw(program("fill.vert", "fill.frag", NULL), &image);
    ssfr_field *got = read_back(&image);
    for (int i = 0; i < 24; i++) assert_true(got->data[i] == i % 4 + 2.5);
    ssfr_field_destroy(&got);
    ssfr_texture_finish(&image);
    remove(test_path("fill.frag"));
}

static void includes_are_put_in_once_a_stage(void **state)
{
    (void)state;
    begin();
    put_shader("two.glsl", "float two() { return 2.0; }\n");
    put_shader("four.glsl", "#include \"two.glsl\"\nfloat four() { return two() + two(); }\n");
    put_shader("sum.frag", HEAD "  #  include \"two.glsl\"\n#include \"four.glsl\"\n#include \"two.glsl\" \n"
                                "void main() { o = vec4(two(), four(), OFFSET, 7.0); }\n");
    ssfr_texture image = texture(3, 2, 4);
    draw(program("fill.vert", "sum.frag", "#define OFFSET 2.385"), &image);
    ssfr_field *got = read_back(&image);
    const double expected[4] = {2, 4, (double)2.385f, 7};
    for (int i = 0; i < 24; i++) assert_true(got->data[i] == expected[i % 4]);
    ssfr_field_destroy(&got);
    ssfr_texture_finish(&image);
}

static void compile_errors_name_file_and_line(void **state)
{
    (void)state;
    begin();
    put_shader("broken.frag", HEAD "void main()\n{\n    o = vec4(1.0) +;\n}\n");
    program_fails(SSFR_ERR_GL, "broken.frag", NULL, "broken.frag:6: ");
    program_fails(SSFR_ERR_GL, "broken.frag", "#define A 1\n#define B 2\n", "broken.frag:6: ");
    put_shader("unknown.frag", HEAD "void main() { o = vec4(nobody); }\n");
    program_fails(SSFR_ERR_GL, "unknown.frag", NULL, "unknown.frag:4: ");
    put_shader("broken.vert", "#version 450 core\n\nvoid main() { gl_Position = 1; }\n");
    unsigned name;
    assert_fails(SSFR_ERR_GL, ssfr_program_get(gl, &name, "broken.vert", "fill.frag", NULL), "broken.vert:3: ");
}

static void compile_errors_inside_includes_name_the_include(void **state)
{
    (void)state;
    begin();
    put_shader("good.glsl", "float good() { return 1.0; }\n");
    put_shader("inner.glsl", "#include \"good.glsl\"\n\nfloat bad() { return nobody; }\n");
    put_shader("outer.glsl", "#include \"good.glsl\"\n#include \"inner.glsl\"\nfloat outer() { return bad(); }\n");
    put_shader("uses.frag", HEAD "#include \"outer.glsl\"\nvoid main() { o = vec4(outer()); }\n");
    program_fails(SSFR_ERR_GL, "uses.frag", NULL, "inner.glsl:3: ");
    put_shader("inner.glsl", "float bad() { return 1.0; }\n");
    put_shader("outer.glsl", "#include \"good.glsl\"\n#include \"inner.glsl\"\nfloat outer() { return nobody; }\n");
    program_fails(SSFR_ERR_GL, "uses.frag", NULL, "outer.glsl:3: ");
    put_shader("outer.glsl", "#include \"good.glsl\"\n#include \"inner.glsl\"\nfloat outer() { return bad(); }\n");
    put_shader("uses.frag", HEAD "#include \"outer.glsl\"\nvoid main() { o = nobody; }\n");
    program_fails(SSFR_ERR_GL, "uses.frag", NULL, "uses.frag:5: ");
    program_fails(SSFR_ERR_GL, "fill.frag", "#define A 1\nnonsense;", "fill.vert, defines:2: ");
}

static void link_errors_name_both_shaders(void **state)
{
    (void)state;
    begin();
    put_shader("wants.frag", HEAD "in vec4 v_missing;\nvoid main() { o = v_missing; }\n");
    program_fails(SSFR_ERR_GL, "wants.frag", NULL, "fill.vert with wants.frag: ");
}

static void sources_that_are_missing_or_malformed_are_refused(void **state)
{
    (void)state;
    begin();
    unsigned name;
    assert_fails(SSFR_ERR_UNKNOWN, ssfr_program_get(gl, &name, "none.vert", "fill.frag", NULL),
                 "none.vert: no such shader");
    program_fails(SSFR_ERR_UNKNOWN, "none.frag", NULL, "none.frag: no such shader");
    put_shader("asks.frag", HEAD "#include \"none.glsl\"\nvoid main() {}\n");
    program_fails(SSFR_ERR_UNKNOWN, "asks.frag", NULL, "asks.frag:4: none.glsl: no such shader");
    static const char *const malformed[] = {
        "#include", "#include <a.glsl>", "#include \"a.glsl", "#include \"\"",
        "#include \"a-name-of-sixty-four-letters-or-more-is-not-a-name-of-a-shader-file.glsl\""};
    for (size_t i = 0; i < SSFR_COUNT(malformed); i++) {
        char text[256];
        snprintf(text, sizeof text, HEAD "\n%s\nvoid main() {}\n", malformed[i]);
        put_shader("malformed.frag", text);
        program_fails(SSFR_ERR_FORMAT, "malformed.frag", NULL, "malformed.frag:5: expected #include \"name\"");
    }
    put_shader("bare.frag", "void main() {}\n");
    program_fails(SSFR_ERR_FORMAT, "bare.frag", NULL, "bare.frag: no #version line");
    put_shader("empty.frag", "");
    program_fails(SSFR_ERR_FORMAT, "empty.frag", NULL, "empty.frag: no #version line");
}

static void a_shader_of_too_many_files_is_refused(void **state)
{
    (void)state;
    begin();
    char name[32], text[64];
    for (int i = 0; i < 40; i++) {
        snprintf(name, sizeof name, "chain%d.glsl", i);
        snprintf(text, sizeof text, "#include \"chain%d.glsl\"\n", i + 1);
        put_shader(name, text);
    }
    put_shader("chain.frag", HEAD "#include \"chain0.glsl\"\nvoid main() {}\n");
    program_fails(SSFR_ERR_UNSUPPORTED, "chain.frag", NULL, "more than 32 files in a shader");
}

static void a_truncated_shader_is_an_error_or_a_program(void **state)
{
    (void)state;
    begin();
    const char *text = HEAD "#include \"cut.glsl\"\nvoid main() { o = vec4(cut()); }\n";
    put_shader("cut.glsl", "float cut() { return 2.385; }\n");
    for (size_t length = 0; length <= strlen(text); length++) {
        char part[256], define[64];
        unsigned name;
        snprintf(part, sizeof part, "%.*s", (int)length, text);
        snprintf(define, sizeof define, "#define LENGTH %zu", length); /* another entry of the cache each time */
        test_write_file(test_path("cut.frag"), part, length);
        test_clear_log();
        const ssfr_result result = ssfr_program_get(gl, &name, "fill.vert", "cut.frag", define);
        assert_true((result == SSFR_OK) == (length >= strlen(text) - 1));
        assert_int_equal(test_n_errors(), result == SSFR_OK ? 0 : 1);
    }
}

static void logs_of_all_compilers_are_understood(void **state)
{
    (void)state;
    static const struct {
        const char *log, *text;
        long line;
    } cases[] = {
        {"1:12(3): error: `x' undeclared\n", "error: `x' undeclared\n", 12},
        {"0:4(1): warning: unused\n2:31(7-9): error: bad\n0:5(1): error: worse\n",
         "error: bad\n0:5(1): error: worse\n", 31},
        {"0:1(2): preprocessor error: #if without #endif\n", "preprocessor error: #if without #endif\n", 1},
        {"3(17) : error C1008: undefined variable \"x\"\n", "error C1008: undefined variable \"x\"\n", 17},
        {"0(3) : warning C7050: unset\n0(8) : error C0000: syntax", "error C0000: syntax", 8},
        {"ERROR: 0:5: 'x' : undeclared identifier\n", "'x' : undeclared identifier\n", 5},
        {"\n  something went wrong\n", "something went wrong\n", 0},
        {"error: linking with uncompiled shader\n", "error: linking with uncompiled shader\n", 0},
        {"12", "12", 0},
        {"12:", "12:", 0},
        {"", "the driver does not say why", 0},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        long line;
        assert_string_equal(ssfr_gl_parse_log(cases[i].log, &line), cases[i].text);
        assert_int_equal(line, cases[i].line);
    }
}

/* ---- buffers, counts, timers ------------------------------------------------------------------------------------- */

static void buffers_hold_what_they_are_given(void **state)
{
    (void)state;
    begin();
    const float data[3] = {2.385f, -1e30f, 7};
    float got[3] = {0};
    unsigned fixed, dynamic, empty;
    assert_int_equal(ssfr_buffer_create(gl, &fixed, sizeof data, data, false), SSFR_OK);
    glGetNamedBufferSubData(fixed, 0, sizeof got, got);
    assert_memory_equal(got, data, sizeof data);
    assert_int_equal(ssfr_buffer_create(gl, &dynamic, sizeof data, NULL, true), SSFR_OK);
    glNamedBufferSubData(dynamic, 0, sizeof data, data);
    glGetNamedBufferSubData(dynamic, 0, sizeof got, got);
    assert_memory_equal(got, data, sizeof data);
    assert_int_equal(ssfr_buffer_create(gl, &empty, 0, NULL, false), SSFR_OK);
    assert_int_not_equal(empty, 0);
    glNamedBufferSubData(fixed, 0, sizeof data, data);
    assert_fails(SSFR_ERR_GL, ssfr_gl_end(gl, SSFR_OK), "GL_INVALID_OPERATION");
    assert_int_equal(ssfr_gl_begin(gl), SSFR_OK);
    ssfr_buffer_destroy(&fixed);
    ssfr_buffer_destroy(&dynamic);
    ssfr_buffer_destroy(&empty);
    ssfr_buffer_destroy(&empty);
    assert_int_equal(empty, 0);
}

static void buffers_too_large_are_refused(void **state)
{
    (void)state;
    begin();
    unsigned buffer = 1;
    assert_fails(SSFR_ERR_VALUE, ssfr_buffer_create(gl, &buffer, SIZE_MAX, NULL, false), "GPU buffer of");
    assert_int_equal(buffer, 0);
    buffer = 1;
    assert_fails(SSFR_ERR_MEMORY, ssfr_buffer_create(gl, &buffer, (size_t)1 << 46, NULL, false), "GL_OUT_OF_MEMORY");
    assert_int_equal(buffer, 0);
}

static void images_buffers_and_programs_are_counted(void **state)
{
    (void)state;
    begin();
    const long before = ssfr_gl_allocations(gl);
    ssfr_texture image = texture(4, 4, 1);
    unsigned buffer;
    assert_int_equal(ssfr_buffer_create(gl, &buffer, 16, NULL, true), SSFR_OK);
    fill(&image, 1, 2, 3, 4);
    assert_int_equal(ssfr_gl_allocations(gl), before + 3);
    fill(&image, 1, 2, 3, 4);
    ssfr_texture_clear(&image, (const float[4]){0});
    assert_int_equal(ssfr_gl_allocations(gl), before + 3);
    ssfr_buffer_destroy(&buffer);
    ssfr_texture_finish(&image);
    assert_int_equal(ssfr_gl_allocations(gl), before + 3);
}

/* GPU time of filling a square n times, the least of 3, ms. */
static void a_watch_tells_whether_anything_was_drawn(void **state)
{
    (void)state;
    begin();
    ssfr_texture to = texture(7, 5, 1);
    const ssfr_texture *const target = &to;
    assert_int_equal(ssfr_gl_target(gl, 1, &target), SSFR_OK);
    glUseProgram(program("fill.vert", "fill.frag", NULL));
    for (int i = 0; i < 6; i++) { /* again and again, in any order */
        const bool draws = i == 1 || i == 2 || i == 4;
        ssfr_gl_watch_begin(gl);
        glDrawArrays(GL_TRIANGLES, 0, draws ? 3 : 0);
        assert_int_equal(ssfr_gl_watch_end(gl), draws);
    }
    glDrawArrays(GL_TRIANGLES, 0, 3); /* unwatched */
    ssfr_gl_watch_begin(gl);
    assert_false(ssfr_gl_watch_end(gl));
    ssfr_texture_finish(&to);
}

static double time_filling(ssfr_timers *timers, int i, int side, int n)
{
    ssfr_texture image = texture(side, side, 4);
    double least = INFINITY;
    for (int trial = 0; trial < 3; trial++) {
        fill(&image, 1, 2, 3, 4);
        glFinish();
        ssfr_timers_start(timers, i);
        if (ssfr_gl_is_software(gl)) glFlush(); /* there a stamp is that of the end of what it is queued with */
        for (int k = 0; k < n; k++) glDrawArrays(GL_TRIANGLES, 0, 3);
        ssfr_timers_stop(timers, i);
        least = fmin(least, ssfr_timers_ms(timers, i));
    }
    ssfr_texture_finish(&image);
    return least;
}

static void timers_grow_with_the_work(void **state)
{
    (void)state;
    begin();
    ssfr_timers timers;
    assert_int_equal(ssfr_timers_create(&timers, 3), SSFR_OK);
    assert_int_equal(timers.n, 3);
    const double little = time_filling(&timers, 0, 64, 1), much = time_filling(&timers, 2, 2048, 40);
    assert_true(little > 0);
    assert_true(much > 2 * little);
    const double wall = ssfr_clock();
    assert_true(time_filling(&timers, 1, 512, 10) < 1e3 * (ssfr_clock() - wall));
    ssfr_timers_finish(&timers);
    assert_null(timers.queries);
    ssfr_timers_finish(&timers);
    assert_fails(SSFR_ERR_VALUE, ssfr_timers_create(&timers, -1), "-1 timers");
}

#define DRAWS(test) cmocka_unit_test_teardown(test, end)

int main(void)
{
    const struct CMUnitTest tests[] = {
        DRAWS(own_context_tells_what_it_is),
        cmocka_unit_test(own_context_comes_and_goes_twenty_times),
        DRAWS(two_own_contexts_give_way_to_each_other),
        DRAWS(environment_forces_software_or_device),
        DRAWS(errors_of_gl_become_the_result_of_end),
        DRAWS(images_come_back_as_written),
        DRAWS(images_round_doubles_to_float),
        DRAWS(images_of_halves_hold_halves),
        DRAWS(images_of_wrong_size_are_refused),
        DRAWS(fields_of_another_size_are_not_written),
        DRAWS(running_out_of_memory_is_one_error_and_no_harm),
        DRAWS(clearing_sets_every_pixel),
        DRAWS(borrowed_images_are_not_deleted),
        DRAWS(filling_writes_every_pixel_exactly),
        DRAWS(row_0_is_the_top_row),
        DRAWS(points_are_squares_whose_coordinates_grow_rightwards_and_upwards),
        DRAWS(several_targets_are_drawn_at_once),
        DRAWS(targets_that_do_not_fit_are_refused),
        DRAWS(no_pass_leaks_state_into_the_next),
        DRAWS(programs_are_made_once),
        DRAWS(folder_of_shaders_comes_before_the_binary),
        DRAWS(includes_are_put_in_once_a_stage),
        DRAWS(compile_errors_name_file_and_line),
        DRAWS(compile_errors_inside_includes_name_the_include),
        DRAWS(link_errors_name_both_shaders),
        DRAWS(sources_that_are_missing_or_malformed_are_refused),
        DRAWS(a_shader_of_too_many_files_is_refused),
        DRAWS(a_truncated_shader_is_an_error_or_a_program),
        cmocka_unit_test(logs_of_all_compilers_are_understood),
        DRAWS(buffers_hold_what_they_are_given),
        DRAWS(buffers_too_large_are_refused),
        DRAWS(images_buffers_and_programs_are_counted),
        DRAWS(a_watch_tells_whether_anything_was_drawn),
        DRAWS(timers_grow_with_the_work),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}
