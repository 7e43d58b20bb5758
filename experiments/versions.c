/* SPDX-License-Identifier: GPL-3.0-or-later */
/* versions.c: asking each library for its version at run time; OpenCV's, which C cannot ask, is that of its headers. */
#include "experiments/versions.h"

#include <gsl/gsl_version.h>
#include <hdf5.h>
#include <opencv4/opencv2/core/version.hpp>
#include <openexr.h>
#include <png.h>
#include <yaml.h>
#include <zlib.h>

static void say_openexr(char *text, size_t size)
{
    int major = 0, minor = 0, patch = 0;
    exr_get_library_version(&major, &minor, &patch, NULL);
    snprintf(text, size, "%d.%d.%d", major, minor, patch);
}

static void say_hdf5(char *text, size_t size)
{
    unsigned major = 0, minor = 0, release = 0;
    H5get_libversion(&major, &minor, &release);
    snprintf(text, size, "%u.%u.%u", major, minor, release);
}

static void say_png(char *text, size_t size)
{
    snprintf(text, size, "%s", png_get_libpng_ver(NULL));
}

static void say_zlib(char *text, size_t size)
{
    snprintf(text, size, "%s", zlibVersion());
}

static void say_gsl(char *text, size_t size)
{
    snprintf(text, size, "%s", gsl_version);
}

static void say_yaml(char *text, size_t size)
{
    snprintf(text, size, "%s", yaml_get_version_string());
}

static void say_opencv(char *text, size_t size)
{
    snprintf(text, size, "%s", CV_VERSION);
}

static const struct {
    const char *name;
    void (*say)(char *text, size_t size);
} libraries[] = {
    {"OpenEXR", say_openexr}, {"libpng", say_png},   {"zlib", say_zlib},     {"HDF5", say_hdf5},
    {"GSL", say_gsl},         {"libyaml", say_yaml}, {"OpenCV", say_opencv},
};

ssfr_library ssfr_library_at(int i)
{
    ssfr_library library = {0};
    if (i < 0 || (size_t)i >= SSFR_COUNT(libraries)) return library;
    library.name = libraries[i].name;
    libraries[i].say(library.version, sizeof library.version);
    return library;
}
