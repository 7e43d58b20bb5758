/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sweep_spec_internal.h: the parts of a sweep as its reader puts them together. */
#ifndef SSFR_SWEEP_SPEC_INTERNAL_H
#define SSFR_SWEEP_SPEC_INTERNAL_H

#include "experiments/sweep_spec.h"
#include "experiments/yaml_tree.h"

/* Of at most n values, which are added one by one; finish it also when this fails. */
SSFR_MUST ssfr_result ssfr_axis_init(ssfr_axis *axis, const char *where, const char *key, size_t n);
/* A value that stands there already is refused. */
SSFR_MUST ssfr_result ssfr_axis_add(ssfr_axis *axis, const char *text, size_t length);
void ssfr_axis_finish(ssfr_axis *axis);
/* Fails unless it is the key of an axis. */
SSFR_MUST ssfr_result ssfr_axis_check_key(const char *where, const char *key);

SSFR_MUST ssfr_result ssfr_settings_add(ssfr_settings *settings, const char *where, const char *key,
                                        const char *value);

/* Takes over the axis, also when it fails; one of the same key is replaced, in its place. */
SSFR_MUST ssfr_result ssfr_sweep_spec_put(ssfr_sweep_spec *spec, ssfr_axis *axis);
/* The axis `view` of as many as the path has. */
SSFR_MUST ssfr_result ssfr_sweep_spec_put_views(ssfr_sweep_spec *spec, const char *where);

/* Reader of a row: ssfr_published_spec, to be finished also when it fails. */
ssfr_yaml_read ssfr_published_spec_read;
void ssfr_published_spec_finish(ssfr_published_spec *published);

#endif
