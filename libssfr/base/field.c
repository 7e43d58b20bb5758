/* SPDX-License-Identifier: MIT */
/* field.c: images in double. */
#include "base/field.h"

ssfr_result ssfr_field_create(ssfr_field **out, int w, int h, int c)
{
    ssfr_result result = SSFR_OK;
    ssfr_field *field = NULL;
    *out = NULL;
    if (w < 1 || h < 1 || w > SSFR_MAX_SIZE || h > SSFR_MAX_SIZE || c < 1 || c > 16)
        return ssfr_fail(SSFR_ERR_VALUE,
                         "image of %d x %d pixels and %d channels: sides go from 1 to %d, channels from 1 to 16", w, h,
                         c, SSFR_MAX_SIZE);
    SSFR_TRY(ssfr_alloc(&field, 1, sizeof *field, "a field"));
    *field = (ssfr_field){.w = w, .h = h, .c = c};
    SSFR_TRY(ssfr_alloc(&field->data, (size_t)w * (size_t)h * (size_t)c, sizeof *field->data, "an image"));
    *out = field;
    field = NULL;
end:
    ssfr_field_destroy(&field);
    return result;
}

void ssfr_field_destroy(ssfr_field **field)
{
    if (*field) free((*field)->data);
    free(*field);
    *field = NULL;
}

static size_t n_values(const ssfr_field *f)
{
    return (size_t)f->w * (size_t)f->h * (size_t)f->c;
}

void ssfr_field_fill(ssfr_field *field, double value)
{
    const size_t n = n_values(field);
    for (size_t i = 0; i < n; i++) field->data[i] = value;
}

void ssfr_field_round(ssfr_field *field)
{
    const size_t n = n_values(field);
    for (size_t i = 0; i < n; i++) field->data[i] = (double)(float)field->data[i];
}

ssfr_result ssfr_field_copy(ssfr_field **out, const ssfr_field *from)
{
    const ssfr_result result = ssfr_field_create(out, from->w, from->h, from->c);
    if (result == SSFR_OK) memcpy((*out)->data, from->data, n_values(from) * sizeof *from->data);
    return result;
}
