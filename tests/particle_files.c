/* SPDX-License-Identifier: GPL-3.0-or-later */
/* particle_files.c: what the tests of the particle readers share: making files and damaging them. */
#include "tests/particle_files.h"

#include <sys/stat.h>

void put_text(bytes *b, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    const int length = vsnprintf(b->data + b->n, sizeof b->data - b->n, format, args);
    va_end(args);
    assert_true(length >= 0 && b->n + (size_t)length < sizeof b->data);
    b->n += (size_t)length;
}

static uint64_t bits_of(ssfr_scalar type, double value)
{
    const float narrow = (float)value;
    uint32_t bits32;
    uint64_t bits64;
    memcpy(&bits32, &narrow, sizeof bits32);
    memcpy(&bits64, &value, sizeof bits64);
    if (type == SSFR_FLOAT32) return bits32;
    if (type == SSFR_FLOAT64) return bits64;
    return value < 0 ? (uint64_t)(int64_t)value : (uint64_t)value;
}

void put_number(bytes *b, ssfr_scalar type, bool big_endian, double value)
{
    const uint64_t bits = bits_of(type, value);
    const size_t size = ssfr_scalar_size(type);
    assert_true(b->n + size < sizeof b->data);
    for (size_t i = 0; i < size; i++) b->data[b->n++] = (char)(bits >> 8 * (big_endian ? size - 1 - i : i) & 0xff);
}

const char *particle_file(const char *name, const void *data, size_t size)
{
    static struct {
        char name[64];
        const char *path;
    } known[64];
    size_t i = 0;
    while (i < SSFR_COUNT(known) && known[i].path && strcmp(known[i].name, name) != 0) i++;
    assert_true(i < SSFR_COUNT(known));
    if (!known[i].path) {
        snprintf(known[i].name, sizeof known[i].name, "%s", name);
        known[i].path = test_path(name);
    }
    remove(known[i].path); /* some file systems wait for the disk when a file is written over */
    test_write_file(known[i].path, data, size);
    return known[i].path;
}

const char *text_file(const char *name, const char *text)
{
    return particle_file(name, text, strlen(text));
}

size_t find_particle(const ssfr_particles *particles, double x, double y, double z)
{
    const double place[3] = {x, y, z};
    size_t found = 0, n_found = 0;
    for (size_t i = 0; i < particles->n; i++) {
        double at[3];
        ssfr_particles_position(particles, i, at);
        const double d[3] = {at[0] - place[0], at[1] - place[1], at[2] - place[2]};
        if (sqrt(ssfr_dot(d, d)) < 1e-6) {
            found = i;
            n_found++;
        }
    }
    assert_int_equal(n_found, 1);
    return found;
}

ssfr_particles *load(const char *path)
{
    ssfr_particles *particles = NULL;
    test_clear_log();
    const ssfr_result result = ssfr_particles_load(&particles, path, NULL);
    if (result != SSFR_OK) fail_msg("%s", test_last_error());
    assert_int_equal(test_n_errors(), 0);
    return particles;
}

char told[512];

static void keep_told(void *user, ssfr_level level, const char *where, const char *text)
{
    (void)user, (void)where;
    const size_t used = strlen(told);
    if (level == SSFR_INFO || level == SSFR_WARNING) snprintf(told + used, sizeof told - used, "%s\n", text);
}

void save(const ssfr_particles *particles, const char *path)
{
    test_clear_log();
    if (ssfr_particles_save(particles, path) != SSFR_OK) fail_msg("%s", test_last_error());
}

void check_refused(const char *path, ssfr_result code, const char *text)
{
    ssfr_particles *p = NULL;
    assert_fails(code, ssfr_particles_load(&p, path, NULL), text);
    assert_null(p);
}

ssfr_particles *load_and_listen(void **state, const char *path)
{
    ssfr_particles *p = NULL;
    told[0] = '\0';
    ssfr_log_to(keep_told, NULL);
    const ssfr_result result = ssfr_particles_load(&p, path, NULL);
    test_capture_log(state);
    assert_int_equal(result, SSFR_OK);
    return p;
}

/* Particles, or one line and nothing else. */
static ssfr_result check_outcome(const char *path)
{
    ssfr_particles *particles = NULL;
    ssfr_load_options options = {.radius = 0.02385};
    test_clear_log();
    const ssfr_result result = ssfr_particles_load(&particles, path, &options);
    assert_int_equal(test_n_errors(), result == SSFR_OK ? 0 : 1);
    assert_null(strchr(test_last_error(), '\n'));
    assert_int_equal(particles != NULL, result == SSFR_OK);
    ssfr_particles_destroy(&particles);
    return result;
}

void check_truncations(const char *name, const void *data, size_t size)
{
    for (size_t n = 0; n < size; n++) check_outcome(particle_file(name, data, n));
    assert_int_equal(check_outcome(particle_file(name, data, size)), SSFR_OK);
}

void check_damage(const char *name, const void *data, size_t size)
{
    static const unsigned char values[] = {0, 1, 0x7f, 0x80, 0xff, ' ', '\n', '-', '9'};
    char damaged[sizeof(bytes)];
    assert_true(size <= sizeof damaged);
    memcpy(damaged, data, size);
    for (size_t i = 0; i < size; i++) {
        for (size_t v = 0; v < sizeof values; v++) {
            damaged[i] = (char)values[v];
            check_outcome(particle_file(name, damaged, size));
        }
        damaged[i] = ((const char *)data)[i];
    }
    assert_int_equal(check_outcome(particle_file(name, damaged, size)), SSFR_OK);
}

void check_no_files(const char *ending)
{
    char name[32];
    ssfr_particles *particles = NULL;
    snprintf(name, sizeof name, "missing%s", ending);
    assert_fails(SSFR_ERR_IO, ssfr_particles_load(&particles, test_path(name), NULL), "No such file");
    snprintf(name, sizeof name, "folder%s", ending);
    const char *folder = test_path(name);
    assert_int_equal(mkdir(folder, 0700), 0);
    assert_fails(SSFR_ERR_IO, ssfr_particles_load(&particles, folder, NULL), "not a regular file");
    assert_int_equal(remove(folder), 0);
    snprintf(name, sizeof name, "empty%s", ending);
    assert_fails(SSFR_ERR_FORMAT, ssfr_particles_load(&particles, particle_file(name, "", 0), NULL), name);
    assert_null(particles);
}
