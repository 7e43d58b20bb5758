/* SPDX-License-Identifier: GPL-3.0-or-later */
/* meta.c: writing down everything that a table's numbers depend on. */
#include "experiments/meta.h"
#include "experiments/json.h"
#include "experiments/versions.h"

#include "base/param.h"

#include <errno.h>
#include <inttypes.h>
#include <omp.h>
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

/* The build names the commit that it was made from, with "-dirty" behind it when files differ from it. */
#ifndef SSFR_COMMIT
#define SSFR_COMMIT ""
#endif

enum { MAX_FILE = 16 << 20 };

/* ---- hashes ------------------------------------------------------------------------------------------------------ */

uint64_t ssfr_hash_particles(const ssfr_particles *particles)
{
    uint64_t hash = SSFR_HASH;
    for (size_t i = 0; i < particles->n; i++) {
        double position[3];
        ssfr_particles_position(particles, i, position);
        hash = ssfr_hash_bytes(hash, position, sizeof position);
    }
    return hash;
}

/* ---- parts ------------------------------------------------------------------------------------------------------- */

/* "Intel(R) ..." or "unknown". */
void ssfr_meta_processor(char *text, size_t size)
{
    char line[256];
    FILE *file = fopen("/proc/cpuinfo", "r");
    snprintf(text, size, "unknown");
    while (file && fgets(line, sizeof line, file)) {
        if (strncmp(line, "model name", 10) != 0 || !strchr(line, ':')) continue;
        const char *name = strchr(line, ':') + 1;
        name += strspn(name, " \t");
        snprintf(text, size, "%.*s", (int)strcspn(name, "\n"), name);
        break;
    }
    if (file) fclose(file);
}

uint64_t ssfr_meta_hash(void)
{
    char processor[256];
    ssfr_meta_processor(processor, sizeof processor);
    return ssfr_hash_text(ssfr_hash_text(ssfr_hash_text(SSFR_HASH, ssfr_version()), SSFR_COMMIT), processor);
}

const char *ssfr_meta_commit(void)
{
    return SSFR_COMMIT;
}

ssfr_result ssfr_meta_record_scene(ssfr_record *record, const ssfr_stage *stage)
{
    char text[24];
    const ssfr_result result = ssfr_record_stage(record, stage);
    snprintf(text, sizeof text, "%016" PRIx64, ssfr_hash_particles(stage->particles));
    return result == SSFR_OK ? ssfr_record_text(record, "scene.hash", text) : result;
}

static void put_program(ssfr_json *json, const ssfr_meta *meta)
{
    static const char dirty[] = "-dirty";
    const char *commit = ssfr_meta_commit();
    const size_t length = strlen(commit), end = strlen(dirty);
    const bool is_dirty = length > end && strcmp(commit + length - end, dirty) == 0;
    char text[64];
    time_t now = time(NULL);
    struct tm utc;
    ssfr_json_text(json, "ssfr", ssfr_version());
    snprintf(text, sizeof text, "%.*s", (int)(is_dirty ? length - end : length), commit);
    ssfr_json_text(json, "commit", length ? text : NULL);
    if (length)
        ssfr_json_flag(json, "dirty", is_dirty);
    else
        ssfr_json_text(json, "dirty", NULL);
    strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &utc));
    ssfr_json_text(json, "date", text);
    ssfr_json_array(json, "command");
    ssfr_json_text(json, NULL, "ssfr");
    for (int i = 0; i < meta->argc; i++) ssfr_json_text(json, NULL, meta->argv[i]);
    ssfr_json_close(json);
    ssfr_json_integer(json, "seed", meta->seed);
}

static void put_machine(ssfr_json *json, const ssfr_meta *meta)
{
    char text[256];
    struct utsname os;
    ssfr_json_object(json, "machine");
    ssfr_meta_processor(text, sizeof text);
    ssfr_json_text(json, "processor", text);
    ssfr_json_integer(json, "cores", sysconf(_SC_NPROCESSORS_ONLN));
    ssfr_json_integer(json, "threads", omp_get_max_threads());
    ssfr_json_number(json, "memory_bytes", (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE));
    ssfr_json_number(json, "copy_bytes_per_s", meta->bandwidth_cpu);
    if (uname(&os) == 0) {
        snprintf(text, sizeof text, "%.64s %.64s %.64s", os.sysname, os.release, os.machine);
        ssfr_json_text(json, "kernel", text);
    }
    ssfr_json_text(json, "compiler", "gcc " __VERSION__);
    ssfr_json_close(json);
    if (!meta->gl) return;
    ssfr_json_object(json, "gl");
    ssfr_json_text(json, "vendor", ssfr_gl_vendor(meta->gl));
    ssfr_json_text(json, "renderer", ssfr_gl_renderer(meta->gl));
    ssfr_json_text(json, "version", ssfr_gl_version(meta->gl));
    ssfr_json_flag(json, "software", ssfr_gl_is_software(meta->gl));
    ssfr_json_number(json, "copy_bytes_per_s", meta->bandwidth_gl);
    ssfr_json_close(json);
}

static void put_libraries(ssfr_json *json)
{
    ssfr_json_object(json, "libraries");
    for (int i = 0; ssfr_library_at(i).name; i++) {
        const ssfr_library library = ssfr_library_at(i);
        ssfr_json_text(json, library.name, library.version);
    }
    ssfr_json_close(json);
}

static void put_scenes(ssfr_json *json, const ssfr_meta *meta)
{
    ssfr_json_array(json, "scenes");
    for (int i = 0; i < meta->n_scenes; i++) {
        ssfr_json_object(json, NULL);
        ssfr_record_json(&meta->scenes[i], json);
        ssfr_json_close(json);
    }
    ssfr_json_close(json);
}

/* Parameters that an axis varies stand under axes alone. */
static ssfr_result put_parameters(ssfr_json *json, const ssfr_meta *meta)
{
    ssfr_record record = {0};
    const ssfr_result result = meta->graph ? ssfr_record_graph(&record, meta->graph) : SSFR_OK;
    if (meta->pipeline) ssfr_json_text(json, "pipeline", meta->pipeline);
    ssfr_json_object(json, "parameters");
    for (int i = 0; i < record.n; i++) {
        const ssfr_attribute *item = &record.items[i];
        if (!meta->spec || !ssfr_sweep_spec_axis(meta->spec, item->name)) ssfr_record_item_json(item, json);
    }
    if (meta->parameters) ssfr_record_json(meta->parameters, json);
    ssfr_json_close(json);
    ssfr_record_finish(&record);
    return result;
}

static void put_truth(ssfr_json *json, const ssfr_meta *meta)
{
    char key[128], text[256];
    const ssfr_param *row;
    const void *group;
    ssfr_json_object(json, "truth");
    ssfr_json_integer(json, "version", SSFR_TRUTH_VERSION);
    for (int i = 0; ssfr_truth_key_at(meta->truth, i, key, &row, &group); i++) {
        const bool words = row->type == SSFR_CHOICE || row->type == SSFR_SET;
        ssfr_param_format(row, group, text, sizeof text);
        if (meta->spec && ssfr_sweep_spec_axis(meta->spec, key)) continue;
        if (words)
            ssfr_json_text(json, key, text);
        else
            ssfr_json_number(json, key, ssfr_param_number(row, group));
    }
    ssfr_json_close(json);
}

/* A table's reader has the meaning of its columns at hand. */
static void put_columns(ssfr_json *json, const ssfr_meta *meta)
{
    ssfr_json_object(json, "columns");
    for (int i = 0; i < meta->n_columns; i++) {
        const ssfr_column *column = &meta->columns[i];
        char header[128];
        ssfr_column_header(column->name, column->unit, header, sizeof header);
        ssfr_json_text(json, header, column->help);
    }
    ssfr_json_close(json);
}

static void put_settings(ssfr_json *json, const char *name, const ssfr_settings *settings)
{
    ssfr_json_object(json, name);
    for (int i = 0; i < settings->n; i++) ssfr_json_text(json, settings->items[i].key, settings->items[i].value);
    ssfr_json_close(json);
}

static void put_variants(ssfr_json *json, const ssfr_sweep_spec *spec)
{
    ssfr_json_object(json, "variants");
    for (int i = 0; i < spec->n_variants; i++) {
        const ssfr_variant *variant = spec->variants[i];
        ssfr_json_object(json, variant->name);
        for (int k = 0; k < variant->own.n; k++)
            ssfr_json_text(json, variant->own.items[k].key, variant->own.items[k].value);
        put_settings(json, "set", &variant->settings);
        ssfr_json_close(json);
    }
    ssfr_json_close(json);
}

static void put_spec(ssfr_json *json, const ssfr_sweep_spec *spec)
{
    ssfr_json_object(json, "axes");
    for (int i = 0; i < spec->n_axes; i++) {
        ssfr_json_array(json, spec->axes[i].key);
        for (size_t k = 0; k < spec->axes[i].n; k++) ssfr_json_text(json, NULL, spec->axes[i].values[k]);
        ssfr_json_close(json);
    }
    ssfr_json_close(json);
    if (spec->n_variants > 0) put_variants(json, spec);
    if (spec->path.views > 0) {
        ssfr_json_object(json, "path");
        ssfr_json_number(json, "views", (double)spec->path.views);
        ssfr_json_text(json, "frames", spec->path.frames == SSFR_PATH_FOLLOW ? "follow" : "stand");
        ssfr_json_close(json);
    }
    if (spec->against.cells.n > 0) put_settings(json, "against", &spec->against.cells);
    if (spec->compared_with == SSFR_REFERENCE_TRUTH) ssfr_json_text(json, "reference", "truth");
    if (spec->compared_with == SSFR_REFERENCE_FRAME) put_settings(json, "reference", &spec->reference);
}

/* ---- the file ---------------------------------------------------------------------------------------------------- */

ssfr_result ssfr_meta_path(char **out, const char *table, const char *ending)
{
    const size_t length = strlen(table);
    const size_t stem = length > 4 && strcmp(table + length - 4, ".csv") == 0 ? length - 4 : length;
    return ssfr_text_print(out, "a path", "%.*s%s", (int)stem, table, ending);
}

static ssfr_result write_file(FILE *file, const char *path, const ssfr_meta *meta)
{
    ssfr_result result = SSFR_OK;
    ssfr_json json;
    char identity[24];
    ssfr_json_init(&json, file);
    ssfr_json_object(&json, NULL);
    put_program(&json, meta);
    snprintf(identity, sizeof identity, "%016" PRIx64, meta->identity);
    if (meta->identity) ssfr_json_text(&json, "identity", identity);
    put_machine(&json, meta);
    put_libraries(&json);
    if (meta->scale) ssfr_json_text(&json, "scale", meta->scale);
    put_scenes(&json, meta);
    SSFR_TRY(put_parameters(&json, meta));
    if (meta->spec) put_spec(&json, meta->spec);
    if (meta->truth) put_truth(&json, meta);
    put_columns(&json, meta);
    ssfr_json_close(&json);
end:
    if (ferror(file) && result == SSFR_OK) result = ssfr_fail(SSFR_ERR_IO, "%s: write error", path);
    return result;
}

ssfr_result ssfr_meta_save(const char *table, const ssfr_meta *meta)
{
    ssfr_result result = SSFR_OK;
    ssfr_aside aside = {0};
    char *path = NULL;
    FILE *file = NULL;
    SSFR_TRY(ssfr_meta_path(&path, table, ".meta.json"));
    SSFR_TRY(ssfr_aside_begin(&aside, path));
    file = fopen(aside.temporary, "w");
    if (!file) {
        result = ssfr_fail(SSFR_ERR_IO, "%s: %s", path, strerror(errno));
        goto end;
    }
    result = write_file(file, path, meta);
    if (fclose(file) != 0 && result == SSFR_OK) result = ssfr_fail(SSFR_ERR_IO, "%s: %s", path, strerror(errno));
end:
    result = ssfr_aside_end(&aside, result);
    free(path);
    return result;
}

ssfr_result ssfr_meta_check(const char *table, uint64_t identity)
{
    static const char key[] = "\"identity\": \"";
    ssfr_result result = SSFR_OK;
    char *path = NULL, *text = NULL;
    size_t size;
    SSFR_TRY(ssfr_meta_path(&path, table, ".meta.json"));
    if (access(path, F_OK) != 0) {
        ssfr_log(SSFR_WARNING, "%s: missing, so nothing tells whether the rows of %s were measured alike", path, table);
        goto end;
    }
    SSFR_TRY(ssfr_read_file(path, MAX_FILE, &text, &size));
    const char *at = strstr(text, key);
    if (!at)
        result = ssfr_fail(SSFR_ERR_FORMAT, "%s: has no identity, it is not of this program", path);
    else if (strtoull(at + strlen(key), NULL, 16) != identity)
        result = ssfr_fail(SSFR_ERR_VALUE,
                           "%s: was measured with other settings, scenes, hardware or another build, or at another "
                           "scale: nothing to resume; measure it anew, or elsewhere with -o",
                           table);
end:
    free(text);
    free(path);
    return result;
}
