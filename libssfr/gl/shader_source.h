/* SPDX-License-Identifier: MIT */
/* shader_source.h: the shaders embedded at build time, one entry a file of shaders/. */
#ifndef SSFR_SHADER_SOURCE_H
#define SSFR_SHADER_SOURCE_H

typedef struct ssfr_shader_source {
    const char *name; /* file name, "bilateral.frag"; NULL ends the list */
    const char *text;
} ssfr_shader_source;

extern const ssfr_shader_source ssfr_shader_sources[];

#endif
