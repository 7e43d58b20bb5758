/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_vtkxml.c: particles in VTK's XML files of every encoding, as VTK itself and as this test writes them; what must
 * be refused; what is written. */
#include "tests/particle_files.h"

#include <zlib.h>

/* ---- files in the making ----------------------------------------------------------------------------------------- */

typedef enum place { TEXT, INLINE, RAW, BASE64 } place; /* the last two: appended */

/* How a file says its numbers. */
typedef struct style {
    place place;
    bool deflated, big, wide; /* wide: headers of 8 bytes */
    ssfr_scalar type;         /* of all arrays */
    bool full;                /* deflated blocks: the last one may be full, which its size then does not say */
} style;

static const char *const type_names[] = {"Int8",   "UInt8", "Int16",  "UInt16",  "Int32",
                                         "UInt32", "Int64", "UInt64", "Float32", "Float64"};

typedef struct maker {
    style style;
    bytes file, appended;
} maker;

static void put_base64(bytes *out, const bytes *in)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < in->n; i += 3) {
        uint32_t bits = 0;
        for (size_t k = 0; k < 3; k++)
            bits = bits << 8 | (i + k < in->n ? (unsigned char)in->data[i + k] : 0);
        for (size_t k = 0; k < 4; k++)
            put_text(out, "%c", i + k > in->n ? '=' : digits[bits >> (18 - 6 * k) & 63]);
    }
}

static void put_bytes(bytes *out, const bytes *in)
{
    assert_true(out->n + in->n < sizeof out->data);
    memcpy(out->data + out->n, in->data, in->n);
    out->n += in->n;
}

static void put_header(const maker *m, bytes *b, double value)
{
    put_number(b, m->style.wide ? SSFR_UINT64 : SSFR_UINT32, m->style.big, value);
}

/* In blocks of 16 bytes. */
static void deflate_values(const maker *m, const bytes *values, bytes *header, bytes *data)
{
    enum { BLOCK = 16 };
    const size_t rest = values->n % BLOCK, n = (values->n + BLOCK - 1) / BLOCK;
    put_header(m, header, (double)n);
    put_header(m, header, BLOCK);
    put_header(m, header, (double)(rest || !m->style.full ? (rest ? rest : BLOCK) : 0));
    for (size_t at = 0; at < values->n; at += BLOCK) {
        uLongf size = sizeof data->data - data->n;
        const size_t part = values->n - at < BLOCK ? values->n - at : BLOCK;
        assert_int_equal(compress((Bytef *)data->data + data->n, &size, (const Bytef *)values->data + at, part), Z_OK);
        put_header(m, header, (double)size);
        data->n += size;
    }
}

/* The header and the values, as they stand where the style says. */
static bytes encode(const maker *m, const bytes *values)
{
    bytes header = {0}, data = {0}, out = {0};
    if (m->style.deflated) {
        deflate_values(m, values, &header, &data);
    } else {
        put_header(m, &data, (double)values->n);
        put_bytes(&data, values);
    }
    if (m->style.place == RAW) {
        put_bytes(&out, &header);
        put_bytes(&out, &data);
    } else {
        put_base64(&out, &header);
        put_base64(&out, &data);
    }
    return out;
}

/* An element with n values first, first + 1, ... */
static void put_array(maker *m, const char *name, int components, int first, int n)
{
    bytes values = {0};
    put_text(&m->file, "<DataArray type=\"%s\" Name=\"%s\"", type_names[m->style.type], name);
    if (components > 1) put_text(&m->file, " NumberOfComponents=\"%d\"", components);
    for (int k = 0; k < n; k++) put_number(&values, m->style.type, m->style.big, first + k);
    const bytes data = encode(m, &values);
    if (m->style.place >= RAW) {
        put_text(&m->file, " format=\"appended\" offset=\"%zu\"/>\n", m->appended.n);
        put_bytes(&m->appended, &data);
    } else {
        put_text(&m->file, " format=\"%s\">\n", m->style.place == TEXT ? "ascii" : "binary");
        for (int k = 0; k < n && m->style.place == TEXT; k++) put_text(&m->file, k % 4 ? "%d " : "%d\n", first + k);
        if (m->style.place == INLINE) put_bytes(&m->file, &data);
        put_text(&m->file, "</DataArray>\n");
    }
}

static void begin_file(maker *m, const char *dataset)
{
    put_text(&m->file, "<?xml version=\"1.0\"?>\n<VTKFile type=\"%s\" version=\"1.0\" byte_order=\"%s\"%s%s>\n<%s>\n",
             dataset, m->style.big ? "BigEndian" : "LittleEndian", m->style.wide ? " header_type=\"UInt64\"" : "",
             m->style.deflated ? " compressor=\"vtkZLibDataCompressor\"" : "", dataset);
}

static void end_file(maker *m, const char *dataset)
{
    put_text(&m->file, "</%s>\n", dataset);
    if (m->style.place >= RAW) {
        put_text(&m->file, "<AppendedData encoding=\"%s\">\n   _", m->style.place == RAW ? "raw" : "base64");
        put_bytes(&m->file, &m->appended);
        put_text(&m->file, "\n</AppendedData>\n");
    }
    put_text(&m->file, "</VTKFile>\n");
}

/* n particles from number `first` on: of number i the position is (3 i, 3 i + 1, 3 i + 2), the velocity 1 larger. */
static void put_piece(maker *m, int first, int n)
{
    put_text(&m->file, "<Piece NumberOfPoints=\"%d\" NumberOfVerts=\"0\">\n<PointData>\n", n);
    put_array(m, "v", 3, 3 * first + 1, 3 * n);
    put_array(m, "stress", 9, 0, 9 * n);
    put_array(m, "ids", 1, first, n);
    put_text(&m->file, "</PointData>\n<CellData>\n");
    put_array(m, "density", 1, 7, 1);
    put_text(&m->file, "</CellData>\n<Points>\n");
    put_array(m, "Points", 3, 3 * first, 3 * n);
    put_text(&m->file, "</Points>\n</Piece>\n");
}

static bytes make_file(style style, const char *dataset, bool two)
{
    maker m = {.style = style};
    begin_file(&m, dataset);
    put_text(&m.file, "<FieldData>\n");
    put_array(&m, "Radius", 1, 2, 1);
    put_array(&m, "TimeValue", 1, 2, 1);
    put_text(&m.file, "</FieldData>\n");
    put_piece(&m, 0, two ? 2 : 5);
    if (two) put_piece(&m, 2, 3);
    end_file(&m, dataset);
    return m.file;
}

/* ---- reading ----------------------------------------------------------------------------------------------------- */

static void check_file(const char *name, const bytes *b)
{
    ssfr_particles *p = load(particle_file(name, b->data, b->n));
    assert_int_equal(p->n, 5);
    assert_true(p->radius == 2 && !p->density && !p->lifetime);
    for (int i = 0; i < 5; i++) {
        const size_t at = find_particle(p, 3 * i, 3 * i + 1, 3 * i + 2);
        assert_int_equal(p->id[at], i);
        for (int k = 0; k < 3; k++) assert_true(p->velocity[3 * at + (size_t)k] == (float)(3 * i + 1 + k));
    }
    ssfr_particles_destroy(&p);
}

static void every_encoding_gives_the_same_particles(void **state)
{
    (void)state;
    for (unsigned choice = 0; choice < 128; choice++) {
        const style s = {.place = (place)(choice & 3), .deflated = choice & 4, .big = choice & 8, .wide = choice & 16,
                         .full = choice & 32, .type = choice & 8 ? SSFR_FLOAT64 : SSFR_FLOAT32};
        const bytes b = make_file(s, choice & 1 ? "PolyData" : "UnstructuredGrid", choice & 64);
        check_file(choice & 1 ? "all.vtp" : "all.vtu", &b);
    }
}

static void every_type_gives_the_same_particles(void **state)
{
    (void)state;
    for (size_t t = 0; t < SSFR_COUNT(type_names); t++)
        for (unsigned choice = 0; choice < 4; choice++) {
            const style s = {.place = (place)choice, .deflated = choice == 1, .type = (ssfr_scalar)t};
            const bytes b = make_file(s, "PolyData", true);
            check_file("type.vtp", &b);
        }
}

/* As VTK 9.1 wrote it; two lines of blanks are cut. */
static const char vtk_inline[] =
    "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\" header_type=\"UInt32\" "
    "compressor=\"vtkZLibDataCompressor\">\n  <UnstructuredGrid>\n    <FieldData>\n      <DataArray type=\"Float64\" "
    "Name=\"radius\" NumberOfTuples=\"1\" format=\"binary\" RangeMin=\"0.0625\" RangeMax=\"0.0625\">\n"
    "        AQAAAAAEAAAIAAAADQAAAA==eF5jYACBDfYAAacA8A==\n      </DataArray>\n    </FieldData>\n"
    "    <Piece NumberOfPoints=\"3\" NumberOfCells=\"0\">\n      <PointData Scalars=\"density\" Vectors=\"velocity\">\n"
    "        <DataArray type=\"Float32\" Name=\"velocity\" NumberOfComponents=\"3\" format=\"binary\" "
    "RangeMin=\"0.125\" RangeMax=\"2.2395591083961146\">\n"
    "          AQAAAAAEAAAkAAAAHAAAAA==eF5jYACDBiC2A2J7IHM/hN0AZDMcALEBPecEOA==\n"
    "          <InformationKey name=\"L2_NORM_RANGE\" location=\"vtkDataArray\" length=\"2\">\n"
    "            <Value index=\"0\">\n              0.125\n            </Value>\n"
    "            <Value index=\"1\">\n              2.2395591084\n            </Value>\n          </InformationKey>\n"
    "        </DataArray>\n        <DataArray type=\"Float64\" Name=\"density\" format=\"binary\" RangeMin=\"1000\" "
    "RangeMax=\"1002\">\n          AQAAAAAEAAAYAAAAFgAAAA==eF5jYAACh34HEMXgAaUD+h0AIGIDRg==\n        </DataArray>\n"
    "        <DataArray type=\"Int64\" IdType=\"1\" Name=\"id\" format=\"binary\" RangeMin=\"0\" RangeMax=\"2\">\n"
    "          AQAAAAAEAAAYAAAAEAAAAA==eF5jYIAARijNBKUBADgABA==\n        </DataArray>\n"
    "        <DataArray type=\"Int32\" Name=\"kind\" format=\"binary\" RangeMin=\"0\" RangeMax=\"2\">\n"
    "          AQAAAAAEAAAMAAAAEQAAAA==eF5jYGBgYARiJiAGAAAcAAQ=\n        </DataArray>\n      </PointData>\n"
    "      <CellData>\n      </CellData>\n      <Points>\n        <DataArray type=\"Float64\" Name=\"Points\" "
    "NumberOfComponents=\"3\" format=\"binary\" RangeMin=\"0\" RangeMax=\"0.5\">\n"
    "          AQAAAAAEAABIAAAAEwAAAA==eF5jYMAHLthjF3+AIQ4AQG4CLw==\n"
    "          <InformationKey name=\"L2_NORM_RANGE\" location=\"vtkDataArray\" length=\"2\">\n"
    "            <Value index=\"0\">\n              0\n            </Value>\n"
    "            <Value index=\"1\">\n              0.5\n            </Value>\n          </InformationKey>\n"
    "        </DataArray>\n      </Points>\n      <Cells>\n        <DataArray type=\"Int64\" Name=\"connectivity\" "
    "format=\"binary\" RangeMin=\"1e+299\" RangeMax=\"-1e+299\">\n          AAAAAAAEAAAAAAAA\n        </DataArray>\n"
    "      </Cells>\n    </Piece>\n  </UnstructuredGrid>\n</VTKFile>\n";

static const char vtk_appended[] =
    "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"BigEndian\" "
    "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n  <PolyData>\n    <FieldData>\n"
    "      <DataArray type=\"Float64\" Name=\"radius\" NumberOfTuples=\"1\" format=\"appended\" RangeMin=\"0.0625\" "
    "RangeMax=\"0.0625\" offset=\"0\"                   >\n      </DataArray>\n    </FieldData>\n"
    "    <Piece NumberOfPoints=\"3\"                    NumberOfVerts=\"0\"                   >\n"
    "      <PointData Scalars=\"density\" Vectors=\"velocity\">\n        <DataArray type=\"Float32\" "
    "Name=\"velocity\" NumberOfComponents=\"3\" format=\"appended\" RangeMin=\"0.125\" RangeMax=\"2.2395591084\" "
    "offset=\"60\"                  >\n"
    "          <InformationKey name=\"L2_NORM_RANGE\" location=\"vtkDataArray\" length=\"2\">\n"
    "            <Value index=\"0\">\n              0.125\n            </Value>\n"
    "            <Value index=\"1\">\n              2.2395591084\n            </Value>\n          </InformationKey>\n"
    "        </DataArray>\n        <DataArray type=\"Float64\" Name=\"density\" format=\"appended\" "
    "RangeMin=\"1000\" RangeMax=\"1002\" offset=\"144\"                 >\n        </DataArray>\n"
    "        <DataArray type=\"Int64\" IdType=\"1\" Name=\"id\" format=\"appended\" offset=\"216\"                 >\n"
    "        </DataArray>\n        <DataArray type=\"Int32\" Name=\"kind\" format=\"appended\" offset=\"280\" />\n"
    "      </PointData>\n      <CellData>\n      </CellData>\n      <Points>\n        <DataArray type=\"Float32\" "
    "Name=\"Points\" NumberOfComponents=\"3\" format=\"appended\" RangeMin=\"0\" RangeMax=\"0.5\" "
    "offset=\"344\"                 >\n        </DataArray>\n      </Points>\n    </Piece>\n  </PolyData>\n"
    "  <AppendedData encoding=\"base64\">\n   _AAAAAAAAAAEAAAAAAAAEAAAAAAAAAAAIAAAAAAAAAAw=eF6z38AABgAG0ADwAAAAAAAAAAE"
    "AAAAAAAAEAAAAAAAAAAAkAAAAAAAAABw=eF5jYGBgaABiOyC2B+L9DVA2kD4AFQcASIwEOA==AAAAAAAAAAEAAAAAAAAEAAAAAAAAAAAYAAAA"
    "AAAAABQ=eF5z6HdgAAGHfg8oHQCmATCLA0Y=AAAAAAAAAAEAAAAAAAAEAAAAAAAAAAAYAAAAAAAAAA8=eF5jYEABjFCaCQAAIwAEAAAAAAAA"
    "AAEAAAAAAAAEAAAAAAAAAAAMAAAAAAAAAA8=eF5jYAADRiBmAgAAEwAEAAAAAAAAAAEAAAAAAAAEAAAAAAAAAAAkAAAAAAAAABI=eF5jYEAA"
    "uwYE2x5JHAAUaAD+\n  </AppendedData>\n</VTKFile>\n";

static void files_by_vtk_itself_are_read(void **state)
{
    (void)state;
    const struct {
        const char *name, *text;
    } files[] = {{"inline.vtu", vtk_inline}, {"appended.vtp", vtk_appended}};
    for (size_t f = 0; f < SSFR_COUNT(files); f++) {
        ssfr_particles *p = load(text_file(files[f].name, files[f].text));
        assert_int_equal(p->n, 3);
        assert_true(p->radius == 0.0625);
        for (uint32_t i = 0; i < 3; i++) {
            const size_t at = find_particle(p, 0.25 * i, 0, 0);
            assert_true(p->id[at] == i && p->kind[at] == i && p->density[at] == (float)(1000 + i));
            assert_true(p->velocity[3 * at] == 0.5f * (float)i && p->velocity[3 * at + 1] == -(float)i);
            assert_true(p->velocity[3 * at + 2] == 0.125f);
        }
        ssfr_particles_destroy(&p);
    }
}

/* A file of text with so many points, and what stands in their Piece. */
static const char *xml(int n, const char *inside)
{
    bytes b = {0};
    put_text(&b, "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"%d\">\n", n);
    put_text(&b, "%s\n</Piece></PolyData></VTKFile>", inside);
    return particle_file("text.vtp", b.data, b.n);
}

#define ARRAY(type, name, n, values) \
    "<DataArray type=\"" type "\" Name=\"" name "\" NumberOfComponents=\"" n "\">" values "</DataArray>"
#define TWO "<Points>" ARRAY("Float32", "Points", "3", "0 0 0 2.5 0 0") "</Points>"
#define OTHERS "<Points>" ARRAY("Float32", "Points", "3", "0 2.5 0 2.5 2.5 0") "</Points>"

static void elements_among_the_values_and_sections_in_any_order_are_read(void **state)
{
    (void)state;
    ssfr_particles *p = load(xml(2, "<Other><DataArray/></Other><PointData>"
        "<DataArray type=\"Float32\" Name=\"rho\"> <InformationKey> 7 </InformationKey> <InformationKey/> 1 2 "
        "</DataArray>"
        "<DataArray Name=\"other\"><InformationKey>3</InformationKey></DataArray>"
        "<Array type=\"String\" Name=\"id\">65 0 66</Array>"
        "<DataArray type=\"Int8\" Name=\"kind\">1 2<InformationKey/></DataArray></PointData>" TWO));
    const size_t at = find_particle(p, 2.5, 0, 0);
    assert_true(p->density[at] == 2 && p->kind[at] == 2 && !p->id);
    assert_close(p->radius, 1.25, 1e-9, 0);
    ssfr_particles_destroy(&p);
}

static void files_without_points_are_files(void **state)
{
    (void)state;
    ssfr_particles *p = load(xml(0, ""));
    assert_int_equal(p->n, 0);
    ssfr_particles_destroy(&p);
    p = load(text_file("none.vtp", "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"0\"><Points>"
                                   "<DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"appended\" "
                                   "offset=\"0\"/></Points></Piece></PolyData><AppendedData encoding=\"raw\">_"));
    assert_int_equal(p->n, 0);
    ssfr_particles_destroy(&p);
}

static void radii_of_the_points_count_when_all_are_the_same(void **state)
{
    static const struct {
        const char *text, *says;
        double radius;
    } cases[] = {
        {TWO "<PointData>" ARRAY("Float64", "Radius", "1", "0.25 0.25") "</PointData>", "", 0.25},
        {TWO "<PointData>" ARRAY("Float64", "radius", "1", "0.25 0.125") "</PointData>",
         "text.vtp: the particles have radii from 0.125 to 0.25 m, none for all", 0},
        {"<FieldData>" ARRAY("Int8", "radius", "1", "2") "</FieldData>" TWO
         "<PointData>" ARRAY("Float64", "radius", "1", "0.25 0.25") "</PointData>", "", 2},
        {TWO "<PointData>" ARRAY("Float64", "radius", "1", "0.25 0.25") ARRAY("Int8", "heat", "1", "1 2")
         "</PointData></Piece><Piece NumberOfPoints=\"2\">" OTHERS "<PointData>" ARRAY("Int8", "heat", "1", "1 2")
         "</PointData>", "text.vtp: radius skipped: not every Piece has it\n", 0},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        ssfr_particles *p = load_and_listen(state, xml(2, cases[i].text));
        const double estimate = ssfr_particles_spacing(p);
        assert_true(p->radius == (cases[i].radius > 0 ? cases[i].radius : estimate));
        assert_non_null(strstr(told, cases[i].says));
        assert_int_equal(strstr(told, ": not read: \"heat\"\n") != NULL, i == 3);
        ssfr_particles_destroy(&p);
    }
}

static void arrays_of_another_shape_are_skipped_with_a_warning(void **state)
{
    static const struct {
        const char *text, *says;
    } cases[] = {
        {"<PointData>" ARRAY("Float32", "v", "2", "1 2 3 4") "</PointData>",
         "text.vtp:2: velocity skipped: expected one array of numbers, 3 a point"},
        {"<PointData>\n" ARRAY("String", "kind", "1", "65 66") "</PointData>",
         "text.vtp:3: kind skipped: expected one array of numbers, 1 a point"},
        {"<PointData>" ARRAY("Int8", "id", "1", "1 2") ARRAY("Int8", "ids", "1", "1 2") "</PointData>", "id skipped"},
        {"<FieldData>" ARRAY("Int8", "radius", "2", "1 2") "</FieldData>", "radius skipped: expected one array"},
        {"</Piece><Piece NumberOfPoints=\"2\">" OTHERS "<PointData>" ARRAY("Int8", "id", "1", "1 2") "</PointData>",
         "text.vtp: id skipped: not every Piece has it"},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++) {
        bytes b = {0};
        put_text(&b, "%s%s", cases[i].text, i == 4 ? "" : TWO);
        bytes whole = {0};
        put_text(&whole, "%s%.*s", i == 4 ? TWO : "", (int)b.n, b.data);
        whole.data[whole.n] = '\0';
        ssfr_particles *p = load_and_listen(state, xml(2, whole.data));
        assert_non_null(strstr(told, cases[i].says));
        assert_true(!p->velocity && !p->kind && (i == 2) == (p->id != NULL));
        assert_int_equal(p->n, i == 4 ? 4 : 2);
        ssfr_particles_destroy(&p);
    }
}

/* ---- what is refused --------------------------------------------------------------------------------------------- */

static void files_of_another_kind_are_refused_with_their_line(void **state)
{
    (void)state;
    static const struct {
        const char *text, *says;
        ssfr_result code;
    } cases[] = {
        {"x y z\n", "bad.vtp:1: syntax error", SSFR_ERR_FORMAT},
        {"<VTKFile type=\"PolyData\">\n</VTKfile>", "bad.vtp:2: mismatched tag", SSFR_ERR_FORMAT},
        {"<VTKFile type=\"PolyData\">\n", "bad.vtp:2: no element found", SSFR_ERR_FORMAT},
        {"<html/>", "bad.vtp:1: expected VTKFile, found \"html\"", SSFR_ERR_FORMAT},
        {"<VTKFile/>", "bad.vtp:1: type : only PolyData and UnstructuredGrid are read", SSFR_ERR_UNSUPPORTED},
        {"\n<VTKFile type=\"ImageData\"/>", "bad.vtp:2: type ImageData: only", SSFR_ERR_UNSUPPORTED},
        {"<VTKFile type=\"PolyData\" byte_order=\"Middle\"/>", "expected LittleEndian or BigEndian, found \"Middle\"",
         SSFR_ERR_FORMAT},
        {"<VTKFile type=\"PolyData\" header_type=\"Int32\"/>", "expected UInt32 or UInt64, found \"Int32\"",
         SSFR_ERR_FORMAT},
        {"<VTKFile type=\"PolyData\" compressor=\"vtkLZ4DataCompressor\"/>",
         "bad.vtp:1: compressor vtkLZ4DataCompressor: only vtkZLibDataCompressor is read", SSFR_ERR_UNSUPPORTED},
        {"<VTKFile type=\"PolyData\" compressor=\"vtkLZMADataCompressor\"/>", "compressor vtkLZMADataCompressor: only",
         SSFR_ERR_UNSUPPORTED},
        {"<!DOCTYPE VTKFile [<!ENTITY a \"b\">]>\n<VTKFile type=\"PolyData\"/>", "bad.vtp:1: a document type",
         SSFR_ERR_UNSUPPORTED},
        {"<VTKFile type=\"PolyData\"><UnstructuredGrid/></VTKFile>",
         "expected PolyData, found \"UnstructuredGrid\"", SSFR_ERR_FORMAT},
        {"<VTKFile type=\"PolyData\"/>", "bad.vtp: there is no Piece", SSFR_ERR_FORMAT},
        {"<VTKFile type=\"PolyData\"><PolyData><Piece/></PolyData></VTKFile>",
         "expected NumberOfPoints, found \"\"", SSFR_ERR_FORMAT},
        {"<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"-2\"/></PolyData></VTKFile>",
         "expected NumberOfPoints, found \"-2\"", SSFR_ERR_FORMAT},
        {"<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"2\"/></PolyData></VTKFile>",
         "bad.vtp: a Piece of 2 points has no Points", SSFR_ERR_FORMAT},
        {"<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"2385\"/></PolyData></VTKFile>",
         "bad.vtp: Pieces of 2385 points and more do not fit into a file of 86 bytes", SSFR_ERR_FORMAT},
        {"<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"9\"/><Piece NumberOfPoints=\"2385\"/>"
         "</PolyData></VTKFile>", "Pieces of 2385 points and more do not fit", SSFR_ERR_FORMAT},
        {"<VTKFile type=\"PolyData\"><AppendedData encoding=\"hex\">_</AppendedData></VTKFile>",
         "expected raw or base64, found \"hex\"", SSFR_ERR_FORMAT},
        {"<VTKFile type=\"PolyData\"><AppendedData> data</AppendedData></VTKFile>",
         "expected an underscore before the appended data, found \"data</AppendedData></VTKFile>\"", SSFR_ERR_FORMAT},
        {"<VTKFile type=\"PolyData\"><AppendedData>", "expected an underscore before the appended data, found \"\"",
         SSFR_ERR_FORMAT},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++)
        check_refused(text_file("bad.vtp", cases[i].text), cases[i].code, cases[i].says);
}

#define ONE(attributes, values) "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" " attributes ">" values \
                                "</DataArray></Points>"

static void arrays_that_cannot_be_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text, *says;
    } cases[] = {
        {"<Points>" ARRAY("Float32", "Points", "2", "0 0") "</Points>",
         "text.vtp:2: expected one array Points of numbers, 3 a point"},
        {TWO "\n" TWO, "text.vtp:3: expected one array Points of numbers"},
        {"<Points>" ARRAY("Float16", "Points", "3", "0 0 0") "</Points>", "expected one array Points of numbers"},
        {"<Points>" ARRAY("Float32", "Points", "many", "") "</Points>", "expected NumberOfComponents, found \"many\""},
        {ONE("format=\"text\"", "0 0 0"), "expected ascii, binary or appended, found \"text\""},
        {ONE("format=\"appended\"", ""), "text.vtp:2: expected an offset, found \"\""},
        {ONE("format=\"appended\" offset=\"-1\"", ""), "expected an offset, found \"-1\""},
        {ONE("format=\"appended\" offset=\"0\"", ""),
         "Points: expected 3 values: its offset is beyond the appended data"},
        {ONE("", "1 2"), "text.vtp:2: Points: expected 3 values, there are 2, then none"},
        {ONE("", "1 2 three"), "Points: expected 3 values, there are 2, then found \"three</DataArray></Points>\""},
        {ONE("", ""), "Points: expected 3 values, there are 0, then none"},
        {ONE("", "1 <![CDATA[2 3]]>"), "Points: expected 3 values, there are 1, then found"},
        {ONE("", "0 0 0") "<PointData>" ARRAY("Int8", "id", "1", "-1") "</PointData>",
         "text.vtp: particle 0 (from 0): id is -1, expected a whole number"},
        {ONE("", "0 0 0") "<FieldData>" ARRAY("Int8", "radius", "1", "r") "</FieldData>",
         "radius: expected 1 values: there is none"},
        {ONE("format=\"binary\"", ""), "text.vtp:2: Points: expected 3 values: the data end"},
        {ONE("format=\"binary\"", "DAAA"), "Points: expected 3 values: the data end"},
        {ONE("format=\"binary\"", "CAAAAAAAAAAAAAAAAAAAAA=="), "expected 3 values: there is another number of bytes"},
        {ONE("format=\"binary\"", "DAAAAAAAAAAAAAAAAAAA"), "Points: expected 3 values: the data end"},
        {ONE("format=\"binary\"", "DAAAAAAAAAAAAAAA?AAAAA=="), "Points: expected 3 values: the data end"},
        {ONE("format=\"binary\"", "DAAAAAAAAAAAAA=AAAAAAAA="), "Points: expected 3 values: the data end"},
        {ONE("format=\"binary\"", "DAAAA=AAAAAAAAAAAAAAAA=="), "Points: expected 3 values: the data end"},
    };
    for (size_t i = 0; i < SSFR_COUNT(cases); i++)
        check_refused(xml(1, cases[i].text), SSFR_ERR_FORMAT, cases[i].says);
}

/* One particle whose deflated coordinates follow the header words given. */
static const char *deflated(int n_words, const uint32_t *words, bool damaged)
{
    static const unsigned char zeros[12] = {0};
    bytes b = {0};
    unsigned char data[64];
    uLongf size = sizeof data;
    assert_int_equal(compress(data, &size, zeros, sizeof zeros), Z_OK);
    if (damaged) data[2] ^= 0xff;
    put_text(&b, "<VTKFile type=\"PolyData\" compressor=\"vtkZLibDataCompressor\"><PolyData>"
                 "<Piece NumberOfPoints=\"1\">\n" ONE("format=\"appended\" offset=\"0\"", "")
                 "</Piece></PolyData>\n<AppendedData encoding=\"raw\">_");
    for (int i = 0; i < n_words; i++) put_number(&b, SSFR_UINT32, false, words[i] == 99 ? (double)size : words[i]);
    for (size_t i = 0; i < size; i++) put_number(&b, SSFR_UINT8, false, data[i]);
    return particle_file("deflated.vtp", b.data, b.n);
}

static void deflated_blocks_that_do_not_fit_are_refused(void **state)
{
    (void)state;
    static const struct {
        int n;
        uint32_t words[5]; /* 99 stands for the data's true size */
        const char *says;
    } cases[] = {
        {0, {0}, "Points: expected 3 values: the data end"},
        {4, {0, 12, 0, 99}, "the deflated blocks have another size"},
        {4, {0, 12, 12, 99}, "the deflated blocks have another size"},
        {4, {1, 16, 0, 99}, "the deflated blocks have another size"},
        {4, {1, 12, 8, 99}, "the deflated blocks have another size"},
        {4, {1, 12, 16, 99}, "the deflated blocks have another size"},
        {4, {2, 12, 0, 99}, "the deflated blocks have another size"},
        {5, {2, 12, 12, 99, 0}, "the deflated blocks have another size"},
        {4, {3, 4294967295, 12, 99}, "the deflated blocks have another size"},
        {4, {4294967295, 12, 0, 99}, "the deflated blocks have another size"},
        {4, {1, 12, 0, 4294967295}, "Points: expected 3 values: the data end"},
        {4, {1, 12, 0, 3}, "Points: expected 3 values: the deflated data are damaged"},
        {5, {2, 4, 8, 99, 0}, "Points: expected 3 values: the deflated data are damaged"},
    };
    const uint32_t good[] = {1, 12, 0, 99}, last[] = {1, 4096, 12, 99};
    for (size_t i = 0; i < SSFR_COUNT(cases); i++)
        check_refused(deflated(cases[i].n, cases[i].words, false), SSFR_ERR_FORMAT, cases[i].says);
    check_refused(deflated(4, good, true), SSFR_ERR_FORMAT, "the deflated data are damaged");
    check_refused(deflated(4, good, false), SSFR_ERR_VALUE, "say the radius");
    check_refused(deflated(4, last, false), SSFR_ERR_VALUE, "say the radius");
}

/* Ninety thousand points of one short block are refused before there is memory for their values. */
static void values_that_no_deflated_data_make_are_refused(void **state)
{
    (void)state;
    bytes b = {0};
    put_text(&b, "<VTKFile type=\"PolyData\" compressor=\"vtkZLibDataCompressor\"><PolyData>"
                 "<Piece NumberOfPoints=\"90000\">" ONE("format=\"appended\" offset=\"0\"", "")
                 "</Piece></PolyData><AppendedData encoding=\"raw\">_");
    const uint32_t words[] = {1, 1080000, 0, 4, 0};
    for (size_t i = 0; i < SSFR_COUNT(words); i++) put_number(&b, SSFR_UINT32, false, words[i]);
    check_refused(particle_file("bomb.vtp", b.data, b.n), SSFR_ERR_FORMAT,
                  "Points: expected 270000 values: no deflated data make so many");
}

static void a_file_cut_anywhere_or_damaged_never_harms(void **state)
{
    (void)state;
    static const style styles[] = {{.place = TEXT, .type = SSFR_INT8},
                                   {.place = INLINE, .deflated = true, .type = SSFR_FLOAT32},
                                   {.place = RAW, .wide = true, .type = SSFR_FLOAT32},
                                   {.place = RAW, .deflated = true, .big = true, .type = SSFR_INT16}};
    for (size_t s = 0; s < SSFR_COUNT(styles); s++) {
        maker m = {.style = styles[s]};
        begin_file(&m, "PolyData");
        put_text(&m.file, "<Piece NumberOfPoints=\"2\"><PointData>");
        put_array(&m, "id", 1, 0, 2);
        put_text(&m.file, "</PointData><Points>");
        put_array(&m, "Points", 3, 0, 6);
        put_text(&m.file, "</Points></Piece>");
        end_file(&m, "PolyData");
        check_damage("damaged.vtp", m.file.data, m.file.n);
        check_truncations("cut.vtp", m.file.data, m.file.n);
    }
}

static void what_is_no_file_is_refused(void **state)
{
    (void)state;
    check_no_files(".vtp");
    check_no_files(".vtu");
}

/* ---- writing ----------------------------------------------------------------------------------------------------- */

static void assert_same(const ssfr_particles *a, const ssfr_particles *b)
{
    assert_int_equal(a->n, b->n);
    assert_true(a->radius == b->radius);
    assert_memory_equal(a->position, b->position, 3 * a->n * sizeof *a->position);
    for (size_t p = 0; p < a->n_packets; p++)
        for (int k = 0; k < 3; k++) assert_true(a->packets[p].centre[k] == b->packets[p].centre[k]);
    for (const ssfr_array *k = ssfr_arrays; k < ssfr_arrays + SSFR_N_ARRAYS; k++) {
        const void *values = ssfr_array_get(a, k), *others = ssfr_array_get(b, k);
        assert_int_equal(values != NULL, others != NULL);
        if (values) assert_memory_equal(values, others, a->n * k->count * SSFR_ARRAY_VALUE);
    }
}

/* Particles with arrays whose bits are those of any number. */
static ssfr_particles *make_particles(size_t n, double centre, bool arrays)
{
    enum { MOST = 300 };
    static double positions[3 * MOST];
    static uint32_t values[SSFR_N_ARRAYS][3 * MOST];
    ssfr_particles given = {.radius = 0.02385}, *p = NULL;
    uint64_t seed = 5;
    for (size_t k = 0; k < 3 * n; k++) positions[k] = (double)(float)test_random(&seed, centre, centre + 2.385);
    for (size_t a = 0; a < SSFR_N_ARRAYS && arrays; a++) {
        for (size_t k = 0; k < 3 * n; k++) values[a][k] = (uint32_t)test_random(&seed, 0, 0x7f800000); /* < infinity */
        ssfr_array_set(&given, ssfr_arrays + a, values[a]);
    }
    assert_int_equal(ssfr_particles_create(&p, n, positions, &given), SSFR_OK);
    return p;
}

static void what_is_saved_is_loaded_to_the_last_bit(void **state)
{
    (void)state;
    const size_t counts[] = {0, 1, 64, 65, 300};
    for (size_t i = 0; i < SSFR_COUNT(counts); i++)
        for (unsigned choice = 0; choice < 4; choice++) {
            ssfr_particles *saved = make_particles(counts[i], choice & 1 ? 1e6 : 0, choice & 2), *loaded = NULL;
            test_clear_log();
            if (ssfr_particles_save(saved, test_path("saved.vtp")) != SSFR_OK) fail_msg("%s", test_last_error());
            loaded = load(test_path("saved.vtp"));
            assert_same(loaded, saved);
            ssfr_particles_destroy(&saved);
            ssfr_particles_destroy(&loaded);
        }
}

/* A million metres away floats are 1/16 m apart. */
static void positions_that_floats_would_change_are_written_as_doubles(void **state)
{
    (void)state;
    const double positions[] = {1e6, 0, 0.1, 1e6 + 0.02385, 0.25, 0};
    const ssfr_particles given = {.radius = 0.01};
    char *text = NULL;
    size_t size = 0;
    ssfr_particles *p = NULL;
    assert_int_equal(ssfr_particles_create(&p, 2, positions, &given), SSFR_OK);
    assert_int_equal(ssfr_particles_save(p, test_path("far.vtp")), SSFR_OK);
    ssfr_particles_destroy(&p);
    assert_int_equal(ssfr_read_file(test_path("far.vtp"), 1u << 20, &text, &size), SSFR_OK);
    assert_non_null(strstr(text, "<DataArray type=\"Float64\" Name=\"Points\""));
    free(text);
    p = load(test_path("far.vtp"));
    find_particle(p, 1e6, 0, 0.1);
    find_particle(p, 1e6 + 0.02385, 0.25, 0);
    ssfr_particles_destroy(&p);
}

static void written_files_have_a_vertex_for_each_point(void **state)
{
    (void)state;
    static const char verts[] = "<Verts>\n<DataArray type=\"Int64\" Name=\"connectivity\" NumberOfComponents=\"1\" "
                                "format=\"appended\" offset=\"32\"/>\n<DataArray type=\"Int64\" Name=\"offsets\" "
                                "NumberOfComponents=\"1\" format=\"appended\" offset=\"56\"/>\n</Verts>";
    const int64_t appended[] = {16, 0, 1, 16, 1, 2};
    char *text = NULL;
    size_t size = 0;
    ssfr_particles *p = make_particles(2, 0, false);
    assert_int_equal(ssfr_particles_save(p, test_path("verts.vtp")), SSFR_OK);
    assert_int_equal(ssfr_read_file(test_path("verts.vtp"), 1u << 20, &text, &size), SSFR_OK);
    assert_non_null(strstr(text, "<Piece NumberOfPoints=\"2\" NumberOfVerts=\"2\""));
    assert_non_null(strstr(text, verts));
    const char *data = strstr(text, "encoding=\"raw\">\n_");
    assert_non_null(data);
    bytes b = {0};
    for (size_t i = 0; i < SSFR_COUNT(appended); i++) put_number(&b, SSFR_INT64, false, (double)appended[i]);
    assert_memory_equal(strchr(data, '_') + 1 + 32, b.data, b.n);
    free(text);
    ssfr_particles_destroy(&p);
}

static void grids_are_not_written(void **state)
{
    (void)state;
    ssfr_particles *p = make_particles(2, 0, false);
    assert_fails(SSFR_ERR_UNSUPPORTED, ssfr_particles_save(p, test_path("a.vtu")), "a.vtu: .vtu files are read but");
    assert_fails(SSFR_ERR_IO, ssfr_particles_save(p, test_path("missing/a.vtp")), "a.vtp: cannot be written: No such");
    ssfr_particles_destroy(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_encoding_gives_the_same_particles),
        cmocka_unit_test(every_type_gives_the_same_particles),
        cmocka_unit_test(files_by_vtk_itself_are_read),
        cmocka_unit_test(elements_among_the_values_and_sections_in_any_order_are_read),
        cmocka_unit_test(files_without_points_are_files),
        cmocka_unit_test(radii_of_the_points_count_when_all_are_the_same),
        cmocka_unit_test(arrays_of_another_shape_are_skipped_with_a_warning),
        cmocka_unit_test(files_of_another_kind_are_refused_with_their_line),
        cmocka_unit_test(arrays_that_cannot_be_are_refused),
        cmocka_unit_test(deflated_blocks_that_do_not_fit_are_refused),
        cmocka_unit_test(values_that_no_deflated_data_make_are_refused),
        cmocka_unit_test(a_file_cut_anywhere_or_damaged_never_harms),
        cmocka_unit_test(what_is_no_file_is_refused),
        cmocka_unit_test(what_is_saved_is_loaded_to_the_last_bit),
        cmocka_unit_test(positions_that_floats_would_change_are_written_as_doubles),
        cmocka_unit_test(written_files_have_a_vertex_for_each_point),
        cmocka_unit_test(grids_are_not_written),
    };
    return cmocka_run_group_tests(tests, test_capture_log, NULL);
}
