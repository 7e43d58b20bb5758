/* SPDX-License-Identifier: MIT */
/* reader.c: loading and saving particles by the name's ending, and what the readers share. */
#include "scene/writer.h"

#include <ctype.h>
#include <strings.h>

/* ---- what a reader fills ----------------------------------------------------------------------------------------- */

const ssfr_array *ssfr_array_find(const char *word)
{
    static const char *const others[][2] = {
        {"v", "velocity"},
        {"vel", "velocity"},
        {"velo", "velocity"},
        {"velocities", "velocity"},
        {"rho", "density"},
        {"remaining_lifetime", "lifetime"},
        {"initiallifetime", "initial_lifetime"},
        {"max_lifetime", "initial_lifetime"},
        {"lifespan", "initial_lifetime"},
        {"neighbors", "neighbours"},
        {"n_neighbors", "neighbours"},
        {"n_neighbours", "neighbours"},
        {"ids", "id"},
        {"particle_id", "id"},
        {"particleid", "id"},
        {"type", "kind"},
    };
    const char *name = word;
    const ssfr_array *found = NULL;
    for (size_t i = 0; i < SSFR_COUNT(others); i++)
        if (strcasecmp(word, others[i][0]) == 0) name = others[i][1];
    for (size_t a = 0; a < SSFR_N_ARRAYS; a++)
        if (strcasecmp(name, ssfr_arrays[a].name) == 0) found = ssfr_arrays + a;
    return found;
}

ssfr_result ssfr_reading_begin(ssfr_reading *reading, size_t n)
{
    reading->given.n = n;
    return ssfr_alloc(&reading->positions, n, 3 * sizeof *reading->positions, "positions");
}

void ssfr_reading_skip(ssfr_reading *r, const char *name)
{
    char text[SSFR_FOUND];
    const size_t used = strlen(r->skipped);
    if (used + SSFR_FOUND + sizeof " \"\"" <= sizeof r->skipped)
        snprintf(r->skipped + used, sizeof r->skipped - used, " \"%s\"", ssfr_printable(name, text));
}

void ssfr_reading_end(ssfr_reading *r, size_t n)
{
    const double least = r->radii[0], most = r->radii[1];
    r->given.n = n;
    if (r->given.radius != 0) return;
    if (least < most)
        ssfr_log(SSFR_WARNING, "%s: the particles have radii from %g to %g m, none for all: they are not used", r->path,
                 least, most);
    else if (least == most)
        r->given.radius = least;
}

void ssfr_reading_finish(ssfr_reading *reading)
{
    for (size_t a = 0; a < SSFR_N_ARRAYS; a++) free(ssfr_array_get(&reading->given, ssfr_arrays + a));
    free(reading->positions);
    *reading = (ssfr_reading){0};
}

ssfr_target ssfr_target_positions(const ssfr_reading *reading)
{
    return (ssfr_target){.positions = reading->positions, .name = "position", .count = 3};
}

ssfr_target ssfr_target_radii(ssfr_reading *reading)
{
    reading->radii[0] = INFINITY, reading->radii[1] = -INFINITY;
    return (ssfr_target){.radii = reading->radii, .name = "radius", .count = 1};
}

ssfr_result ssfr_target_array(ssfr_reading *reading, const ssfr_array *array, ssfr_target *out)
{
    void *values = NULL;
    const ssfr_result result = ssfr_alloc(&values, reading->given.n, array->count * SSFR_ARRAY_VALUE, array->name);
    *out = (ssfr_target){.name = array->name, .count = array->count};
    ssfr_array_set(&reading->given, array, values);
    if (array->real)
        out->reals = values;
    else
        out->wholes = values;
    return result;
}

ssfr_result ssfr_target_refuse(const ssfr_reading *reading, const ssfr_target *target, size_t i, double value)
{
    return ssfr_fail(SSFR_ERR_FORMAT, "%s: particle %zu (from 0): %s is %.10g, expected a whole number from 0 to %u",
                     reading->path, i, target->name, value, UINT32_MAX);
}

ssfr_result ssfr_target_put_radius(const ssfr_reading *reading, const ssfr_target *target, size_t i, double value)
{
    if (!(value >= 0 && isfinite(value)))
        return ssfr_fail(SSFR_ERR_FORMAT, "%s: particle %zu (from 0): radius is %g m", reading->path, i, value);
    target->radii[0] = fmin(target->radii[0], value);
    target->radii[1] = fmax(target->radii[1], value);
    return SSFR_OK;
}

/* ---- streams of numbers ------------------------------------------------------------------------------------------ */

ssfr_result ssfr_stream_open(ssfr_stream *out, const char *path, char **file)
{
    size_t size = 0;
    const ssfr_result result = ssfr_read_file(path, SSFR_READ_MAX, file, &size);
    *out = (ssfr_stream){.encoding = SSFR_LITTLE_ENDIAN, .blanks = " \t\r\n\v\f"};
    if (result == SSFR_OK) out->at = *file, out->end = *file + size;
    return result;
}

size_t ssfr_scalar_size(ssfr_scalar type)
{
    static const unsigned char sizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    return sizes[type];
}

static const bool host_is_big = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;

static bool next_ascii(ssfr_stream *s, double *value)
{
    const char *start = s->at + strspn(s->at, s->blanks);
    char *end = NULL;
    if (isspace((unsigned char)*start)) return false; /* which strtod would skip */
    const double number = strtod(start, &end);
    if (end == start || (end != s->end && !isspace((unsigned char)*end))) return false;
    *value = number;
    s->at = end;
    return true;
}

static uint16_t bits16(const char *at, bool swap)
{
    uint16_t bits;
    memcpy(&bits, at, sizeof bits);
    return swap ? __builtin_bswap16(bits) : bits;
}

static uint32_t bits32(const char *at, bool swap)
{
    uint32_t bits;
    memcpy(&bits, at, sizeof bits);
    return swap ? __builtin_bswap32(bits) : bits;
}

static uint64_t bits64(const char *at, bool swap)
{
    uint64_t bits;
    memcpy(&bits, at, sizeof bits);
    return swap ? __builtin_bswap64(bits) : bits;
}

static double float32_of(uint32_t bits)
{
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

static double float64_of(uint64_t bits)
{
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static double decode(const char *at, ssfr_scalar type, bool swap)
{
    switch (type) {
    case SSFR_INT8: return (int8_t)*at;
    case SSFR_UINT8: return (uint8_t)*at;
    case SSFR_INT16: return (int16_t)bits16(at, swap);
    case SSFR_UINT16: return bits16(at, swap);
    case SSFR_INT32: return (int32_t)bits32(at, swap);
    case SSFR_UINT32: return bits32(at, swap);
    case SSFR_INT64: return (double)(int64_t)bits64(at, swap);
    case SSFR_UINT64: return (double)bits64(at, swap);
    case SSFR_FLOAT32: return float32_of(bits32(at, swap));
    default: return float64_of(bits64(at, swap));
    }
}

bool ssfr_stream_next(ssfr_stream *s, ssfr_scalar type, double *value)
{
    if (s->encoding == SSFR_ASCII) return next_ascii(s, value);
    const size_t size = ssfr_scalar_size(type);
    if ((size_t)(s->end - s->at) < size) return false;
    *value = decode(s->at, type, (s->encoding == SSFR_BIG_ENDIAN) != host_is_big);
    s->at += size;
    return true;
}

bool ssfr_stream_skip(ssfr_stream *s, ssfr_scalar type, size_t n)
{
    bool ok = ssfr_stream_holds(s, n, ssfr_stream_value_size(s, type));
    double value;
    if (s->encoding != SSFR_ASCII && ok) s->at += n * ssfr_scalar_size(type);
    for (size_t i = 0; s->encoding == SSFR_ASCII && ok && i < n; i++) ok = next_ascii(s, &value);
    return ok;
}

size_t ssfr_stream_value_size(const ssfr_stream *s, ssfr_scalar type)
{
    return s->encoding == SSFR_ASCII ? 2 : ssfr_scalar_size(type);
}

bool ssfr_stream_holds(const ssfr_stream *s, size_t n, size_t size)
{
    const size_t left = (size_t)(s->end - s->at) + (s->encoding == SSFR_ASCII); /* the last needs no blank */
    return n <= left / size;
}

ssfr_result ssfr_stream_fill(ssfr_stream *s, ssfr_scalar type, const ssfr_reading *reading, const ssfr_target *target)
{
    ssfr_result result = SSFR_OK;
    const size_t n = reading->given.n * target->count;
    char found[SSFR_FOUND];
    for (size_t k = 0; k < n && result == SSFR_OK; k++) {
        double value;
        if (ssfr_stream_next(s, type, &value))
            result = ssfr_target_put(reading, target, k, value);
        else
            result = ssfr_fail(SSFR_ERR_FORMAT, "%s: particle %zu (from 0): expected its %s, %s", reading->path,
                               k / target->count, target->name, ssfr_stream_found(s, found));
    }
    return result;
}

const char *ssfr_printable(const char *word, char text[SSFR_FOUND])
{
    size_t n = 0;
    for (; n + 1 < SSFR_FOUND && word[n] && !isspace((unsigned char)word[n]); n++)
        text[n] = (char)(word[n] > ' ' && word[n] <= '~' ? word[n] : '?');
    text[n] = '\0';
    return text;
}

const char *ssfr_stream_found(const ssfr_stream *s, char text[SSFR_FOUND])
{
    char word[SSFR_FOUND];
    const char *at = s->at + (s->encoding == SSFR_ASCII ? strspn(s->at, s->blanks) : 0);
    if (s->encoding != SSFR_ASCII || at == s->end) return "the file ends";
    if (isspace((unsigned char)*at)) return "the line ends";
    snprintf(text, SSFR_FOUND, "found \"%.*s\"", SSFR_FOUND - 10, ssfr_printable(at, word));
    return text;
}

bool ssfr_parse_count(const char *word, size_t *out)
{
    const size_t digits = strspn(word, "0123456789");
    const bool ok = digits > 0 && digits < 20 && word[digits] == '\0'; /* 10^19 - 1 < 2^64 */
    if (ok) *out = (size_t)strtoull(word, NULL, 10);
    return ok;
}

/* ---- loading and saving ------------------------------------------------------------------------------------------ */

typedef struct format {
    const char *ending;
    ssfr_reader *read;
    ssfr_writer *write;
    unsigned holds;
} format;

#define X(ending, reader, writer, holds, help) {ending, reader, writer, holds},
static const format formats[] = {
#include "scene/formats.def"
};
#undef X

const char *ssfr_particle_formats(void)
{
#define X(ending, reader, writer, holds, help) ending " (" help ")\n"
    return
#include "scene/formats.def"
        ;
#undef X
}

static bool ends_in(const char *path, const char *ending)
{
    const size_t length = strlen(path), n = strlen(ending);
    return length >= n && strcasecmp(path + length - n, ending) == 0;
}

static ssfr_result find_format(const char *path, const format **out)
{
#define X(ending, reader, writer, holds, help) " " ending
    static const char endings[] =
#include "scene/formats.def"
        ;
#undef X
    *out = NULL;
    for (size_t i = 0; i < SSFR_COUNT(formats); i++)
        if (ends_in(path, formats[i].ending)) *out = formats + i;
    return *out ? SSFR_OK : ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: the names of particle files end in%s", path, endings);
}

/* Turns the axis that points up to y: (x, y, z) becomes (x, z, -y) or (-y, x, z). */
static void turn(char up, double v[3])
{
    const double x = v[0], y = v[1], z = v[2];
    if (up == 'z') v[1] = z, v[2] = -y;
    if (up == 'x') v[0] = -y, v[1] = x;
}

/* From the file's unit and axes to metres and y up. */
static void transform(ssfr_reading *r, const ssfr_load_options *options)
{
    const double unit = options->unit > 0 ? options->unit : 1; /* m */
    r->given.radius *= unit;
    for (size_t i = 0; i < r->given.n; i++) {
        double *at = r->positions + 3 * i;
        float *velocity = r->given.velocity ? r->given.velocity + 3 * i : NULL;
        for (int k = 0; k < 3; k++) at[k] *= unit;
        turn(options->up, at);
        double v[3] = {0};
        for (int k = 0; velocity && k < 3; k++) v[k] = unit * (double)velocity[k];
        turn(options->up, v);
        for (int k = 0; velocity && k < 3; k++) velocity[k] = (float)v[k];
    }
}

/* The first value of particle i that is not finite, and the array's name; NULL when all are. */
static const char *find_nonfinite(const ssfr_reading *r, size_t i, double *value)
{
    const char *name = NULL;
    for (size_t k = 0; k < 3 && !name; k++)
        if (!isfinite(*value = r->positions[3 * i + k])) name = "position";
    for (size_t a = 0; a < SSFR_N_ARRAYS && !name; a++) {
        const ssfr_array *array = ssfr_arrays + a;
        const float *values = array->real ? ssfr_array_get(&r->given, array) : NULL;
        for (size_t k = 0; values && k < array->count && !name; k++)
            if (!isfinite(*value = (double)values[array->count * i + k])) name = array->name;
    }
    return name;
}

static void move(ssfr_reading *r, size_t from, size_t to)
{
    memcpy(r->positions + 3 * to, r->positions + 3 * from, 3 * sizeof *r->positions);
    for (size_t a = 0; a < SSFR_N_ARRAYS; a++) {
        const size_t size = ssfr_arrays[a].count * SSFR_ARRAY_VALUE;
        char *values = ssfr_array_get(&r->given, ssfr_arrays + a);
        if (values) memcpy(values + to * size, values + from * size, size);
    }
}

static ssfr_result refuse_or_drop_nonfinite(ssfr_reading *r, ssfr_load_options *options)
{
    size_t kept = 0;
    for (size_t i = 0; i < r->given.n; i++) {
        double value = 0;
        const char *name = find_nonfinite(r, i, &value);
        if (name && !options->drop_nonfinite)
            return ssfr_fail(SSFR_ERR_VALUE, "%s: particle %zu (from 0): %s is %g", r->path, i, name, value);
        if (!name && kept != i) move(r, i, kept);
        kept += !name;
    }
    options->n_dropped = r->given.n - kept;
    r->given.n = kept;
    return SSFR_OK;
}

static ssfr_result estimate_radius(ssfr_particles *set, const char *path)
{
    ssfr_result result = SSFR_OK;
    SSFR_TRY(ssfr_particles_estimate_radius(set, &set->radius));
    if (set->radius > 0)
        ssfr_log(SSFR_INFO, "%s: no radius in the file: estimated as %g m", path, set->radius);
    else
        result = ssfr_fail(SSFR_ERR_VALUE, "%s: say the radius: the file has none, and its %zu particle%s give none",
                         path, set->n, set->n == 1 ? "" : "s");
end:
    return result;
}

static ssfr_result load(ssfr_particles **out, const format *format, const char *path, ssfr_load_options *options)
{
    ssfr_result result = SSFR_OK;
    ssfr_reading reading = {.path = path, .map = options->map};
    ssfr_particles *set = NULL;
    SSFR_TRY(format->read(&reading));
    if (reading.skipped[0]) ssfr_log(SSFR_INFO, "%s: not read:%s", path, reading.skipped);
    transform(&reading, options);
    if (!(reading.given.radius >= 0 && isfinite(reading.given.radius))) {
        result = ssfr_fail(SSFR_ERR_FORMAT, "%s: the particle radius is %g m", path, reading.given.radius);
        goto end;
    }
    SSFR_TRY(refuse_or_drop_nonfinite(&reading, options));
    if (options->radius > 0) reading.given.radius = options->radius;
    SSFR_TRY(ssfr_particles_create(&set, reading.given.n, reading.positions, &reading.given));
    options->estimated = set->radius == 0 && set->n > 0;
    if (options->estimated) SSFR_TRY(estimate_radius(set, path));
    *out = set;
    set = NULL;
end:
    ssfr_particles_destroy(&set);
    ssfr_reading_finish(&reading);
    return result;
}

static ssfr_result check_options(const ssfr_load_options *options, const char *path)
{
    if (!(options->radius >= 0 && isfinite(options->radius)))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: particle radius %g m: expected a finite number above 0", path,
                         options->radius);
    if (!(options->unit >= 0 && isfinite(options->unit)))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: unit of length %g m: expected a finite number above 0", path,
                         options->unit);
    if (options->up && !strchr("xyz", options->up))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: the axis up is '%c': expected x, y or z", path,
                         options->up >= ' ' && options->up <= '~' ? options->up : '?');
    return SSFR_OK;
}

ssfr_result ssfr_particles_load(ssfr_particles **out, const char *path, ssfr_load_options *options)
{
    ssfr_result result = SSFR_OK;
    const format *format = NULL;
    ssfr_load_options none = {0};
    if (!options) options = &none;
    options->n_dropped = 0;
    options->estimated = false;
    *out = NULL;
    ssfr_plain plain = ssfr_plain_begin();
    SSFR_TRY(check_options(options, path));
    SSFR_TRY(find_format(path, &format));
    if (options->map && format->read != ssfr_hdf5_read) {
        result = ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: a map of arrays is for HDF5, not for %s files", path,
                           format->ending);
        goto end;
    }
    SSFR_TRY(load(out, format, path, options));
end:
    ssfr_plain_end(&plain);
    return result;
}

/* For formats of floats: refuses what they cannot hold at all, and says how far particles move by their rounding. */
static ssfr_result check_floats(const ssfr_particles *set, const char *path)
{
    double most = 0; /* m */
    const float radius = (float)set->radius;
    if (!isfinite(radius) || (radius > 0) != (set->radius > 0))
        return ssfr_fail(SSFR_ERR_VALUE, "%s: the radius %g m does not fit a float", path, set->radius);
    for (size_t i = 0; i < set->n; i++) {
        double at[3];
        ssfr_particles_position(set, i, at);
        for (int k = 0; k < 3; k++) {
            if (!isfinite((float)at[k]))
                return ssfr_fail(SSFR_ERR_VALUE, "%s: particle %zu (from 0): position %g m does not fit a float", path,
                                 i, at[k]);
            most = fmax(most, fabs((double)(float)at[k] - at[k]));
        }
    }
    if (!ssfr_floats_suffice(set))
        ssfr_log(SSFR_WARNING, "%s: written as floats, positions move by up to %.3g m an axis", path, most);
    return SSFR_OK;
}

/* What the format cannot hold: said where it is left out, refused where a value would become another. */
static ssfr_result tell_losses(const ssfr_particles *set, const format *format, const char *path)
{
    char names[256] = "";
    size_t used = 0;
    for (size_t a = 0; a < SSFR_N_ARRAYS && !(format->holds & SSFR_HOLDS_ARRAYS); a++)
        if (ssfr_array_get(set, ssfr_arrays + a))
            used += (size_t)snprintf(names + used, sizeof names - used, " %s", ssfr_arrays[a].name);
    if (!(format->holds & SSFR_HOLDS_RADIUS) && set->radius > 0) snprintf(names + used, sizeof names - used, " radius");
    if (names[0]) ssfr_log(SSFR_WARNING, "%s: %s files do not hold:%s", path, format->ending, names);
    return format->holds & SSFR_HOLDS_DOUBLES ? SSFR_OK : check_floats(set, path);
}

static ssfr_result find_written(const char *path, const format **out)
{
    const ssfr_result result = find_format(path, out);
    if (result != SSFR_OK || (*out)->write) return result;
    return ssfr_fail(SSFR_ERR_UNSUPPORTED, "%s: %s files are read but not written", path, (*out)->ending);
}

ssfr_result ssfr_particles_check_name(const char *path)
{
    const format *format;
    return find_written(path, &format);
}

ssfr_result ssfr_particles_save(const ssfr_particles *particles, const char *path)
{
    ssfr_result result = SSFR_OK;
    const format *format = NULL;
    ssfr_plain plain = ssfr_plain_begin();
    SSFR_TRY(find_written(path, &format));
    SSFR_TRY(tell_losses(particles, format, path));
    SSFR_TRY(format->write(particles, path));
end:
    ssfr_plain_end(&plain);
    return result;
}
