/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_text_particles.c: particles as tables of text, .csv and .xyz: what is read, what must be refused, and where. */
#include "tests/particle_files.h"

static void assert_refused(const char *path, ssfr_result code, const char *text)
{
    ssfr_particles *p = NULL;
    ssfr_load_options options = {.radius = 0.02385};
    assert_fails(code, ssfr_particles_load(&p, path, &options), text);
    assert_null(p);
}

/* ---- .csv -------------------------------------------------------------------------------------------------------- */

/* Two particles, at (0, 2.385, -1) and (1, 0.5, 2.25), in one of the many ways. */
static void check_two(const char *text)
{
    ssfr_particles *p = load(text_file("two.csv", text));
    assert_int_equal(p->n, 2);
    find_particle(p, 0, 2.385, -1);
    find_particle(p, 1, 0.5, 2.25);
    ssfr_particles_destroy(&p);
}

static void separators_quotes_and_line_ends_are_found_out(void **state)
{
    (void)state;
    check_two("x,y,z\n0,2.385,-1\n1,0.5,2.25\n");
    check_two("x;y;z\n0;2.385;-1\n1;0.5;2.25");
    check_two("x\ty\tz\n0\t2.385\t-1\n1\t0.5\t2.25\n");
    check_two("  x   y z  \n 0 2.385\t-1\n1  0.5 2.25  \n");
    check_two("x , y , z\r\n0 , 2.385 , -1\r\n1 , 0.5 , 2.25\r\n");
    check_two("\"x\",\"y\",\"z\"\n\"0\",\"2.385\",-1\n1, \"0.5\" ,2.25\n");
    check_two("\n\nx,y,z\n\n0,2.385,-1\n \n1,0.5,2.25\n\n\n");
    check_two("# x y z\n0 2.385 -1\n1 0.5 2.25\n");
    check_two("#x,y,z\n0,2.385,-1\n1,0.5,2.25\n");
    check_two("\xef\xbb\xbfx,y,z\n0,2.385,-1\n1,0.5,2.25\n");
    check_two("x\t\"a, b; c, d\"\ty\tz\n0\t7\t2.385\t-1\n1\t7\t0.5\t2.25\n");
    check_two("x,y,z\n0e7,+23.85e-1,-1.\n1,.5,225e-2\n");
}

static void names_of_many_programs_are_known(void **state)
{
    (void)state;
    static const char *const names[][3] = {
        {"X", "Y", "Z"},
        {"Points:0", "Points:1", "Points:2"},
        {"Points_0", "Points_1", "Points_2"},
        {"\"Points:0\"", "\"Points:1\"", "\"Points:2\""},
        {"position_x", "position_y", "position_z"},
        {"position.x", "position.y", "position.z"},
        {"Position[0]", "Position[1]", "Position[2]"},
        {"pos[x]", "pos[y]", "pos[z]"},
        {"PosX", "PosY", "PosZ"},
        {"coord-x", "coord-y", "coord-z"},
        {"x [m]", "y [m]", "z  [m]"},
    };
    for (size_t i = 0; i < SSFR_COUNT(names); i++) {
        bytes b = {0};
        put_text(&b, "%s,%s,%s\n0,2.385,-1\n1,0.5,2.25\n", names[i][0], names[i][1], names[i][2]);
        check_two(b.data);
        b = (bytes){0};
        put_text(&b, "%s,%s,%s\n2.385,-1,0\n0.5,2.25,1\n", names[i][1], names[i][2], names[i][0]);
        check_two(b.data);
    }
}

static void every_array_is_read_by_its_names(void **state)
{
    (void)state;
    static const char *const headers[] = {
        "id,z,vx,vy,vz,Density,lifetime,initial_lifetime,age,neighbors,type,x,y\n",
        "IDS,z,Velocity:0,Velocity:1,Velocity:2,rho,remaining_lifetime,lifespan,AGE,n_neighbours,kind,x,y\n",
        "particle_id,z [m],v[0],v[1],v[2],density [kg/m^3],lifetime [s],max_lifetime [s],age [s],neighbours,kind,x,y\n",
    };
    for (size_t h = 0; h < SSFR_COUNT(headers); h++) {
        bytes b = {0};
        put_text(&b, "%s7,-1,0.1,-0,1e-3,998.5,4,5.5,1.5,31,2,0,2.385\n", headers[h]);
        put_text(&b, "4294967295,2.25,1,2,3,3.5e38,0,0,0,0,0,1,0.5\n");
        ssfr_particles *p = NULL;
        ssfr_load_options options = {.radius = 0.5, .drop_nonfinite = true};
        assert_int_equal(ssfr_particles_load(&p, text_file("all.csv", b.data), &options), SSFR_OK);
        assert_int_equal(options.n_dropped, 1); /* 3.5e38 is no float */
        assert_int_equal(p->n, 1);
        find_particle(p, 0, 2.385, -1);
        assert_true(p->velocity[0] == 0.1f && signbit(p->velocity[1]) && p->velocity[2] == 1e-3f);
        assert_true(p->density[0] == 998.5f && p->lifetime[0] == 4 && p->initial_lifetime[0] == 5.5f);
        assert_true(p->age[0] == 1.5f && p->neighbours[0] == 31 && p->id[0] == 7 && p->kind[0] == 2);
        ssfr_particles_destroy(&p);
    }
}

static void other_columns_are_skipped_and_told(void **state)
{
    ssfr_particles *p = load_and_listen(
        state, text_file("other.csv", "\"Point ID\",x,temperature [K],y,z,\"a \"\"note\"\"\",Points_Magnitude\n"
                                      "0,0,,2.385,-1,\"cold, \"\"wet\"\"\nand dark\",2\n"
                                      "x,1,hot,0.5,2.25,,nan\n"));
    assert_int_equal(p->n, 2);
    find_particle(p, 0, 2.385, -1);
    find_particle(p, 1, 0.5, 2.25);
    assert_non_null(strstr(told, "other.csv: not read: \"Point\" \"temperature\" \"a\" \"Points_Magn"));
    assert_null(strstr(told, "\"x\""));
    assert_null(p->id);
    ssfr_particles_destroy(&p);
}

static void a_radius_is_a_column_of_one_value(void **state)
{
    ssfr_particles *p = load_and_listen(state, text_file("one.csv", "x y z Radius\n0 0 0 0.25\n0 2.385 0 0.25\n"));
    assert_true(p->radius == 0.25);
    assert_string_equal(told, "");
    ssfr_particles_destroy(&p);
    p = load_and_listen(state, text_file("many.csv", "x y z radius\n0 0 0 0.25\n0 2.385 0 0.5\n0 4.77 0 0.125\n"));
    assert_close(p->radius, 1.1925, 1e-6, 0);
    assert_non_null(strstr(told, "radii from 0.125 to 0.5 m"));
    ssfr_particles_destroy(&p);
    assert_refused(text_file("r.csv", "x y z radius\n0 0 0 -2.385\n"), SSFR_ERR_FORMAT, "(from 0): radius is -2.385 m");
    assert_refused(text_file("r.csv", "x y z radius\n0 0 0 1\n0 1 0 nan\n"), SSFR_ERR_FORMAT,
                   "particle 1 (from 0): radius is nan m");
}

static void a_table_without_rows_is_no_particles(void **state)
{
    (void)state;
    ssfr_particles *p = load(text_file("none.csv", "x,y,z,id"));
    assert_int_equal(p->n, 0);
    assert_non_null(p->id);
    ssfr_particles_destroy(&p);
}

static void bad_names_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text, *says;
    } cases[] = {
        {"\n\n", "bad.csv: the particles lack x, y or z"},
        {"x,y\n1,2\n", "lack x, y or z"},
        {"0,1,2\n1,2,3\n", "lack x, y or z"},
        {"x,y,z,vx,vz\n", "lack a component of velocity"},
        {"x,y,z,X\n", "two columns for what X says"},
        {"x,y,z,Points:1\n", "two columns for what Points:1 says"},
        {"x,y,z,rho,density\n", "two columns for what density says"},
        {"x [m],y [mm],z [m]\n", "bad.csv:1: y: expected units \"m\", found \"mm\""},
        {"\n\nx,y,z,density [g/cm^3]\n", "bad.csv:3: density: expected units \"kg/m^3\", found \"g/cm^3\""},
        {"x,y,\"z\n1,2,3\n", "the quotes of a name do not close"},
        {"\"x\"es,y,z\n1,2,3\n", "bad.csv:1: a name goes on after its quotes"},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++)
        assert_refused(text_file("bad.csv", cases[i].text), SSFR_ERR_FORMAT, cases[i].says);
}

static void a_bad_row_is_refused_with_line_and_column(void **state)
{
    (void)state;
    static const struct {
        const char *text, *says;
    } cases[] = {
        {"x,y,z\n1,2,3\n1,2\n", "bad.csv:3: the line ends after column 2 of 3"},
        {"x,y,z\r\n1,2,3\r\n1\r\n", "bad.csv:3: the line ends after column 1 of 3"},
        {"x,y,z\n\n1,2,3,4\n", "bad.csv:3: the line goes on after its 3 columns"},
        {"x,y,z\n1,2,3,\n", "bad.csv:2: the line goes on after its 3 columns"},
        {"x y z\n1 2\n3\n", "bad.csv:2: the line ends after column 2 of 3"},
        {"x,y,z\n1,two,3\n", "bad.csv:2: column 2 (y): expected a number, found \"two\""},
        {"x,y,z\n1,2m,3\n", "column 2 (y): expected a number, found \"2m\""},
        {"x,y,z\n1,,3\n", "column 2 (y): expected a number, found \"\""},
        {"x,y,z\n1,2,\n3,4,5\n", "bad.csv:2: column 3 (z): expected a number, found \"\""},
        {"x;y;z\n1,5;2;3\n", "bad.csv:2: column 1 (x): expected a number, found \"1,5\""},
        {"x,y,z\n1,\"2,3\n", "column 2 (y): expected a number, found \"\"2\""},
        {"x,y,z\n1,\"2\"2,3\n", "column 2 (y): expected a number, found"},
        {"x,y,z\n1,2 2,3\n", "bad.csv:2: column 2 (y): expected a separator after it, found \"2\""},
        {"x,y,z,note\n1,2,3,\"open\n\n", "column 4 (note): expected a quote at the text's end"},
        {"x,note,y,z\n1,\"a\nb\",2,3\n1,c,2,z\n", "bad.csv:4: column 4 (z): expected a number, found \"z\""},
        {"x,note,y,z\n1,\"a\"b,2,3\n", "bad.csv:2: column 2 (note): expected a separator after it, found \"b\""},
        {"x,y,z,id\n1,2,3,2.5\n", "particle 0 (from 0): id is 2.5, expected a whole number"},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++)
        assert_refused(text_file("bad.csv", cases[i].text), SSFR_ERR_FORMAT, cases[i].says);
    assert_refused(text_file("bad.csv", "x,y,z\n1,2,3\n1,nan,3\n"), SSFR_ERR_VALUE,
                   "particle 1 (from 0): position is nan");
    assert_refused(particle_file("bad.csv", "x,y,z\n1,2\0,3\n", 14), SSFR_ERR_FORMAT, "column 2 (y): expected");
}

static void more_columns_than_supported_are_refused(void **state)
{
    (void)state;
    bytes b = {0};
    for (int i = 0; i < 1024; i++) put_text(&b, "c%d,", i);
    put_text(&b, "x,y,z\n");
    assert_refused(particle_file("wide.csv", b.data, b.n), SSFR_ERR_UNSUPPORTED, "wide.csv: more than 1024 columns");
}

static void a_written_table_says_names_and_units(void **state)
{
    (void)state;
    static const char expected[] =
        "x [m],y [m],z [m],radius [m],velocity_x [m/s],velocity_y [m/s],velocity_z [m/s],density [kg/m^3],"
        "lifetime [s],initial_lifetime [s],age [s],neighbours,id,kind\n"
        "0.5,2.3849999999999998,-1000000.0009765625,"
        "0.25,0.100000001,-0,1.40129846e-45,998.5,4,5.5,1.5,31,4294967295,0\n";
    const double at[] = {0.5, 2.385, -1000000.0009765625};
    float velocity[] = {0.1f, -0.0f, 1e-45f}, density[] = {998.5f}, life[] = {4}, initial[] = {5.5f}, age[] = {1.5f};
    uint32_t neighbours[] = {31}, id[] = {4294967295u}, kind[] = {0};
    ssfr_particles *p = NULL;
    char *text = NULL;
    size_t n = 0;
    const ssfr_particles given = {.velocity = velocity, .density = density, .lifetime = life,
                                  .initial_lifetime = initial, .age = age, .neighbours = neighbours, .id = id,
                                  .kind = kind, .radius = 0.25};
    assert_int_equal(ssfr_particles_create(&p, 1, at, &given), SSFR_OK);
    assert_int_equal(ssfr_particles_save(p, test_path("written.csv")), SSFR_OK);
    assert_int_equal(ssfr_read_file(test_path("written.csv"), SSFR_READ_MAX, &text, &n), SSFR_OK);
    assert_string_equal(text, expected);
    free(text);
    ssfr_particles_destroy(&p);
}

/* ---- .xyz -------------------------------------------------------------------------------------------------------- */

static void check_two_xyz(const char *text)
{
    ssfr_particles *p = load(text_file("two.xyz", text));
    assert_int_equal(p->n, 2);
    find_particle(p, 0, 2.385, -1);
    find_particle(p, 1, 0.5, 2.25);
    ssfr_particles_destroy(&p);
}

static void bare_lines_and_chemistry_are_read(void **state)
{
    (void)state;
    check_two_xyz("0 2.385 -1\n1 0.5 2.25\n");
    check_two_xyz("\n0\t2.385  -1\r\n   1 0.5 2.25");
    check_two_xyz("# x y z\n// made by hand\n0 2.385 -1\n1 0.5 2.25\n\n");
    check_two_xyz("0 2.385 -1 255 0 0\n1 0.5 2.25 0 128 0\n");
    check_two_xyz("H 0 2.385 -1\nNe 1 0.5 2.25\n");
    check_two_xyz("2\n\nH 0 2.385 -1\nNe 1 0.5 2.25\n");
    check_two_xyz("  2  \nwater, step 7\n0 2.385 -1\n1 0.5 2.25\n\n");
    check_two_xyz("2\r\n2 3 4\r\n1 0 2.385 -1 9\r\n2 1 0.5 2.25 9\r\n");
    check_two_xyz("2\nLattice=\"5 0 0 0 5 0 0 0 5\" Properties=species:S:1:pos:R:3 Time=2.385\n"
                  "O 0 2.385 -1\nO 1 0.5 2.25\n");
    check_two_xyz("2\nProperties=\"tag:I:2:pos:R:3\"\n7 8 0 2.385 -1\n7 8 1 0.5 2.25\n");
    check_two_xyz("2\nProperties=z:R:1:fixed:L:1:x:R:1:y:R:1\n-1 T 0 2.385\n2.25 F 1 0.5\n");
}

static void extended_columns_are_read(void **state)
{
    (void)state;
    ssfr_particles *p = load(text_file(
        "all.xyz", "2\nProperties=species:S:1:pos:R:3:id:I:1:velo:R:3:radius:R:1:forces:R:3:density:S:1\n"
                   "Ar 0 2.385 -1 17 0.25 0.5 -0.75 0.125 9 9 9 thick\nAr 1 0.5 2.25 18 1 2 3 0.125 9 9 9 thin\n"));
    const size_t i = find_particle(p, 0, 2.385, -1);
    assert_true(p->id[i] == 17 && p->velocity[3 * i] == 0.25f && p->velocity[3 * i + 2] == -0.75f);
    assert_true(p->radius == 0.125);
    assert_null(p->density);
    ssfr_particles_destroy(&p);
}

static void no_particles_are_a_count_of_0(void **state)
{
    (void)state;
    static const char *const texts[] = {"0\n\n", "0", "0\nnothing here\n\n", "0\nProperties=pos:R:3:id:I:1"};
    for (size_t i = 0; i < SSFR_COUNT(texts); i++) {
        ssfr_particles *p = load(text_file("none.xyz", texts[i]));
        assert_int_equal(p->n, 0);
        assert_int_equal(p->id != NULL, i == 3);
        ssfr_particles_destroy(&p);
    }
}

static void bad_xyz_files_are_refused_with_the_line(void **state)
{
    (void)state;
    static const struct {
        const char *text, *says;
        ssfr_result code;
    } cases[] = {
        {"# only this\n", "bad.xyz: there are no particles, nor a count of 0", SSFR_ERR_FORMAT},
        {"1 2\n", "bad.xyz: the particles lack x, y or z", SSFR_ERR_FORMAT},
        {"H 1 2\n", "lack x, y or z", SSFR_ERR_FORMAT},
        {"2.5\n\nH 1 2 3\n", "lack x, y or z", SSFR_ERR_FORMAT},
        {"1 2 3\n4 5\n", "bad.xyz:2: the line ends after column 2 of 3", SSFR_ERR_FORMAT},
        {"1 2 3\n\n4 5 6 7\n", "bad.xyz:3: the line goes on after its 3 columns", SSFR_ERR_FORMAT},
        {"1 2 3\n4 five 6\n", "bad.xyz:2: column 2 (position): expected a number, found \"five\"", SSFR_ERR_FORMAT},
        {"1 2 3\n# 5 6\n", "bad.xyz:2: column 1 (position): expected a number, found \"#\"", SSFR_ERR_FORMAT},
        {"3\n\nH 1 2 3\nH 4 5 6\n", "bad.xyz:5: the file ends after 2 of 3 particles", SSFR_ERR_FORMAT},
        {"3\n", "bad.xyz: 3 particles are announced, but 0 bytes follow", SSFR_ERR_FORMAT},
        {"1\n\nH 1 2 3\n1\n\nH 4 5 6\n", "bad.xyz:4: the file goes on after its 1 particles", SSFR_ERR_UNSUPPORTED},
        {"0\n\nH 1 2 3\n", "bad.xyz:3: the file goes on after its 0 particles", SSFR_ERR_UNSUPPORTED},
        {"9999999999999999999\n\nH 1 2 3\n", "9999999999999999999 particles are announced, but 8", SSFR_ERR_FORMAT},
        {"99999999999999999999\n\nH 1 2 3\n", "lack x, y or z", SSFR_ERR_FORMAT},
        {"1\nProperties=pos:R\nH 1 2 3\n", "bad.xyz:2: Properties: expected name:type:count, found \"pos\"",
         SSFR_ERR_FORMAT},
        {"1\nProperties=pos:R:three\n1 2 3\n", "Properties: expected name:type:count", SSFR_ERR_FORMAT},
        {"1\nProperties=pos:Real:3\n1 2 3\n", "Properties: expected name:type:count", SSFR_ERR_FORMAT},
        {"1\nProperties=pos:R:2\n1 2\n", "lack x, y or z", SSFR_ERR_FORMAT},
        {"1\nProperties=pos:R:3:pos:R:3\n1 2 3 4 5 6\n", "two columns for what pos says", SSFR_ERR_FORMAT},
        {"1\nProperties=pos:R:3:v:R:3:vx:R:1\n1 2 3 4 5 6 7\n", "two columns for what vx says", SSFR_ERR_FORMAT},
        {"1\nProperties=pos:R:9999\n1 2 3\n", "bad.xyz: more than 1024 columns", SSFR_ERR_UNSUPPORTED},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++)
        assert_refused(text_file("bad.xyz", cases[i].text), cases[i].code, cases[i].says);
}

/* ---- both -------------------------------------------------------------------------------------------------------- */

static void a_file_cut_anywhere_or_damaged_never_harms(void **state)
{
    (void)state;
    static const char *const texts[][2] = {
        {"cut.csv", "x,y,z,id,note,radius\r\n0,2.385,-1,7,\"a \"\"b\"\"\n\",0.5\r\n1,0.5,2.25,8,c,0.5\r\n"},
        {"blanks.csv", "# x \"y [m]\" z vx vy vz\n0 2.385 -1 1 2 3\n 1 0.5 2.25 4 5 6\n"},
        {"bare.xyz", "# x\n0 2.385 -1\n1 0.5 2.25\n"},
        {"cut.xyz", "2\nProperties=species:S:1:pos:R:3:id:I:1 t=1\nO 0 2.385 -1 7\nO 1 0.5 2.25 8\n"},
    };
    for (size_t i = 0; i < SSFR_COUNT(texts); i++) {
        check_truncations(texts[i][0], texts[i][1], strlen(texts[i][1]));
        check_damage(texts[i][0], texts[i][1], strlen(texts[i][1]));
    }
}

static void what_is_no_file_is_refused(void **state)
{
    (void)state;
    check_no_files(".csv");
    check_no_files(".xyz");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(separators_quotes_and_line_ends_are_found_out),
        cmocka_unit_test(names_of_many_programs_are_known),
        cmocka_unit_test(every_array_is_read_by_its_names),
        cmocka_unit_test(other_columns_are_skipped_and_told),
        cmocka_unit_test(a_radius_is_a_column_of_one_value),
        cmocka_unit_test(a_table_without_rows_is_no_particles),
        cmocka_unit_test(bad_names_are_refused),
        cmocka_unit_test(a_bad_row_is_refused_with_line_and_column),
        cmocka_unit_test(more_columns_than_supported_are_refused),
        cmocka_unit_test(a_written_table_says_names_and_units),
        cmocka_unit_test(bare_lines_and_chemistry_are_read),
        cmocka_unit_test(extended_columns_are_read),
        cmocka_unit_test(no_particles_are_a_count_of_0),
        cmocka_unit_test(bad_xyz_files_are_refused_with_the_line),
        cmocka_unit_test(a_file_cut_anywhere_or_damaged_never_harms),
        cmocka_unit_test(what_is_no_file_is_refused),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}
