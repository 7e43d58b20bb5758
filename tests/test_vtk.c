/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_vtk.c: particles in legacy VTK files of both encodings, what must be refused, and a simulator's own file. */
#include "tests/particle_files.h"

static const struct {
    const char *name;
    ssfr_scalar type;
} types[] = {
    {"char", SSFR_INT8},           {"signed_char", SSFR_INT8},    {"unsigned_char", SSFR_UINT8},
    {"short", SSFR_INT16},         {"unsigned_short", SSFR_UINT16}, {"int", SSFR_INT32},
    {"unsigned_int", SSFR_UINT32}, {"long", SSFR_INT64},          {"unsigned_long", SSFR_UINT64},
    {"vtktypeint64", SSFR_INT64},  {"vtktypeuint64", SSFR_UINT64}, {"vtkIdType", SSFR_INT32},
    {"float", SSFR_FLOAT32},       {"double", SSFR_FLOAT64},
};

/* One number in the file's encoding. */
static void put(bytes *b, bool binary, ssfr_scalar type, double value)
{
    if (binary)
        put_number(b, type, true, value);
    else
        put_text(b, "%.9g\n", value);
}

static void put_cells(bytes *b, bool binary, int version, bool unstructured)
{
    const int numbers[] = {1, 0, 1, 1, 1, 2}, offsets[] = {0, 1, 2, 3};
    const char *name = unstructured ? "CELLS" : "VERTICES";
    if (version < 5) {
        put_text(b, "%s 3 6\n", name);
        for (int i = 0; i < 6; i++) put(b, binary, SSFR_INT32, numbers[i]);
    } else {
        put_text(b, "%s 4 3\nOFFSETS vtktypeint64\n", name);
        for (int i = 0; i < 4; i++) put(b, binary, SSFR_INT64, offsets[i]);
        put_text(b, "\nCONNECTIVITY vtktypeint64\n");
        for (int i = 0; i < 3; i++) put(b, binary, SSFR_INT64, i);
        put_text(b, "\nMETADATA\nINFORMATION 0\n\n");
    }
    if (unstructured) put_text(b, "\nCELL_TYPES 3\n");
    for (int i = 0; i < 3 && unstructured; i++) put(b, binary, SSFR_INT32, 1);
    put_text(b, "\n");
}

/* Three particles at (0, 1, 2), (3, 4, 5), (6, 7, 8) with a mesh, data of cells, and other data of points. */
static bytes make_start(bool binary, int version, bool unstructured, ssfr_scalar type, const char *type_name)
{
    bytes b = {0};
    put_text(&b, "# vtk DataFile Version %d.1\n\n%s\n", version, binary ? "BINARY" : "ASCII");
    put_text(&b, "DATASET %s\nFIELD FieldData 1\nTIME 1 1 double\n", unstructured ? "UNSTRUCTURED_GRID" : "POLYDATA");
    put(&b, binary, SSFR_FLOAT64, 2.385);
    put_text(&b, "\nPOINTS 3 %s\n", type_name);
    for (int k = 0; k < 9; k++) put(&b, binary, type, k);
    put_text(&b, "\n");
    put_cells(&b, binary, version, unstructured);
    put_text(&b, "CELL_DATA 3\nSCALARS density float\nLOOKUP_TABLE own\n");
    for (int k = 0; k < 3; k++) put(&b, binary, SSFR_FLOAT32, -1);
    put_text(&b, "\nLOOKUP_TABLE own 2\n");
    for (int k = 0; k < 8; k++) put(&b, binary, SSFR_UINT8, 1);
    put_text(&b, "\nNORMALS v float\n");
    for (int k = 0; k < 9; k++) put(&b, binary, SSFR_FLOAT32, -1);
    put_text(&b, "\nPOINT_DATA 3\nCOLOR_SCALARS tint 3\n");
    for (int k = 0; k < 9; k++) put(&b, binary, SSFR_UINT8, 1);
    put_text(&b, "\nTEXTURE_COORDINATES uv 2 short\n");
    for (int k = 0; k < 6; k++) put(&b, binary, SSFR_INT16, 10);
    put_text(&b, "\nTENSORS stress float\n");
    for (int k = 0; k < 27; k++) put(&b, binary, SSFR_FLOAT32, 10);
    put_text(&b, "\n");
    return b;
}

/* ids, neighbours and kind as SCALARS, velocity as VECTORS, density and lifetime in a FIELD; all of one type. */
static bytes make_file(bool binary, int version, bool unstructured, ssfr_scalar type, const char *name)
{
    static const char *const scalars[] = {"ID", "Neighbors", "type"}, *const fields[] = {"rho", "lifetime"};
    bytes b = make_start(binary, version, unstructured, type, name);
    for (int a = 0; a < 3; a++) {
        put_text(&b, "scalars %s %s%s\n%s", scalars[a], name, a ? " 1" : "", a == 2 ? "" : "LOOKUP_TABLE default\n");
        for (int i = 0; i < 3; i++) put(&b, binary, type, 10 * a + i);
        put_text(&b, "\n");
    }
    put_text(&b, "VECTORS Vel %s\n", name);
    for (int k = 0; k < 9; k++) put(&b, binary, type, 50 + k);
    put_text(&b, "\nFIELD FieldData 4\nNULL_ARRAY\n");
    for (int a = 0; a < 2; a++) {
        put_text(&b, "%s 1 3 %s\n", fields[a], name);
        for (int i = 0; i < 3; i++) put(&b, binary, type, 30 + 10 * a + i);
        put_text(&b, "\nMETADATA\nCOMPONENT_NAMES\nX\n\n");
    }
    put_text(&b, "other 2 2 %s\n", name);
    for (int k = 0; k < 4; k++) put(&b, binary, type, k);
    if (version == 5) put_text(&b, "\nMETADATA\nINFORMATION 0\n");
    return b;
}

static void check_file(bytes b)
{
    ssfr_particles *p = NULL;
    ssfr_load_options options = {.radius = 0.5};
    test_clear_log();
    if (ssfr_particles_load(&p, particle_file("all.vtk", b.data, b.n), &options)) fail_msg("%s", test_last_error());
    assert_int_equal(p->n, 3);
    for (uint32_t i = 0; i < 3; i++) {
        const size_t at = find_particle(p, 3 * i, 3 * i + 1, 3 * i + 2);
        assert_int_equal(p->id[at], i);
        assert_int_equal(p->neighbours[at], 10 + i);
        assert_int_equal(p->kind[at], 20 + i);
        for (uint32_t k = 0; k < 3; k++) assert_true(p->velocity[3 * at + k] == (float)(50 + 3 * i + k));
        assert_true(p->density[at] == (float)(30 + i) && p->lifetime[at] == (float)(40 + i));
    }
    ssfr_particles_destroy(&p);
}

static void every_encoding_version_and_type_gives_the_same_particles(void **state)
{
    (void)state;
    for (size_t t = 0; t < SSFR_COUNT(types); t++)
        for (int choice = 0; choice < 8; choice++)
            check_file(make_file(choice & 1, choice & 2 ? 5 : 3, choice & 4, types[t].type, types[t].name));
}

static void bits_are_unpacked_from_the_highest_down(void **state)
{
    (void)state;
    static const uint32_t kinds[] = {1, 0, 0, 1, 1, 0, 1, 0, 0, 1};
    for (int binary = 0; binary < 2; binary++) {
        bytes b = {0};
        put_text(&b, "# vtk DataFile Version 2.0\nbits\n%s\nDATASET POLYDATA\nPOINTS 10 float\n",
                 binary ? "BINARY" : "ASCII");
        for (int k = 0; k < 30; k++) put(&b, binary, SSFR_FLOAT32, k % 3 ? 0 : k);
        put_text(&b, "POINT_DATA 10\nSCALARS other bit\nLOOKUP_TABLE default\n");
        for (int i = 0; i < (binary ? 2 : 10); i++) put(&b, binary, SSFR_UINT8, 1);
        put_text(&b, "\nSCALARS kind bit\nLOOKUP_TABLE default\n");
        for (int i = 0; i < 10 && !binary; i++) put_text(&b, "%u ", kinds[i]);
        if (binary) put_text(&b, "%c%c", 0x9a, 0x40);
        ssfr_particles *p = load(particle_file("bits.vtk", b.data, b.n));
        for (size_t i = 0; i < 10; i++) assert_int_equal(p->kind[find_particle(p, 3 * (double)i, 0, 0)], kinds[i]);
        ssfr_particles_destroy(&p);
    }
}

/* An ascii file of the lines after ASCII. */
static const char *ascii(const char *lines)
{
    bytes b = {0};
    put_text(&b, "# vtk DataFile Version 4.1\ntest\nASCII\n%s", lines);
    return particle_file("ascii.vtk", b.data, b.n);
}

#define POINTS "DATASET POLYDATA\nPOINTS 2 float\n0 0 0 2.385 0 0\nPOINT_DATA 2\n"

static void points_alone_and_no_points_are_files(void **state)
{
    (void)state;
    ssfr_particles *p = load(ascii("DATASET POLYDATA\nPOINTS 2 double\n0 0 0 2.385 0 0"));
    find_particle(p, 2.385, 0, 0);
    assert_close(p->radius, 1.1925, 1e-6, 0);
    ssfr_particles_destroy(&p);
    p = load(ascii("DATASET POLYDATA\nPOINTS 0 double\nVERTICES 0 0\n"
                   "POINT_DATA 0\nSCALARS id int\nLOOKUP_TABLE default\n"));
    assert_int_equal(p->n, 0);
    ssfr_particles_destroy(&p);
    check_refused(ascii("DATASET POLYDATA\nPOINTS 1 float\n0 0 0\n"), SSFR_ERR_VALUE, "say the radius");
}

static void arrays_of_another_shape_are_skipped_with_a_warning(void **state)
{
    static const struct {
        const char *lines, *says;
    } cases[] = {
        {POINTS "SCALARS velocity float 1\nLOOKUP_TABLE default\n1 2\n", "velocity skipped"},
        {POINTS "FIELD f 1\nvelocity 3 1 float\n1 2 3\n", "expected one array of 2 x 3 values, found 1 x 3"},
        {POINTS "VECTORS v float\n1 2 3 4 5 6\nVECTORS vel float\n1 2 3 4 5 6\n", "velocity skipped"},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_particles *p = load_and_listen(state, ascii(cases[i].lines));
        assert_non_null(strstr(told, cases[i].says));
        assert_int_equal(p->velocity != NULL, i == 2);
        ssfr_particles_destroy(&p);
    }
}

static void a_bad_file_is_refused_with_the_place(void **state)
{
    (void)state;
    static const struct {
        const char *text, *says;
        ssfr_result code;
    } cases[] = {
        {"# vkt DataFile Version 4.1\n", "byte 0: expected a line # vtk DataFile Version", SSFR_ERR_FORMAT},
        {"# vtk DataFile Version x\n", "byte 0: expected a count", SSFR_ERR_FORMAT},
        {"# vtk DataFile Version 6.0\n\nASCII\n", "version 6: at most 5", SSFR_ERR_UNSUPPORTED},
        {"# vtk DataFile Version 4.1\n\nTEXT\n", "byte 28: expected ASCII or BINARY, found \"TEXT\"", SSFR_ERR_FORMAT},
        {"# vtk DataFile Version 4.1\n\nASCII\n", "there are no POINTS", SSFR_ERR_FORMAT},
        {"# vtk DataFile Version 4.1\n\nBINARY\nDATASET POLYDATA\nPOINTS 3 float\n0123456789ab0123456789ab",
         "byte 52: 3 x 3 values of type float, but 24 bytes follow", SSFR_ERR_FORMAT},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++)
        check_refused(text_file("bad.vtk", cases[i].text), cases[i].code, cases[i].says);
}

static void a_bad_section_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *lines, *says;
        ssfr_result code;
    } cases[] = {
        {"DATASET STRUCTURED_GRID\n", "expected POLYDATA or UNSTRUCTURED_GRID, found \"STRUCTURED_GRID\"",
         SSFR_ERR_UNSUPPORTED},
        {"DATASET POLYDATA\nPIONTS 1 float\n", "byte 55: expected a keyword, found \"PIONTS\"", SSFR_ERR_FORMAT},
        {"POINTS -1 float\n", "expected a count, found \"-1\"", SSFR_ERR_FORMAT},
        {"POINTS 1 quad\n0 0 0\n", "expected a scalar type, found \"quad\"", SSFR_ERR_FORMAT},
        {"POINTS 1 bit\n0 0 0\n", "expected a type of coordinates, found \"bit\"", SSFR_ERR_FORMAT},
        {"POINTS 1 float\n0 0 0\nPOINTS 1 float\n0 0 0\n", "a second POINTS", SSFR_ERR_FORMAT},
        {"POINTS 2 float\n0 0 0 1 1\n", "2 x 3 values of type float, but 10 bytes follow", SSFR_ERR_FORMAT},
        {"POINTS 2 float\n0.5 0 0 1 1\n", "particle 1 (from 0): expected its position, the file ends", SSFR_ERR_FORMAT},
        {"POINTS 2 float\n0 0 0 1 one 1\n", "expected its position, found \"one\"", SSFR_ERR_FORMAT},
        {"POINTS 9999999999999999999 float\n0 0 0", "9999999999999999999 x 3 values", SSFR_ERR_FORMAT},
        {"POINT_DATA 1\n", "POINT_DATA of 1 points, but there are 0", SSFR_ERR_FORMAT},
        {POINTS "POINT_DATA 3\n", "POINT_DATA of 3 points, but there are 2", SSFR_ERR_FORMAT},
        {POINTS "SCALARS id\n1 2", "expected a scalar type, found \"\"", SSFR_ERR_FORMAT},
        {POINTS "SCALARS id int one\n1 2", "expected a count, found \"one\"", SSFR_ERR_FORMAT},
        {POINTS "SCALARS id float\n1 2.5", "particle 1 (from 0): id is 2.5, expected a whole number", SSFR_ERR_FORMAT},
        {POINTS "SCALARS id int\n1 -2", "particle 1 (from 0): id is -2, expected a whole number", SSFR_ERR_FORMAT},
        {POINTS "SCALARS heat int\n1 hot", "expected 2 values of type int, found \"hot\"", SSFR_ERR_FORMAT},
        {POINTS "SCALARS name string\na b", "expected a scalar type, found \"string\"", SSFR_ERR_FORMAT},
        {POINTS "FIELD f 2\nheat 1 2 float\n1 2\n", "expected an array of the field, found \"\"", SSFR_ERR_FORMAT},
        {POINTS "FIELD f 1\nheat 9999999999999999 9999999999999999 float\n1 2\n", "99999999 x 999", SSFR_ERR_FORMAT},
        {POINTS "FIELD f 1\nheat 1 -1 float\n1 2\n", "expected a count, found \"-1\"", SSFR_ERR_FORMAT},
        {POINTS "LINES 1 99999999999\n", "99999999999 x 1 values of type int", SSFR_ERR_FORMAT},
        {POINTS "CELL_TYPES many\n", "expected a count, found \"many\"", SSFR_ERR_FORMAT},
        {POINTS "\001\002\n", "expected a keyword, found \"\?\?\"", SSFR_ERR_FORMAT},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) check_refused(ascii(cases[i].lines), cases[i].code, cases[i].says);
}

static void broken_lines_and_new_cells_are_refused(void **state)
{
    (void)state;
    char line[2000];
    bytes b = {0};
    memset(line, 'x', sizeof line);
    line[sizeof line - 1] = '\0';
    check_refused(ascii(line), SSFR_ERR_FORMAT, "expected a line of text, found \"xxx");
    check_refused(particle_file("zero.vtk", "# vtk\0\n", 7), SSFR_ERR_FORMAT, "expected a line of text, found \"#\"");
    put_text(&b, "# vtk DataFile Version 5.1\ntest\nASCII\nDATASET POLYDATA\nVERTICES 2 1\nOFFSET int\n0 1\n");
    check_refused(particle_file("cells.vtk", b.data, b.n), SSFR_ERR_FORMAT, "expected OFFSETS, found \"OFFSET\"");
}

static void binary_values_that_are_missing_are_refused(void **state)
{
    (void)state;
    bytes b = {0};
    put_text(&b, "# vtk DataFile Version 4.1\ntest\nBINARY\nDATASET POLYDATA\nPOINTS 9 float\n");
    for (int k = 0; k < 27; k++) put_number(&b, SSFR_FLOAT32, true, k);
    put_text(&b, "POINT_DATA 9\nSCALARS kind bit\nLOOKUP_TABLE default\n\1");
    check_refused(particle_file("bits.vtk", b.data, b.n), SSFR_ERR_FORMAT, "9 x 1 values of type bit, but 1 bytes");
    put_text(&b, "\1\nVECTORS v float\n0123");
    check_refused(particle_file("bits.vtk", b.data, b.n), SSFR_ERR_FORMAT, "9 x 3 values of type float, but 4 bytes");
}

static void values_that_are_not_finite_are_refused_or_dropped(void **state)
{
    (void)state;
    static const char lines[] = "DATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 inf 0 2 0 0 3 0 0\nPOINT_DATA 4\n"
                                "SCALARS rho float\nLOOKUP_TABLE default\n1 2 nan 4\n"
                                "VECTORS v float\n0 0 0 0 0 0 0 0 0 1 2 3\n";
    ssfr_load_options options = {.drop_nonfinite = true, .radius = 0.5};
    ssfr_particles *p = NULL;
    check_refused(ascii(lines), SSFR_ERR_VALUE, "particle 1 (from 0): position is inf");
    assert_int_equal(ssfr_particles_load(&p, ascii(lines), &options), SSFR_OK);
    assert_int_equal(options.n_dropped, 2);
    assert_int_equal(p->n, 2);
    const size_t at = find_particle(p, 3, 0, 0);
    assert_true(p->density[at] == 4 && p->velocity[3 * at + 2] == 3);
    ssfr_particles_destroy(&p);
}

static void a_file_cut_anywhere_or_damaged_never_harms(void **state)
{
    (void)state;
    for (int choice = 0; choice < 4; choice++) {
        const bytes b = make_file(choice & 1, choice & 2 ? 5 : 4, choice & 1, SSFR_FLOAT32, "float");
        check_truncations("cut.vtk", b.data, b.n);
        check_damage("damaged.vtk", b.data, b.n);
    }
}

static void a_radius_stands_in_the_files_own_field(void **state)
{
    (void)state;
    static const char points[] = "POINTS 2 float\n0 0 0 2.385 0 0\n";
    bytes b = {0};
    put_text(&b, "DATASET POLYDATA\nFIELD FieldData 2\nTIME 1 1 double\n7\nRadius 1 1 float\n0.25\n%s", points);
    ssfr_particles *p = load(ascii(b.data));
    assert_true(p->radius == 0.25);
    ssfr_particles_destroy(&p);
    b = (bytes){0}; /* those of cells are not the file's */
    put_text(&b, "DATASET POLYDATA\n%sCELL_DATA 1\nFIELD f 1\nradius 1 1 float\n0.25\n", points);
    p = load(ascii(b.data));
    assert_close(p->radius, 1.1925, 1e-6, 0);
    ssfr_particles_destroy(&p);
    check_refused(ascii("DATASET POLYDATA\nFIELD f 1\nradius 1 1 float\nwide\n"), SSFR_ERR_FORMAT,
                  "expected a radius, found \"wide\"");
    check_refused(ascii("DATASET POLYDATA\nFIELD f 1\nradius 1 1 float\n-2.385\nPOINTS 0 float\n"), SSFR_ERR_FORMAT,
                  "radius is -2.385 m");
}

static void radii_of_the_points_count_when_all_are_the_same(void **state)
{
    static const struct {
        const char *values, *says;
        double radius;
    } cases[] = {
        {"0.25 0.25", "", 0.25},
        {"0.25 0.125", "the particles have radii from 0.125 to 0.25 m, none for all: they are not used", 1.1925},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        bytes b = {0};
        put_text(&b, "DATASET POLYDATA\nPOINTS 2 float\n0 0 0 2.385 0 0\n");
        put_text(&b, "POINT_DATA 2\nSCALARS Radius float\nLOOKUP_TABLE default\n%s\n", cases[i].values);
        ssfr_particles *p = load_and_listen(state, ascii(b.data));
        assert_close(p->radius, cases[i].radius, 1e-6, 0);
        assert_non_null(strstr(told, cases[i].says));
        ssfr_particles_destroy(&p);
    }
    check_refused(ascii("DATASET POLYDATA\nPOINTS 1 float\n0 0 0\nPOINT_DATA 1\nSCALARS radius float\n"
                         "LOOKUP_TABLE default\n-2.385\n"),
                  SSFR_ERR_FORMAT, "particle 0 (from 0): radius is -2.385 m");
}

static void arrays_of_points_that_are_not_read_are_told(void **state)
{
    ssfr_particles *p = load_and_listen(
        state, ascii("DATASET POLYDATA\nPOINTS 2 float\n0 0 0 2.385 0 0\n"
                     "CELL_DATA 1\nSCALARS of_cells int\nLOOKUP_TABLE default\n1\n"
                     "POINT_DATA 2\nSCALARS Temp int\nLOOKUP_TABLE default\n1 2\nVECTORS v float\n1 2 3 4 5 6\n"
                     "TEXTURE_COORDINATES uv 1 float\n0 1\nCOLOR_SCALARS rgb 1\n0.5 1\n"));
    assert_non_null(strstr(told, ": not read: \"Temp\" \"uv\" \"rgb\"\n"));
    assert_non_null(p->velocity);
    ssfr_particles_destroy(&p);
}

static void what_is_written_has_points_a_vertex_each_and_arrays(void **state)
{
    (void)state;
    const double positions[] = {0.375, -0.5, 0.25, 0.375, -0.5, 0.25};
    float velocity[] = {1, -2.385f, 0.5f, 4, 5, -0.0f};
    uint32_t id[] = {7, 4294967295u};
    const ssfr_particles given = {.velocity = velocity, .id = id, .radius = 0.1};
    ssfr_particles *p = NULL;
    char *file = NULL;
    size_t n = 0;
    bytes b = {0};
    put_text(&b, "# vtk DataFile Version 3.0\nparticles: metres, seconds, kilograms\nBINARY\nDATASET POLYDATA\n");
    put_text(&b, "FIELD FieldData 1\nradius 1 1 double\n");
    put_number(&b, SSFR_FLOAT64, true, 0.1);
    put_text(&b, "\nPOINTS 2 float\n");
    for (size_t k = 0; k < 6; k++) put_number(&b, SSFR_FLOAT32, true, positions[k]);
    put_text(&b, "\nVERTICES 2 4\n");
    for (int k = 0; k < 4; k++) put_number(&b, SSFR_INT32, true, k % 2 ? k / 2 : 1);
    put_text(&b, "\nPOINT_DATA 2\nFIELD FieldData 2\nvelocity 3 2 float\n");
    for (size_t k = 0; k < 6; k++) put_number(&b, SSFR_FLOAT32, true, (double)velocity[k]);
    put_text(&b, "\nid 1 2 unsigned_int\n");
    for (size_t i = 0; i < 2; i++) put_number(&b, SSFR_UINT32, true, id[i]);
    put_text(&b, "\n");
    assert_int_equal(ssfr_particles_create(&p, 2, positions, &given), SSFR_OK);
    assert_int_equal(ssfr_particles_save(p, test_path("written.vtk")), SSFR_OK);
    assert_int_equal(ssfr_read_file(test_path("written.vtk"), SSFR_READ_MAX, &file, &n), SSFR_OK);
    assert_int_equal(n, b.n);
    assert_memory_equal(file, b.data, n);
    free(file);
    ssfr_particles_destroy(&p);
}

static void more_points_than_a_cell_can_count_are_not_written(void **state)
{
    (void)state;
    const ssfr_particles many = {.n = 2147483648u};
    assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_particles_save(&many, test_path("many.vtk")),
                 "many.vtk: 2147483648 particles: a cell of legacy VTK counts points up to 2147483647");
}

static void what_is_no_file_is_refused(void **state)
{
    (void)state;
    check_no_files(".vtk");
}

static int same_bits(const float *a, const float *b, size_t n)
{
    return memcmp(a, b, n * sizeof *a) == 0;
}

static void a_simulators_own_file_equals_its_conversion_to_ply(void **state)
{
    (void)state;
    char path[512];
    const char *data = test_data_or_skip();
    snprintf(path, sizeof path, "%s/native_ddb_mid_ParticleData_Fluid_56.vtk", data);
    ssfr_particles *vtk = load(path);
    snprintf(path, sizeof path, "%s/ddb_mid_fluid.ply", data);
    ssfr_particles *ply = load(path);
    size_t *place = calloc(ply->n, sizeof *place);
    assert_non_null(place);
    assert_int_equal(vtk->n, 104400);
    assert_int_equal(ply->n, vtk->n);
    for (size_t i = 0; i < ply->n; i++) {
        assert_in_range(ply->id[i], 0, ply->n - 1);
        place[ply->id[i]] = i;
    }
    for (size_t i = 0; i < vtk->n; i++) {
        double a[3], b[3];
        const size_t j = place[vtk->id[i]];
        ssfr_particles_position(vtk, i, a);
        ssfr_particles_position(ply, j, b);
        assert_int_equal(vtk->id[i], ply->id[j]);
        assert_memory_equal(a, b, sizeof a);
        assert_true(same_bits(vtk->velocity + 3 * i, ply->velocity + 3 * j, 3));
        assert_true(same_bits(vtk->density + i, ply->density + j, 1));
    }
    free(place);
    ssfr_particles_destroy(&vtk);
    ssfr_particles_destroy(&ply);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_encoding_version_and_type_gives_the_same_particles),
        cmocka_unit_test(bits_are_unpacked_from_the_highest_down),
        cmocka_unit_test(points_alone_and_no_points_are_files),
        cmocka_unit_test(arrays_of_another_shape_are_skipped_with_a_warning),
        cmocka_unit_test(a_bad_file_is_refused_with_the_place),
        cmocka_unit_test(a_bad_section_is_refused),
        cmocka_unit_test(broken_lines_and_new_cells_are_refused),
        cmocka_unit_test(binary_values_that_are_missing_are_refused),
        cmocka_unit_test(values_that_are_not_finite_are_refused_or_dropped),
        cmocka_unit_test(a_file_cut_anywhere_or_damaged_never_harms),
        cmocka_unit_test(a_radius_stands_in_the_files_own_field),
        cmocka_unit_test(radii_of_the_points_count_when_all_are_the_same),
        cmocka_unit_test(arrays_of_points_that_are_not_read_are_told),
        cmocka_unit_test(what_is_written_has_points_a_vertex_each_and_arrays),
        cmocka_unit_test(more_points_than_a_cell_can_count_are_not_written),
        cmocka_unit_test(what_is_no_file_is_refused),
        cmocka_unit_test(a_simulators_own_file_equals_its_conversion_to_ply),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}
