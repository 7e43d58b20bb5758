/* SPDX-License-Identifier: GPL-3.0-or-later */
/* output.h: where results go: told apart by their endings, and looked at before long work starts. */
#ifndef SSFR_OUTPUT_H
#define SSFR_OUTPUT_H

#include "base/base.h"

typedef enum ssfr_output_kind { SSFR_OUTPUT_OTHER, SSFR_OUTPUT_EXR, SSFR_OUTPUT_PNG } ssfr_output_kind;

/* By the ending of the name, in either case. */
ssfr_output_kind ssfr_output_kind_of(const char *path);

/* A file that can be written: its folder is there, and it is a regular file or a new one. What is written aside is
 * renamed into place, which would replace a device or a pipe. */
SSFR_MUST ssfr_result ssfr_output_check_file(const char *path);

/* The same of an .exr or .png (or only .exr). */
SSFR_MUST ssfr_result ssfr_output_check_image(const char *path, bool png_too);

/* Whoever goes on with a table says with which: output NULL is none. */
SSFR_MUST ssfr_result ssfr_output_check_resume(bool resume, const char *output);

/* A folder that can be written to, or that can be made. */
SSFR_MUST ssfr_result ssfr_output_check_folder(const char *path);
SSFR_MUST ssfr_result ssfr_output_make_folder(const char *path);

#endif
