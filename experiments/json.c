/* SPDX-License-Identifier: GPL-3.0-or-later */
/* json.c: writing JSON after RFC 8259. */
#include "experiments/json.h"

#include <assert.h>

/* Length of the valid UTF-8 sequence at text, 0 when there is none (RFC 3629: no overlong forms, no surrogates). */
static size_t utf8_length(const unsigned char *text)
{
    const unsigned char a = text[0];
    const size_t length = a < 0x80 ? 1 : a < 0xc2 ? 0 : a < 0xe0 ? 2 : a < 0xf0 ? 3 : a < 0xf5 ? 4 : 0;
    for (size_t i = 1; i < length; i++)
        if ((text[i] & 0xc0) != 0x80) return 0;
    const bool overlong = (a == 0xe0 && text[1] < 0xa0) || (a == 0xf0 && text[1] < 0x90);
    const bool outside = (a == 0xed && text[1] >= 0xa0) || (a == 0xf4 && text[1] >= 0x90);
    return overlong || outside ? 0 : length;
}

/* Bytes that are no UTF-8 (a path may hold any) become the replacement character. */
static void write_string(FILE *file, const char *string)
{
    const unsigned char *at = (const unsigned char *)string;
    fputc('"', file);
    while (*at) {
        const size_t length = utf8_length(at);
        if (length == 0)
            fputs("\\ufffd", file);
        else if (*at == '"' || *at == '\\')
            fprintf(file, "\\%c", *at);
        else if (*at == '\n')
            fputs("\\n", file);
        else if (*at == '\t')
            fputs("\\t", file);
        else if (*at < 0x20 || *at == 0x7f)
            fprintf(file, "\\u%04x", *at);
        else
            fwrite(at, 1, length, file);
        at += length ? length : 1;
    }
    fputc('"', file);
}

static void begin_value(ssfr_json *json, const char *key)
{
    assert(json->depth == 0 ? !key : (json->close[json->depth - 1] == '}') == (key != NULL));
    if (json->filled[json->depth]) fputc(',', json->file);
    json->filled[json->depth] = true;
    if (json->depth) fprintf(json->file, "\n%*s", 2 * json->depth, "");
    if (key) {
        write_string(json->file, key);
        fputs(": ", json->file);
    }
}

static void open_nest(ssfr_json *json, const char *key, char opening, char closing)
{
    begin_value(json, key);
    assert(json->depth < SSFR_JSON_DEPTH);
    fputc(opening, json->file);
    json->close[json->depth++] = closing;
    json->filled[json->depth] = false;
}

void ssfr_json_init(ssfr_json *json, FILE *file)
{
    *json = (ssfr_json){.file = file};
}

void ssfr_json_object(ssfr_json *json, const char *key)
{
    open_nest(json, key, '{', '}');
}

void ssfr_json_array(ssfr_json *json, const char *key)
{
    open_nest(json, key, '[', ']');
}

void ssfr_json_close(ssfr_json *json)
{
    assert(json->depth > 0);
    const bool filled = json->filled[json->depth--];
    if (filled) fprintf(json->file, "\n%*s", 2 * json->depth, "");
    fputc(json->close[json->depth], json->file);
    if (json->depth == 0) fputc('\n', json->file);
}

void ssfr_json_text(ssfr_json *json, const char *key, const char *text)
{
    begin_value(json, key);
    if (text)
        write_string(json->file, text);
    else
        fputs("null", json->file);
}

/* The shortest decimal that reads back as the same double. */
void ssfr_json_number(ssfr_json *json, const char *key, double value)
{
    char text[32] = "null";
    for (int digits = 6; isfinite(value) && digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        if (strtod(text, NULL) == value) break;
    }
    begin_value(json, key);
    fputs(text, json->file);
}

void ssfr_json_integer(ssfr_json *json, const char *key, long long value)
{
    begin_value(json, key);
    fprintf(json->file, "%lld", value);
}

void ssfr_json_flag(ssfr_json *json, const char *key, bool value)
{
    begin_value(json, key);
    fputs(value ? "true" : "false", json->file);
}
