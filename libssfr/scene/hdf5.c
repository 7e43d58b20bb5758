/* SPDX-License-Identifier: MIT */
/* hdf5.c: reads and writes ssfr's own particle files, and reads those of others by a map of their arrays.
 *
 *   /particles            attribute radius (m; absent when unknown)
 *   /particles/position   n x 3, float32 where that loses nothing, else float64
 *   /particles/velocity   n x 3, and so on for each line of SSFR_ATTRIBUTES that the set has: float32 or uint32
 *
 * A map ("position=/PartType0/Coordinates,id=/PartType0/ParticleIDs") says where a file by another program has them: as
 * numbers of any type. Vectors may be in parts ("x=/Step#0/x,y=/Step#0/y,z=/Step#0/z"). Only what it names is read.
 *
 * Each dataset has its unit as the attribute units. Chunked, shuffled, deflated; no times are stored, so the same
 * particles give the same bytes. */
#include "scene/sheet.h"
#include "scene/writer.h"

#include <errno.h>
#include <hdf5.h>
#include <pthread.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

enum { CHUNK = 16384, DEFLATE_LEVEL = 6 };

/* ---- living with the library ------------------------------------------------------------------------------------- */

/* HDF5 as distributed may be called by one thread at a time, and prints its errors unless told not to. */
static pthread_mutex_t one_at_a_time = PTHREAD_MUTEX_INITIALIZER;

typedef struct guard {
    H5E_auto2_t print;
    void *user;
} guard;

static guard enter(void)
{
    guard g = {0};
    pthread_mutex_lock(&one_at_a_time);
    H5Eget_auto2(H5E_DEFAULT, &g.print, &g.user);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    return g;
}

static void leave(guard g)
{
    H5Eset_auto2(H5E_DEFAULT, g.print, g.user);
    pthread_mutex_unlock(&one_at_a_time);
}

/* Closes a handle of any kind, if it was opened. Errors so far are kept, which HDF5 itself does not do. */
static bool drop(hid_t id)
{
    const hid_t errors = H5Eget_current_stack();
    const bool ok = id <= 0 || H5Idec_ref(id) >= 0;
    if (ok)
        H5Eset_current_stack(errors);
    else
        H5Eclose_stack(errors);
    return ok;
}

enum { WHY = 256 };

static herr_t keep_first(unsigned n, const H5E_error2_t *error, void *why)
{
    if (n == 0) snprintf(why, WHY, "%s", error->desc ? error->desc : "");
    return 0;
}

/* The error line for a call that HDF5 refused, with its own most specific words. */
static ssfr_result refused(ssfr_result code, const char *path, const char *what)
{
    char why[WHY] = "";
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first, why);
    for (char *c = why; *c; c++)
        if (*c < ' ' || *c > '~') *c = '?';
    return ssfr_fail(code, "%s: %s: %s", path, what, why);
}

/* ---- reading ----------------------------------------------------------------------------------------------------- */

/* Where in the file the places' numbers are, vectors whole or in parts; NULL where there are none. */
typedef struct map {
    char *text; /* the names, when they are not constant */
    const char *whole[SSFR_N_PLACES], *parts[SSFR_N_PLACES][3];
} map;

typedef struct source {
    ssfr_reading *reading;
    size_t size; /* of the file, bytes */
    hid_t group;
    map map;
} source;

/* Where in the map a name stands, NULL when it is none. */
static const char **find_entry(map *m, const char *name)
{
    const int place = ssfr_place_find(name);
    const ssfr_sheet_column column = ssfr_sheet_column_find(name);
    if (place != SSFR_PLACE_NONE) return m->whole + place;
    return column.place == SSFR_PLACE_NONE ? NULL : m->parts[column.place] + column.component;
}

/* An entry "name=path"; it is cut in two. */
static ssfr_result parse_entry(map *m, char *entry, const char *text)
{
    char *const path = strchr(entry, '=');
    if (path) *path = '\0';
    const char **const found = find_entry(m, entry);
    if (!path || !path[1])
        return ssfr_fail(SSFR_ERR_VALUE, "map '%s': expected name=path, found '%s'", text, entry);
    if (!found)
        return ssfr_fail(SSFR_ERR_UNKNOWN, "map '%s': there is no array '%s'", text, entry);
    if (*found)
        return ssfr_fail(SSFR_ERR_VALUE, "map '%s': a second '%s'", text, entry);
    *found = path + 1;
    return SSFR_OK;
}

/* A vector is there whole, or with all its parts, or not. */
static ssfr_result check_vector(const map *m, int place, const char *text)
{
    int n_parts = 0;
    for (int k = 0; k < 3; k++) n_parts += m->parts[place][k] != NULL;
    if (n_parts == 0 || (n_parts == 3 && !m->whole[place])) return SSFR_OK;
    return ssfr_fail(SSFR_ERR_VALUE, "map '%s': expected one %s or its x, y and z", text, ssfr_place_name(place));
}

static ssfr_result parse_map(map *m, const char *text)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_text_print(&m->text, "a map", "%s", text));
    for (char *entry = m->text; entry;) {
        char *const comma = strchr(entry, ',');
        if (comma) *comma = '\0';
        SSFR_TRY(parse_entry(m, entry, text));
        entry = comma ? comma + 1 : NULL;
    }
    for (int place = 0; place < SSFR_N_PLACES; place++) SSFR_TRY(check_vector(m, place, text));
    if (!m->whole[SSFR_PLACE_POSITION] && !m->parts[SSFR_PLACE_POSITION][0])
        result = ssfr_fail(SSFR_ERR_VALUE, "map '%s': position is missing", text);
end:
    return result;
}

/* What the group of ssfr's own layout has. */
static void map_own(const source *s, map *m)
{
    m->whole[SSFR_PLACE_POSITION] = "position";
    if (H5Aexists(s->group, "radius") > 0) m->whole[SSFR_PLACE_RADIUS] = "radius";
    for (size_t a = 0; a < SSFR_N_ARRAYS; a++)
        if (H5Lexists(s->group, ssfr_arrays[a].name, H5P_DEFAULT) > 0) m->whole[a + 1] = ssfr_arrays[a].name;
}

/* An attribute that says another unit is refused; one that is not there says nothing. */
static ssfr_result check_units(const source *s, hid_t dataset, const char *name, const char *unit)
{
    ssfr_result result = SSFR_OK;
    char text[32] = "";
    hid_t attribute = 0, type = 0, space = 0;
    if (H5Aexists(dataset, "units") <= 0) return SSFR_OK;
    attribute = H5Aopen(dataset, "units", H5P_DEFAULT);
    type = attribute < 0 ? -1 : H5Aget_type(attribute);
    space = attribute < 0 ? -1 : H5Aget_space(attribute);
    if (type < 0 || space < 0 || H5Sget_simple_extent_npoints(space) != 1 || H5Tget_class(type) != H5T_STRING ||
        H5Tis_variable_str(type) || H5Tget_size(type) >= sizeof text || H5Aread(attribute, type, text) < 0)
        result = ssfr_fail(SSFR_ERR_FORMAT, "%s: %s: units: expected one short string of fixed length",
                           s->reading->path, name);
    else if (strcmp(text, unit) != 0)
        result = ssfr_fail(SSFR_ERR_FORMAT, "%s: %s: expected units \"%s\", found \"%s\"", s->reading->path, name, unit,
                           ssfr_printable(text, (char[SSFR_FOUND]){0}));
    drop(space);
    drop(type);
    drop(attribute);
    return result;
}

/* Whether the type in the file can be read as float or uint32_t without harm. A damaged file may say any size. Whole
 * numbers of foreign files are looked at one by one. */
static bool type_fits(hid_t type, bool real, bool foreign)
{
    const H5T_class_t class = H5Tget_class(type);
    const size_t size = H5Tget_size(type);
    if (foreign) return (class == H5T_FLOAT || class == H5T_INTEGER) && size >= 1 && size <= sizeof(double);
    if (real) return class == H5T_FLOAT && size >= 2 && size <= sizeof(double);
    return class == H5T_INTEGER && H5Tget_sign(type) == H5T_SGN_NONE && size >= 1 && size <= SSFR_ARRAY_VALUE;
}

enum { MAX_RANK = 3, SHAPE = 96 };

/* "7 x 2" for an error line. */
static const char *shape_text(hid_t space, char text[SHAPE])
{
    hsize_t dims[H5S_MAX_RANK] = {0};
    const int rank = H5Sget_simple_extent_dims(space, dims, NULL);
    int used = snprintf(text, SHAPE, rank > 0 ? "" : "one value or none");
    for (int k = 0; k < rank && k < MAX_RANK; k++)
        used += snprintf(text + used, SHAPE - (size_t)used, k ? " x %llu" : "%llu", (unsigned long long)dims[k]);
    if (rank > MAX_RANK) snprintf(text + used, SHAPE - (size_t)used, " x ...");
    return text;
}

/* n x count, or n where count is 1; foreign files may have n x 1 then. */
static bool read_shape(hid_t space, size_t count, bool foreign, hsize_t dims[2])
{
    const int rank = H5Sget_simple_extent_ndims(space);
    dims[1] = 1;
    return (rank == 2 ? count > 1 || foreign : rank == 1 && count == 1) &&
           H5Sget_simple_extent_dims(space, dims, NULL) == rank && dims[1] == count;
}

/* Which of a dataset's filters deflates: -1 for none, -2 when there are others whose work is not known. */
static int find_deflate(hid_t list)
{
    int found = -1;
    for (int i = 0; i < H5Pget_nfilters(list); i++) {
        unsigned flags = 0;
        size_t n = 0;
        const H5Z_filter_t filter = H5Pget_filter2(list, (unsigned)i, &flags, &n, NULL, 0, NULL, NULL);
        if (filter == H5Z_FILTER_DEFLATE)
            found = i;
        else if (filter != H5Z_FILTER_SHUFFLE && filter != H5Z_FILTER_FLETCHER32)
            return -2;
    }
    return found;
}

/* Whether the chunk at this place holds or inflates to the `full` bytes that it has room for. */
static bool chunk_fills(hid_t dataset, const hsize_t at[2], int deflate, size_t file_size, size_t full)
{
    unsigned skipped = 0; /* bits of the filters that left this chunk as it was */
    uint32_t unused = 0;
    haddr_t address = HADDR_UNDEF;
    hsize_t size = 0;
    uLongf n = full;
    if (H5Dget_chunk_info_by_coord(dataset, at, &skipped, &address, &size) < 0 || size > file_size) return false;
    if (address == HADDR_UNDEF) return true;
    if (deflate < 0 || skipped >> deflate & 1) return size >= full;
    Bytef *const deflated = malloc(size), *const inflated = malloc(full);
    const bool fills = deflated && inflated && H5Dread_chunk(dataset, H5P_DEFAULT, at, &unused, deflated) >= 0 &&
                       uncompress(inflated, &n, deflated, size) == Z_OK && n == full;
    free(deflated);
    free(inflated);
    return fills;
}

/* HDF5 trusts a file that a chunk fills its room, and that the room of one that passed filters is no larger than the
 * dataset. A damaged file would let it read past the end. */
static bool chunks_fit(const source *s, hid_t dataset, int rank, const hsize_t dims[2])
{
    const hid_t list = H5Dget_create_plist(dataset), type = H5Dget_type(dataset);
    hsize_t chunk[2] = {1, 1};
    bool fit = list > 0 && type > 0;
    if (fit && H5Pget_layout(list) == H5D_CHUNKED) {
        const int deflate = find_deflate(list);
        const bool any = H5Pget_nfilters(list) > 0;
        fit = H5Pget_chunk(list, rank, chunk) == rank && (!any || (chunk[0] <= dims[0] && chunk[1] <= dims[1]));
        const size_t full = fit ? chunk[0] * chunk[1] * H5Tget_size(type) : 0;
        for (hsize_t i = 0; i < dims[0] && fit && deflate > -2; i += chunk[0])
            for (hsize_t k = 0; k < dims[1] && fit; k += chunk[1])
                fit = chunk_fills(dataset, (hsize_t[2]){i, k}, deflate, s->size, full);
    }
    drop(type);
    drop(list);
    return fit;
}

/* Checks a dataset's type and shape (n x count, or n) and that the file can hold it, however well deflated. */
static ssfr_result check_dataset(const source *s, hid_t dataset, const char *name, size_t count, bool real, size_t *n)
{
    ssfr_result result = SSFR_OK;
    hsize_t dims[2] = {0, 1};
    char shape[SHAPE];
    const bool foreign = s->reading->map != NULL;
    const char *path = s->reading->path;
    const hid_t space = H5Dget_space(dataset), type = H5Dget_type(dataset);
    if (type < 0 || !type_fits(type, real, foreign)) {
        result = ssfr_fail(SSFR_ERR_FORMAT, "%s: %s: expected values of type %s", path, name,
                           foreign ? "integer or float" : real ? "float" : "uint32");
    } else if (space < 0 || !read_shape(space, count, foreign, dims)) {
        result = ssfr_fail(SSFR_ERR_FORMAT, "%s: %s: expected an array of n x %zu values, found %s", path, name, count,
                           space < 0 ? "none" : shape_text(space, shape));
    } else if (dims[0] > s->size * SSFR_DEFLATE_MOST / (count * H5Tget_size(type))) {
        result = ssfr_fail(SSFR_ERR_FORMAT, "%s: %s: %llu particles do not fit into a file of %zu bytes", path, name,
                           (unsigned long long)dims[0], s->size);
    } else if (!chunks_fit(s, dataset, H5Sget_simple_extent_ndims(space), dims)) {
        result = ssfr_fail(SSFR_ERR_FORMAT,
                           "%s: %s: the deflated values are damaged, or their chunks larger than the dataset", path,
                           name);
    }
    *n = (size_t)dims[0];
    drop(type);
    drop(space);
    return result;
}

/* Opens a dataset and learns its n. */
static ssfr_result open_dataset(const source *s, const char *name, const char *unit, size_t count, bool real,
                                hid_t *out, size_t *n)
{
    ssfr_result result = SSFR_OK;
    *out = H5Dopen2(s->group, name, H5P_DEFAULT);
    if (*out < 0) return refused(SSFR_ERR_FORMAT, s->reading->path, name);
    SSFR_TRY(check_dataset(s, *out, name, count, real, n));
    if (!s->reading->map) SSFR_TRY(check_units(s, *out, name, unit));
end:
    return result;
}

static ssfr_result read_positions(const source *s)
{
    ssfr_result result = SSFR_OK;
    ssfr_reading *r = s->reading;
    hid_t dataset = 0;
    size_t n = 0;
    SSFR_TRY(open_dataset(s, s->map.whole[SSFR_PLACE_POSITION], "m", 3, true, &dataset, &n));
    SSFR_TRY(ssfr_reading_begin(r, n));
    if (n > 0 && H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, r->positions) < 0)
        result = refused(SSFR_ERR_FORMAT, r->path, s->map.whole[SSFR_PLACE_POSITION]);
end:
    drop(dataset);
    return result;
}

/* Numbers of any type to places first, first + step, ... of target. Doubles tell all whole numbers that fit. */
static ssfr_result put_values(const source *s, hid_t dataset, const char *name, const ssfr_target *target, size_t first,
                              size_t step)
{
    ssfr_result result = SSFR_OK;
    const size_t n = s->reading->given.n * target->count / step;
    double *values = NULL;
    SSFR_TRY(ssfr_alloc(&values, n, sizeof *values, name));
    if (n > 0 && H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0) {
        result = refused(SSFR_ERR_FORMAT, s->reading->path, name);
        goto end;
    }
    for (size_t k = 0; k < n; k++) SSFR_TRY(ssfr_target_put(s->reading, target, first + step * k, values[k]));
end:
    free(values);
    return result;
}

static ssfr_result check_n(const source *s, const char *name, size_t n)
{
    const ssfr_reading *r = s->reading;
    if (n == r->given.n) return SSFR_OK;
    return ssfr_fail(SSFR_ERR_FORMAT, "%s: %s of %zu particles, but %zu positions", r->path, name, n, r->given.n);
}

static ssfr_result read_array(const source *s, const ssfr_array *array, const char *name)
{
    ssfr_result result = SSFR_OK;
    ssfr_reading *r = s->reading;
    const hid_t type = array->real ? H5T_NATIVE_FLOAT : H5T_NATIVE_UINT32;
    hid_t dataset = 0;
    size_t n = 0;
    ssfr_target target;
    SSFR_TRY(open_dataset(s, name, array->unit, array->count, array->real, &dataset, &n));
    SSFR_TRY(check_n(s, name, n));
    SSFR_TRY(ssfr_target_array(r, array, &target));
    if (r->map && !array->real)
        SSFR_TRY(put_values(s, dataset, name, &target, 0, 1));
    else if (n > 0 && H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, ssfr_array_get(&r->given, array)) < 0)
        result = refused(SSFR_ERR_FORMAT, r->path, name);
end:
    drop(dataset);
    return result;
}

/* A vector whose components are datasets of their own. */
static ssfr_result read_parts(const source *s, int place)
{
    ssfr_result result = SSFR_OK;
    ssfr_reading *r = s->reading;
    ssfr_target target = {0};
    hid_t dataset = 0;
    for (size_t k = 0; k < 3; k++) {
        const char *name = s->map.parts[place][k];
        size_t n = 0;
        SSFR_TRY(open_dataset(s, name, "", 1, true, &dataset, &n));
        if (k == 0 && place == SSFR_PLACE_POSITION) {
            SSFR_TRY(ssfr_reading_begin(r, n));
            target = ssfr_target_positions(r);
        } else if (k == 0) {
            SSFR_TRY(ssfr_target_array(r, ssfr_arrays + place - 1, &target));
        }
        SSFR_TRY(check_n(s, name, n));
        SSFR_TRY(put_values(s, dataset, name, &target, k, 3));
        drop(dataset);
        dataset = 0;
    }
end:
    drop(dataset);
    return result;
}

/* "/a/b" of a map is a dataset, or else the attribute b of what "/a" is. */
static ssfr_result open_radius(const source *s, hid_t *dataset, hid_t *attribute)
{
    ssfr_result result = SSFR_OK;
    const char *path = s->map.whole[SSFR_PLACE_RADIUS], *slash = strrchr(path, '/');
    const size_t length = slash ? (size_t)(slash - path) : 0;
    char *object = NULL;
    if (s->reading->map && (*dataset = H5Dopen2(s->group, path, H5P_DEFAULT)) > 0) return SSFR_OK;
    SSFR_TRY(ssfr_text_print(&object, "a name", "%.*s", length ? (int)length : 1, length ? path : slash ? "/" : "."));
    *attribute = H5Aopen_by_name(s->group, object, slash ? slash + 1 : path, H5P_DEFAULT, H5P_DEFAULT);
    if (*attribute < 0) result = refused(SSFR_ERR_FORMAT, s->reading->path, path);
end:
    free(object);
    return result;
}

/* A number of its own, not deflated together with others. */
static bool is_one_number(const source *s, hid_t dataset)
{
    const hid_t space = H5Dget_space(dataset), type = H5Dget_type(dataset);
    const hsize_t one[2] = {1, 1};
    const int rank = space < 0 ? -1 : H5Sget_simple_extent_ndims(space);
    const bool fits = type > 0 && (rank == 0 || rank == 1) && H5Sget_simple_extent_npoints(space) == 1 &&
                      type_fits(type, true, true) && (rank == 0 || chunks_fit(s, dataset, rank, one));
    drop(type);
    drop(space);
    return fits;
}

static ssfr_result read_radius(const source *s)
{
    ssfr_result result = SSFR_OK;
    hid_t dataset = 0, attribute = 0, space = 0;
    double *radius = &s->reading->given.radius;
    bool ok = false;
    SSFR_TRY(open_radius(s, &dataset, &attribute));
    if (attribute > 0) {
        space = H5Aget_space(attribute);
        ok = space > 0 && H5Sget_simple_extent_npoints(space) == 1 &&
             H5Aread(attribute, H5T_NATIVE_DOUBLE, radius) >= 0;
    } else {
        ok = is_one_number(s, dataset) &&
             H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, radius) >= 0;
    }
    if (!ok)
        result = ssfr_fail(SSFR_ERR_FORMAT, "%s: %s: expected one number", s->reading->path,
                           s->map.whole[SSFR_PLACE_RADIUS]);
end:
    drop(space);
    drop(attribute);
    drop(dataset);
    return result;
}

/* HDF5's own words for a missing file are long. */
static ssfr_result check_file(const char *path, size_t *size)
{
    struct stat info;
    if (stat(path, &info) != 0 || access(path, R_OK) != 0)
        return ssfr_fail(SSFR_ERR_IO, "%s: %s", path, strerror(errno));
    if (!S_ISREG(info.st_mode)) return ssfr_fail(SSFR_ERR_IO, "%s: not a regular file", path);
    *size = (size_t)info.st_size;
    return SSFR_OK;
}

/* Without locks, which some file systems lack: a file is complete when it gets its name. */
static hid_t access_list(void)
{
    const hid_t list = H5Pcreate(H5P_FILE_ACCESS);
    if (list > 0) H5Pset_file_locking(list, false, true);
    return list;
}

static ssfr_result read_all(const source *s)
{
    ssfr_result result = SSFR_OK;
    if (s->map.whole[SSFR_PLACE_RADIUS]) SSFR_TRY(read_radius(s));
    if (s->map.whole[SSFR_PLACE_POSITION]) SSFR_TRY(read_positions(s));
    for (int place = 0; place < SSFR_N_PLACES; place++)
        if (s->map.parts[place][0]) SSFR_TRY(read_parts(s, place));
    for (size_t a = 0; a < SSFR_N_ARRAYS; a++)
        if (s->map.whole[a + 1]) SSFR_TRY(read_array(s, ssfr_arrays + a, s->map.whole[a + 1]));
end:
    return result;
}

ssfr_result ssfr_hdf5_read(ssfr_reading *reading)
{
    ssfr_result result = SSFR_OK;
    source s = {.reading = reading};
    hid_t list = 0, file = 0;
    const guard g = enter();
    if (reading->map) SSFR_TRY(parse_map(&s.map, reading->map));
    SSFR_TRY(check_file(reading->path, &s.size));
    list = access_list();
    file = H5Fopen(reading->path, H5F_ACC_RDONLY, list);
    if (file < 0) {
        result = refused(SSFR_ERR_FORMAT, reading->path, "no HDF5 file");
        goto end;
    }
    s.group = H5Gopen2(file, reading->map ? "/" : "particles", H5P_DEFAULT);
    if (s.group < 0) {
        result = refused(SSFR_ERR_FORMAT, reading->path, "no group particles");
        goto end;
    }
    if (!reading->map) map_own(&s, &s.map);
    SSFR_TRY(read_all(&s));
end:
    free(s.map.text);
    drop(s.group);
    drop(file);
    drop(list);
    leave(g);
    return result;
}

/* ---- writing ----------------------------------------------------------------------------------------------------- */

/* Creation properties of a dataset of n x count values. A chunk may not be larger than the dataset, nor empty. */
static hid_t dataset_properties(size_t n, size_t count)
{
    const hid_t list = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk[2] = {n < CHUNK ? n : CHUNK, count};
    bool ok = list > 0 && H5Pset_obj_track_times(list, false) >= 0;
    if (n > 0)
        ok = ok && H5Pset_chunk(list, count > 1 ? 2 : 1, chunk) >= 0 && H5Pset_shuffle(list) >= 0 &&
             H5Pset_deflate(list, DEFLATE_LEVEL) >= 0;
    if (ok) return list;
    drop(list);
    return -1;
}

static bool write_text(hid_t object, const char *name, const char *text)
{
    const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
    bool ok = type > 0 && space > 0 && H5Tset_size(type, strlen(text) + 1) >= 0;
    const hid_t attribute = ok ? H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT) : -1;
    ok = attribute > 0 && H5Awrite(attribute, type, text) >= 0;
    drop(attribute);
    drop(space);
    drop(type);
    return ok;
}

static bool write_number(hid_t object, const char *name, double value)
{
    const hid_t space = H5Screate(H5S_SCALAR);
    const hid_t attribute = H5Acreate2(object, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT);
    const bool ok = attribute > 0 && H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value) >= 0;
    drop(attribute);
    drop(space);
    return ok;
}

/* What one dataset is made of. */
typedef struct column {
    const char *name, *unit;
    size_t n, count;
    hid_t type, memory_type; /* in the file, in memory */
    const void *values;
} column;

static bool write_column(hid_t group, const column *c)
{
    const hsize_t dims[2] = {c->n, c->count};
    const hid_t list = dataset_properties(c->n, c->count), space = H5Screate_simple(c->count > 1 ? 2 : 1, dims, NULL);
    const hid_t dataset =
        list > 0 && space > 0 ? H5Dcreate2(group, c->name, c->type, space, H5P_DEFAULT, list, H5P_DEFAULT) : -1;
    bool ok = dataset > 0 && write_text(dataset, "units", c->unit);
    if (c->n > 0) ok = ok && H5Dwrite(dataset, c->memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, c->values) >= 0;
    ok = drop(dataset) && ok; /* which compresses what is still waiting */
    drop(space);
    drop(list);
    return ok;
}

static ssfr_result write_positions(const ssfr_particles *set, hid_t group, const char *path)
{
    ssfr_result result = SSFR_OK;
    double *positions = NULL;
    column c = {"position", "m", set->n, 3, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, NULL};
    SSFR_TRY(ssfr_alloc(&positions, set->n, 3 * sizeof *positions, "positions"));
    for (size_t i = 0; i < set->n; i++) ssfr_particles_position(set, i, positions + 3 * i);
    if (ssfr_floats_suffice(set)) c.type = H5T_IEEE_F32LE;
    c.values = positions;
    if (!write_column(group, &c)) result = refused(SSFR_ERR_IO, path, "cannot write position");
end:
    free(positions);
    return result;
}

static ssfr_result write_array(const ssfr_particles *set, const ssfr_array *array, hid_t group, const char *path)
{
    const column c = {array->name, array->unit, set->n, array->count,
                      array->real ? H5T_IEEE_F32LE : H5T_STD_U32LE,
                      array->real ? H5T_NATIVE_FLOAT : H5T_NATIVE_UINT32, ssfr_array_get(set, array)};
    if (c.values && !write_column(group, &c)) return refused(SSFR_ERR_IO, path, "cannot write an array");
    return SSFR_OK;
}

static ssfr_result write_group(const ssfr_particles *set, hid_t file, const char *path)
{
    ssfr_result result = SSFR_OK;
    const hid_t group = H5Gcreate2(file, "particles", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    if (group < 0 || (set->radius > 0 && !write_number(group, "radius", set->radius))) {
        result = refused(SSFR_ERR_IO, path, "cannot write the group particles");
        goto end;
    }
    SSFR_TRY(write_positions(set, group, path));
    for (size_t a = 0; a < SSFR_N_ARRAYS; a++) SSFR_TRY(write_array(set, ssfr_arrays + a, group, path));
end:
    drop(group);
    return result;
}

/* The whole file as HDF5 makes it in memory: HDF5 cannot clean up after a disk that was full. */
static ssfr_result make_image(const ssfr_particles *set, const char *path, const char *temporary, char **out,
                              size_t *size)
{
    enum { GROWTH = 1 << 20 /* bytes */ };
    ssfr_result result = SSFR_OK;
    const hid_t list = H5Pcreate(H5P_FILE_ACCESS);
    const hid_t file = list > 0 && H5Pset_fapl_core(list, GROWTH, false) >= 0
                           ? H5Fcreate(temporary, H5F_ACC_TRUNC, H5P_DEFAULT, list)
                           : -1;
    if (file < 0) {
        result = refused(SSFR_ERR_IO, path, "cannot make a file in memory");
        goto end;
    }
    SSFR_TRY(write_group(set, file, path));
    const ssize_t length = H5Fflush(file, H5F_SCOPE_GLOBAL) < 0 ? -1 : H5Fget_file_image(file, NULL, 0);
    if (length > 0) SSFR_TRY(ssfr_alloc(out, (size_t)length, 1, "a file's image"));
    if (length <= 0 || H5Fget_file_image(file, *out, (size_t)length) < 0) {
        result = refused(SSFR_ERR_IO, path, "cannot make a file in memory");
        goto end;
    }
    *size = (size_t)length;
end:
    drop(file);
    drop(list);
    return result;
}

static ssfr_result write_image(const char *path, const char *temporary, const char *image, size_t size)
{
    FILE *file = fopen(temporary, "wb");
    bool ok = file && fwrite(image, 1, size, file) == size;
    if (file) ok = fclose(file) == 0 && ok;
    return ok ? SSFR_OK : ssfr_fail(SSFR_ERR_IO, "%s: cannot be written: %s", path, strerror(errno));
}

ssfr_result ssfr_hdf5_write(const ssfr_particles *particles, const char *path)
{
    ssfr_result result = SSFR_OK;
    ssfr_aside aside = {0};
    char *image = NULL;
    size_t size = 0;
    const guard g = enter();
    SSFR_TRY(ssfr_aside_begin(&aside, path));
    SSFR_TRY(make_image(particles, path, aside.temporary, &image, &size));
    SSFR_TRY(write_image(path, aside.temporary, image, size));
end:
    result = ssfr_aside_end(&aside, result);
    free(image);
    leave(g);
    return result;
}
