/* SPDX-License-Identifier: MIT */
/* ssfr.h: screen-space fluid rendering, and what each of its approximations costs. The one header a user needs.
 *
 * Said once, for everything below:
 *  - SI units, unless a name carries its unit (_px, _ms, _deg). Angles are radians.
 *  - Eye space looks down -z: a visible point has z < 0. Depth images hold that z in metres. A pixel is a surface
 *    where fabs(z) < SSFR_SURFACE; empty pixels of a map of the nearest hold -SSFR_EMPTY, of the farthest +SSFR_EMPTY.
 *  - Row 0 of every image is its top row, on the CPU, on the GPU and in files. Colours are linear.
 *  - A function that can fail returns ssfr_result; a result by out pointer is NULL unless SSFR_OK is returned.
 *  - `params` and strings need only live for the call. Every _destroy takes the handle's address, accepts NULL
 *    inside it, and nulls it. */
#ifndef SSFR_H
#define SSFR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SSFR_VERSION "0.1.0"
#define SSFR_API __attribute__((visibility("default")))
#define SSFR_MUST __attribute__((warn_unused_result))
#define SSFR_EMPTY 1e30   /* m, magnitude of an empty depth */
#define SSFR_SURFACE 1e29 /* m, a depth below this magnitude is a surface */
#define SSFR_MAX_SIZE 16384 /* px, the widest and highest image */

/* ---- results and the log --------------------------------------------------------------------------------- */

#define SSFR_RESULTS(X)                                          \
    X(SSFR_OK, "no error")                                       \
    X(SSFR_ERR_VALUE, "a value is malformed or out of range")    \
    X(SSFR_ERR_UNKNOWN, "no such pass, parameter, slot or name") \
    X(SSFR_ERR_IO, "a file cannot be read or written")           \
    X(SSFR_ERR_FORMAT, "a file is malformed")                    \
    X(SSFR_ERR_UNSUPPORTED, "a format or feature is not supported") \
    X(SSFR_ERR_MEMORY, "out of memory")                          \
    X(SSFR_ERR_GL, "OpenGL is missing or reported an error")

typedef enum ssfr_result {
#define X(code, text) code,
    SSFR_RESULTS(X)
#undef X
} ssfr_result;

SSFR_API const char *ssfr_result_text(ssfr_result code);
SSFR_API const char *ssfr_version(void);

typedef enum ssfr_level { SSFR_ERROR, SSFR_WARNING, SSFR_INFO, SSFR_DEBUG } ssfr_level;

/* `where` is the source file and line. An error is logged once, where it is first known. */
typedef void ssfr_log_fn(void *user, ssfr_level level, const char *where, const char *text);

/* Sends the log to fn; NULL restores the default, which prints errors and warnings to stderr. */
SSFR_API void ssfr_log_to(ssfr_log_fn *fn, void *user);

/* ---- fields: images in double ------------------------------------------------------------------------------ */

typedef struct ssfr_field {
    int w, h, c;  /* px, px, channels */
    double *data; /* w h c values, rows from the top, channels interleaved */
} ssfr_field;

SSFR_API SSFR_MUST ssfr_result ssfr_field_create(ssfr_field **out, int w, int h, int c); /* zeroed */
SSFR_API void ssfr_field_destroy(ssfr_field **field);
SSFR_API void ssfr_field_fill(ssfr_field *field, double value);

static inline double *ssfr_field_at(const ssfr_field *f, int x, int y)
{
    return f->data + ((size_t)y * (size_t)f->w + (size_t)x) * (size_t)f->c;
}

/* ---- parameters ------------------------------------------------------------------------------------------------ */

typedef enum ssfr_param_type {
    SSFR_REAL,   /* double */
    SSFR_INT,    /* int */
    SSFR_FLAG,   /* int, 0 or 1 */
    SSFR_CHOICE, /* int, index into words */
    SSFR_SET,    /* unsigned, bit i is words[i]; written as a comma-separated list, "none" when empty */
} ssfr_param_type;

/* One row serves parsing, range checks, help, sweep axes and CSV columns. A list ends with a NULL name. */
typedef struct ssfr_param {
    const char *name;
    ssfr_param_type type;
    const char *unit; /* "1" for none */
    const char *help;
    size_t offset; /* into the params struct */
    double def, min, max; /* max is unused for words */
    const char *const *words; /* CHOICE and SET, NULL-terminated */
} ssfr_param;

/* ---- camera ---------------------------------------------------------------------------------------------------- */

typedef struct ssfr_camera {
    double eye[3];         /* m, world */
    double right[3], up[3], back[3]; /* orthonormal, world; the camera looks along -back */
    double tan_x, tan_y;   /* half the image's width and height at unit distance, (0, inf) */
    double near, far;      /* m, for methods that need window depth, 0 < near < far */
    int w, h;              /* px */
} ssfr_camera;

/* A camera at eye that looks at target. fov_y is the full vertical angle, (0, pi); pixels are square. near and far
 * are set to 0.01 and 1000 m. */
SSFR_API SSFR_MUST ssfr_result ssfr_camera_look(ssfr_camera *out, const double eye[3], const double target[3],
                                                const double up[3], double fov_y, int w, int h);

/* ---- particles ------------------------------------------------------------------------------------------------- */

/* Particles are sorted along a space-filling curve and cut into packets of SSFR_PACKET; the last may be shorter.
 * Positions are floats relative to their packet's centre, which is a double: a scene a thousand kilometres from
 * the origin is as exact as one at the origin. Arrays that a file lacks are NULL. */
enum { SSFR_PACKET = 64 };

typedef struct ssfr_packet {
    double centre[3]; /* m, world: the middle of the box */
    float half[3];    /* m, half extents of the box around the particle centres */
} ssfr_packet;

/* Of diffuse particles' kind, as data of SPlisHSPlasH have it. */
typedef enum ssfr_kind { SSFR_SPRAY, SSFR_FOAM, SSFR_BUBBLE } ssfr_kind;

/* Per-particle arrays beside position: name, C type, values a particle, unit. One line is one array everywhere. */
#define SSFR_ATTRIBUTES(X)        \
    X(velocity, float, 3, "m/s")  \
    X(density, float, 1, "kg/m^3") \
    X(lifetime, float, 1, "s")    \
    X(initial_lifetime, float, 1, "s") \
    X(age, float, 1, "s")         \
    X(neighbours, uint32_t, 1, "1") \
    X(id, uint32_t, 1, "1")       \
    X(kind, uint32_t, 1, "1")

typedef struct ssfr_particles {
    size_t n;
    size_t n_packets;
    ssfr_packet *packets;
    float *position; /* m, 3 n, relative to packets[i / SSFR_PACKET].centre */
#define X(name, type, count, unit) type *name;
    SSFR_ATTRIBUTES(X)
#undef X
    double radius;    /* m; 0 when neither the file nor the caller said */
    uint64_t serial;  /* differs between any two packed sets of a process: a key for caches */
} ssfr_particles;

/* Packs n particles at positions[3 n] (m, world). The arrays of `given` that are not NULL are copied, and its
 * radius; its n, packets and position are ignored. given may be NULL. Fails with SSFR_ERR_VALUE when a position
 * is not finite. */
SSFR_API SSFR_MUST ssfr_result ssfr_particles_create(ssfr_particles **out, size_t n, const double *positions,
                                                     const ssfr_particles *given);
SSFR_API void ssfr_particles_destroy(ssfr_particles **particles);

/* World position of particle i, m. */
static inline void ssfr_particles_position(const ssfr_particles *p, size_t i, double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = p->packets[i / SSFR_PACKET].centre[k] + (double)p->position[3 * i + (size_t)k];
}

typedef struct ssfr_load_options {
    double radius;       /* m; 0: from the file, else estimated (logged) */
    double unit;         /* m, the file's unit of length: positions, velocities and radius are multiplied by it; 0: 1 */
    char up;             /* the file's axis that points up, 'x', 'y' or 'z', which is turned to y; 0: y */
    const char *map;     /* HDF5: where a foreign file has its arrays, "position=/a/pos,velocity=/a/vel", or vectors in
                          * parts, "x=/a/x,y=/a/y,z=/a/z"; NULL: ssfr's own */
    bool drop_nonfinite; /* drop particles with a NaN or infinite value instead of refusing the file */
    size_t n_dropped;    /* out */
    bool estimated;      /* out: the radius was, see ssfr_particles_estimate_radius */
} ssfr_load_options;

/* The formats, one a line: ending and what it is, in brackets. A static string. */
SSFR_API const char *ssfr_particle_formats(void);

/* Reads a particle file; the format is told by the name's ending (see ssfr_particle_formats). options may be NULL. */
SSFR_API SSFR_MUST ssfr_result ssfr_particles_load(ssfr_particles **out, const char *path, ssfr_load_options *options);

/* Writes a particle file, aside and renamed when complete. */
SSFR_API SSFR_MUST ssfr_result ssfr_particles_save(const ssfr_particles *particles, const char *path);
/* Fails as ssfr_particles_save does where the name's ending is not one that is written: before long work. */
SSFR_API SSFR_MUST ssfr_result ssfr_particles_check_name(const char *path);

/* Half the median distance to the nearest other particle, from at most 512 samples, m; 0 for fewer than two. */
SSFR_API double ssfr_particles_spacing(const ssfr_particles *particles);

/* Bounds of the particle centres, m, world. Empty sets give zeros. */
SSFR_API void ssfr_particles_bounds(const ssfr_particles *particles, double lo[3], double hi[3]);

/* ---- what is computed from particles ----------------------------------------------------------------------------- */

/* The fluid's mass is split among balls of 0.8 of a cube of their diameter, as SPlisHSPlasH does: then particles at
 * rest are (0.8)^(1/3) diameters apart and a particle has about 40 neighbours in its support. */
#define SSFR_VOLUME_SHARE 0.8
#define SSFR_SUPPORT 4.0         /* of the radius: where the kernels end */
#define SSFR_REST_DENSITY 1000.0 /* kg/m^3 */

enum { SSFR_COMPUTED_DENSITY = 1, SSFR_COMPUTED_NEIGHBOURS = 2 };

/* Computes `density` (cubic spline, the particle itself included: alone it has 254.6 kg/m^3) and `neighbours` (others
 * nearer than the support) where these arrays are missing; those that are there stay. The bits of what was computed go
 * to *computed, which may be NULL. The same bits for any number of threads. Fails where there are particles without a
 * radius; a call that fails leaves the set as it was. */
SSFR_API SSFR_MUST ssfr_result ssfr_particles_complete(ssfr_particles *particles, unsigned *computed);

/* A radius for particles of which none is known, m: that at which half of them (512 samples at most) have the rest
 * density. Half the spacing where that is far off, as of sprays and of few particles; 0 for fewer than two. */
SSFR_API SSFR_MUST ssfr_result ssfr_particles_estimate_radius(const ssfr_particles *particles, double *radius);

/* What a particle counts as when it is drawn. */
typedef enum ssfr_class {
    SSFR_CLASS_LIQUID, /* what forms a surface */
    SSFR_CLASS_SPLASH, /* Imai 2016: drawn as a sphere of its own */
    SSFR_CLASS_FOAM,   /* Neto 2015: spray or foam */
    SSFR_CLASS_STRAY,  /* Neto 2015: not drawn */
    SSFR_N_CLASSES
} ssfr_class;

/* Imai 2016, sec. 4.1: a density below the threshold (kg/m^3; the paper has no number, half the rest density is a
 * start) is a splash. Fills classes[n], and counts[SSFR_N_CLASSES] unless it is NULL. */
SSFR_API SSFR_MUST ssfr_result ssfr_classify_by_density(const ssfr_particles *particles, double threshold,
                                                        unsigned char *classes, size_t *counts);
/* Neto 2015, eq. 3: up to t_stray neighbours (2 in fig. 6b) are a stray, up to t_foam (10) are foam. */
SSFR_API SSFR_MUST ssfr_result ssfr_classify_by_neighbours(const ssfr_particles *particles, int t_stray, int t_foam,
                                                           unsigned char *classes, size_t *counts);

/* Bagar 2010, secs 3.2.1 and 4.2: a particle turns to foam when its Weber number rho v^2 l / sigma reaches a threshold,
 * and back to water when it falls below. */
typedef enum ssfr_phase {
    SSFR_PHASE_WATER,         /* foam value 0 */
    SSFR_PHASE_WATER_TO_FOAM, /* rising */
    SSFR_PHASE_FOAM,          /* 1 */
    SSFR_PHASE_FOAM_TO_WATER, /* falling */
    SSFR_N_PHASES
} ssfr_phase;

enum {
    SSFR_TRANSITION_TIME,  /* foam values rise and fall in time (listings A.1, A.2) */
    SSFR_TRANSITION_WEBER, /* they are linear in the Weber number around the threshold (the text) */
};

enum {
    SSFR_START_IMPLIED, /* the first frame's particles are in the phase of their Weber numbers, as if for long */
    SSFR_START_WATER,   /* they are water, as all that appear later are (listing A.1) */
};

typedef struct ssfr_weber_params {
    int transition;
    int start;
    double threshold;  /* of the Weber number, [0, inf] */
    double length;     /* m, l, to 1e6; 0: the particle's diameter, as the text has it */
    double tension;    /* N/m, sigma, [1e-6, 1e6]; with l = 1 m and sigma = 1 N/m the number is rho v^2: listing A.1 */
    double band;       /* half the transition in the Weber number, in thresholds, [1e-3, 1] */
    double fade_in_min, fade_in_max; /* s, [0, 1e6], a particle takes a random time between these to turn to foam */
    double lifetime;                 /* s, [0, 1e6], and this to turn back, */
    double lifetime_share_min, lifetime_share_max; /* [0, 1000], times a random number between these */
    int lag;  /* frames that foam is late, 0 or 1: a step tells what the last one found, and that who is new is water */
    int seed; /* of the random numbers, from 0 */
} ssfr_weber_params;

SSFR_API ssfr_weber_params ssfr_weber_defaults(void);

/* The foam of a sequence of frames: phases are kept by the particles' ids. Random numbers come from the seed, the id
 * and how often it drew before: order and threads change nothing. */
typedef struct ssfr_weber ssfr_weber;

/* params NULL: the defaults. */
SSFR_API SSFR_MUST ssfr_result ssfr_weber_create(ssfr_weber **out, const ssfr_weber_params *params);
SSFR_API void ssfr_weber_destroy(ssfr_weber **weber);

/* Advances to the next frame, dt (s, from 0) after the last; the first call's dt has no meaning. Fills foam[n], in
 * [0, 1], lifetime[n] (s, since the particle last began to turn to foam; 0 for water) and phase[n] (ssfr_phase); each
 * may be NULL. Particles that were not in the last frame are new. What the first frame implies to be foam is so since a
 * random time. Needs velocity and density, and from the second frame on id (a frame without ids is the last). As in the
 * listings a particle takes one turn a call, and fades that began go on to their end. A call that fails changes no
 * state. */
SSFR_API SSFR_MUST ssfr_result ssfr_weber_step(ssfr_weber *weber, const ssfr_particles *particles, double dt,
                                               float *foam, float *lifetime, unsigned char *phase);
SSFR_API size_t ssfr_weber_bytes(const ssfr_weber *weber); /* memory held */

/* The threshold that makes a share of the particles foam: the least Weber number among the largest that are as many,
 * rounded; infinity for none. More are foam where others have the very same. params NULL: the defaults. */
SSFR_API SSFR_MUST ssfr_result ssfr_weber_threshold(const ssfr_particles *particles, const ssfr_weber_params *params,
                                                    double share, double *threshold);

/* Ellipsoids in place of spheres, after the spread of each particle's neighbours (Yu and Turk 2013, which Imai 2016
 * uses): flat where the liquid is flat. */
typedef struct ssfr_anisotropy_params {
    double search; /* how far neighbours count, in particle radii; 4: the support, twice the smoothing length */
    double lambda; /* how far a centre moves towards its neighbours' mean, [0, 1] */
    double k_r;    /* the longest semi-axis over the shortest, at most, from 1 */
    double k_s;    /* size: at 1 a particle amid others keeps its volume, its semi-axes are its radius */
    double k_n;    /* semi-axes of a particle with few neighbours, in radii */
    double k_max;  /* the longest semi-axis, in radii */
    int n_eps;     /* up to so many neighbours are few */
} ssfr_anisotropy_params;

SSFR_API ssfr_anisotropy_params ssfr_anisotropy_defaults(void);

/* The ellipsoid of particle i is centre + radius A u for |u| <= 1. Fills centre[3 n] (m, relative to the particle's
 * packet's centre) and shape[6 n] (the symmetric positive A as xx, xy, xz, yy, yz, zz, in particle radii, world axes).
 * The same bits for any number of threads. params NULL: the defaults. Needs a radius. */
SSFR_API SSFR_MUST ssfr_result ssfr_particles_anisotropy(const ssfr_particles *particles,
                                                         const ssfr_anisotropy_params *params, float *centre,
                                                         float *shape);

/* ---- scene: what a frame shows --------------------------------------------------------------------------------- */

/* A closed surface of triangles, in metres. */
typedef struct ssfr_mesh ssfr_mesh;

/* Vertices are xyz[3 n]; triangles are counter-clockwise seen from outside, three indices each. Fails with
 * SSFR_ERR_VALUE, and the counts, where triangles are degenerate or edges are not shared by exactly two triangles that
 * run along them in opposite directions. */
SSFR_API SSFR_MUST ssfr_result ssfr_mesh_create(ssfr_mesh **out, size_t n_vertices, const double *vertices,
                                                size_t n_triangles, const uint32_t *triangles);
/* Reads .obj, .stl or .ply; polygons are cut into triangles, vertices in the same place become one. */
SSFR_API SSFR_MUST ssfr_result ssfr_mesh_load(ssfr_mesh **out, const char *path);
SSFR_API void ssfr_mesh_destroy(ssfr_mesh **mesh);

/* In the solid's own axes, its centre at 0. */
typedef enum ssfr_shape {
    SSFR_BOX,      /* |x| <= half[0], |y| <= half[1], |z| <= half[2] */
    SSFR_CYLINDER, /* along y: radius half[0] = half[2], half height half[1]; hollow where inner > 0: a tube */
    SSFR_SPHERE,   /* of radius half[0] */
    SSFR_RAMP,     /* the box's half below the plane from its edge at -x, -y to that at +x, +y */
    SSFR_PLANE,    /* y <= 0, without end */
    SSFR_MESH,     /* the mesh */
} ssfr_shape;

typedef struct ssfr_solid {
    ssfr_shape shape;
    double centre[3];  /* m, world */
    double axis[3][3]; /* orthonormal rows, world, right-handed */
    double half[3];    /* m, (0, inf), where the shape has them */
    double inner;      /* m, inner radius of a tube, [0, half[0]) */
    const ssfr_mesh *mesh;
    double colour[3];  /* linear reflectance, [0, 1] */
} ssfr_solid;

enum { SSFR_MAX_SOLIDS = 64 };

typedef struct ssfr_scene {
    const ssfr_particles *particles; /* NULL for none; without particles (n = 0) they still tell the radius */
    ssfr_camera camera;
    const ssfr_solid *solids;
    int n_solids;     /* [0, SSFR_MAX_SOLIDS] */
    double floor;     /* m, world y of the ground plane; -inf for none */
    bool timed;       /* the frame is one of a sequence, at `time`: what passes keep from frame to frame goes on,
                       * where the last frame was timed and not later; else a lone one, without history */
    double time;      /* s; of no meaning unless timed */
    const ssfr_field *environment; /* NULL: the procedural sky. Linear radiance from all directions, 3 channels, laid
                                    * out as OpenEXR's latitude-longitude maps: row 0 looks up (+y), the middle column
                                    * along +z, and +x is a quarter from the left. A graph takes it anew when its
                                    * memory, its size or any of some thousand values spread over it are others */
} ssfr_scene;

/* ---- images: EXR and PNG ---------------------------------------------------------------------------------------- */

/* A named group of channels to write or read: an EXR channel per name, in the field's order. */
typedef struct ssfr_layer {
    const char *channels; /* comma-separated names, one a channel: "R,G,B" or "Z" */
    ssfr_field *field;
} ssfr_layer;

typedef struct ssfr_attribute { /* a number or, when text is not NULL, a string in an EXR header */
    const char *name;
    const char *text;
    double number;
} ssfr_attribute;

/* Writes 32-bit float channels, ZIP compressed, aside and renamed when complete. All layers have one size. */
SSFR_API SSFR_MUST ssfr_result ssfr_exr_save(const char *path, int n_layers, const ssfr_layer *layers,
                                             int n_attributes, const ssfr_attribute *attributes);
/* Reads the channels named (comma-separated) into one field; each must be there. Half, float and uint are widened. */
SSFR_API SSFR_MUST ssfr_result ssfr_exr_load(const char *path, const char *channels, ssfr_field **out);
/* The file's channel names, comma-separated in file order, as a string to free(). */
SSFR_API SSFR_MUST ssfr_result ssfr_exr_channels(const char *path, char **out);
/* The number of a double or float attribute; SSFR_ERR_UNKNOWN when the file lacks it. */
SSFR_API SSFR_MUST ssfr_result ssfr_exr_number(const char *path, const char *name, double *out);

/* 8-bit sRGB PNG of linear channels (1 or 3), clamped to [0, 1]; read back linear, as 3 channels, alpha dropped. */
SSFR_API SSFR_MUST ssfr_result ssfr_png_save(const char *path, const ssfr_field *field);
SSFR_API SSFR_MUST ssfr_result ssfr_png_load(const char *path, ssfr_field **out);

/* ---- GL -------------------------------------------------------------------------------------------------------- */

typedef struct ssfr_gl ssfr_gl;

typedef enum ssfr_gl_source {
    SSFR_GL_OWN,     /* a context of ssfr's own, without a window */
    SSFR_GL_CURRENT, /* the host program's current GL 4.5 core context, whose state is left as found */
} ssfr_gl_source;

SSFR_API SSFR_MUST ssfr_result ssfr_gl_create(ssfr_gl **out, ssfr_gl_source source);
SSFR_API void ssfr_gl_destroy(ssfr_gl **gl);
SSFR_API const char *ssfr_gl_renderer(const ssfr_gl *gl); /* "llvmpipe (...)" */
SSFR_API const char *ssfr_gl_vendor(const ssfr_gl *gl);
SSFR_API const char *ssfr_gl_version(const ssfr_gl *gl);
SSFR_API bool ssfr_gl_is_software(const ssfr_gl *gl);

/* ---- passes, pipelines, graph ---------------------------------------------------------------------------------- */

typedef struct ssfr_pass ssfr_pass;
typedef struct ssfr_pipeline ssfr_pipeline;
typedef struct ssfr_graph ssfr_graph;

SSFR_API const ssfr_pass *ssfr_pass_find(const char *name);   /* NULL when there is none */
SSFR_API const ssfr_pass *ssfr_pass_at(int i);                /* NULL past the end */
SSFR_API const char *ssfr_pass_name(const ssfr_pass *pass);
SSFR_API const char *ssfr_pass_help(const ssfr_pass *pass);
SSFR_API const char *ssfr_pass_source(const ssfr_pass *pass); /* the paper and section it follows */
SSFR_API const ssfr_param *ssfr_pass_params(const ssfr_pass *pass);

SSFR_API const ssfr_pipeline *ssfr_pipeline_find(const char *name);
SSFR_API const ssfr_pipeline *ssfr_pipeline_at(int i);
SSFR_API const char *ssfr_pipeline_name(const ssfr_pipeline *pipeline);
SSFR_API const char *ssfr_pipeline_help(const ssfr_pipeline *pipeline);

/* The scene-wide parameter groups that all pipelines share: "medium", "light", "sky", "floor". NULL past the end. */
SSFR_API const char *ssfr_group_at(int i, const ssfr_param **rows);

/* gl NULL: the graph runs the double-precision CPU twins. The gl must outlive the graph. */
SSFR_API SSFR_MUST ssfr_result ssfr_graph_create(ssfr_graph **out, const ssfr_pipeline *pipeline, ssfr_gl *gl);
SSFR_API void ssfr_graph_destroy(ssfr_graph **graph);

/* key is "node.param", "pass.param" (all nodes of the pass), "group.param" or "node.off" (flag). */
SSFR_API SSFR_MUST ssfr_result ssfr_graph_set(ssfr_graph *graph, const char *key, const char *value);
/* The value as text, written to text[size], cut where that is too small. */
SSFR_API SSFR_MUST ssfr_result ssfr_graph_get(const ssfr_graph *graph, const char *key, char *text, size_t size);
/* The row behind a key, NULL when there is none (then nothing is logged). */
SSFR_API const ssfr_param *ssfr_graph_row(const ssfr_graph *graph, const char *key);
/* The i-th full key "node.param" or "group.param" of this graph, NULL past the end; keys of off switches come last. */
SSFR_API const char *ssfr_graph_key_at(const ssfr_graph *graph, int i);

/* Wants a slot's last version beside those already wanted; NULL: wants nothing any more. A new graph wants the
 * pipeline's result. */
SSFR_API SSFR_MUST ssfr_result ssfr_graph_want(ssfr_graph *graph, const char *slot);
/* Wants every slot (true), or only what was asked for (false). */
SSFR_API void ssfr_graph_want_all(ssfr_graph *graph, bool all);

/* Gives a slot from outside instead of by its node: a field (copied), or the host's texture (GL; row 0 on top). NULL
 * and texture 0 take it back. The run fails when the size does not fit its frame: that of the camera, or that over a
 * power of two up to 32, rounded up; or one pixel for all, but of a depth of the fluid. Maps of the light may have any.
 * A depth of the fluid has z < 0 where it is a surface, which is checked in fields alone. It needs no particles, but a
 * radius where parameters are in particle radii: that of scene.particles, whose n may be 0. How far the fluid is, is
 * measured in fields, too: a texture without particles in view counts as at the near plane, and then curvature_flow.dt
 * should be set; shadows are looked for to camera.far. */
SSFR_API SSFR_MUST ssfr_result ssfr_graph_import(ssfr_graph *graph, const char *slot, const ssfr_field *field);
SSFR_API SSFR_MUST ssfr_result ssfr_graph_import_texture(ssfr_graph *graph, const char *slot, unsigned texture);
/* Writes the pipeline's result into the host's RGBA32F texture of the camera's size; 0: no longer. */
SSFR_API SSFR_MUST ssfr_result ssfr_graph_export_texture(ssfr_graph *graph, unsigned texture);
/* Takes positions from the host's buffer: n particles, stride floats apart, first at float `first`, relative to
 * origin (m, world). The scene's particles must be NULL then. buffer 0: no longer.
 * All are drawn, and their mean distance is that of at most 256 of them; the nearest counts as at the near plane. */
SSFR_API SSFR_MUST ssfr_result ssfr_graph_import_buffer(ssfr_graph *graph, unsigned buffer, size_t n, size_t stride,
                                                        size_t first, const double origin[3], double radius);

typedef struct ssfr_run_options {
    bool keep_all; /* leave nothing out (to prove that leaving out changes nothing) */
    bool no_culling; /* draw all particles, and on all tiles; keep_all does so, too */
    bool timing;   /* time each pass; on a software rasteriser this flushes between passes */
} ssfr_run_options;

/* Runs a frame and waits for it. options may be NULL. */
SSFR_API SSFR_MUST ssfr_result ssfr_graph_run(ssfr_graph *graph, const ssfr_scene *scene,
                                              const ssfr_run_options *options);

/* Plays a frame that is not drawn: runs the nodes that compute values of particles, so that those that keep something
 * from frame to frame have seen it. There is nothing to read until the next run. */
SSFR_API SSFR_MUST ssfr_result ssfr_graph_advance(ssfr_graph *graph, const ssfr_scene *scene);
/* How long before the scene's frame those begin that should be played first, s: as far back as matters to what nodes
 * that are read keep from frame to frame; one more may matter to what lags. Below 0: none, because no node keeps
 * anything, the scene is not timed, or they have all run for this frame. */
SSFR_API double ssfr_graph_history(ssfr_graph *graph, const ssfr_scene *scene);
/* What nodes keep from frame to frame is forgotten: the next frame has none before it. */
SSFR_API void ssfr_graph_restart(ssfr_graph *graph);

/* A slot of the last frame as a new field. A slot that was left out gives a 1x1 field of its neutral value. */
SSFR_API SSFR_MUST ssfr_result ssfr_graph_read(const ssfr_graph *graph, const char *slot, ssfr_field **out);
/* The same of a slot that holds values of particles: of each of *n particles as many as the slot has channels, in the
 * order of scene.particles. *n is 1 where all have the neutral value. They are the graph's, or the
 * particles', and valid until its next run. */
SSFR_API SSFR_MUST ssfr_result ssfr_graph_read_values(const ssfr_graph *graph, const char *slot, size_t *n,
                                                      const float **values);

/* The i-th image slot that this pipeline writes, NULL past the end. */
SSFR_API const char *ssfr_graph_slot_at(const ssfr_graph *graph, int i);
/* A slot's EXR channel names ("Z", "R,G,B", "N.X,N.Y,N.Z") and unit; NULL when there is no such slot. */
SSFR_API const char *ssfr_slot_channels(const char *slot);
SSFR_API const char *ssfr_slot_unit(const char *slot);

typedef enum ssfr_node_status {
    SSFR_RAN,      /* ran in the last frame */
    SSFR_OFF,      /* switched off by the user */
    SSFR_UNWANTED, /* left out: nobody reads what it writes */
    SSFR_NEEDLESS, /* left out: the scene or the parameters make it do nothing */
    SSFR_GIVEN,    /* left out: its outputs were imported */
} ssfr_node_status;

typedef struct ssfr_node_report {
    const char *node, *pass;
    const char *stage;   /* of the frame, as the paper divides it; "" for none */
    ssfr_node_status status;
    const char *why;     /* one line; "" when it ran */
    bool kept;           /* values of particles: of an earlier run, for the same particles and time; `ms` is its time */
    double ms;           /* GPU time by timestamps, or the wall time of what runs on the CPU; NaN without timing */
    double bytes;        /* fewest bytes the pass must move */
    double taps;         /* image samples or particles a written pixel */
    double iterations;   /* sweeps over the image */
    double vertices;     /* vertices drawn */
    double tiles;        /* of 32 x 32 pixels, that its sweeps draw in all */
    double unstable;     /* pixels whose step of smoothing is longer than what keeps it stable */
} ssfr_node_report;

typedef struct ssfr_report {
    int n_nodes;
    const ssfr_node_report *nodes; /* in execution order; owned by the graph, valid until its next run */
    double wall_ms;      /* wall clock around the finished frame */
    double cpu_ms;       /* of which planning and facts */
    double image_bytes;  /* held by the graph's images, copies of fields given included, the host's textures not */
    long allocations;    /* images and buffers allocated by the last run: 0 after the first of a kind */
    int n_particles;     /* in packets that touch the view; all with keep_all or no_culling */
    int n_packets;       /* of all particles; a host's buffer counts as if cut into packets, all in view */
    int n_packets_seen;  /* of them, that touch the view; all in the same cases */
    double covered;      /* share of the image's tiles that may hold fluid, [0, 1] */
} ssfr_report;

SSFR_API const ssfr_report *ssfr_graph_report(const ssfr_graph *graph);

/* One of the images and tables that a graph holds after a frame. */
typedef struct ssfr_memory {
    const char *name;    /* slot, or table */
    const char *node;    /* that writes it; "" for what is given, tables and the environment */
    const char *kind;    /* image; scratch: beside the node's outputs; given: a copy of a field; table; environment */
    int w, h, d, c;      /* px; channels of what is asked for */
    const char *format;  /* "RGBA16F", as the GPU stores them: three channels are four there; "R64F" on the CPU */
    double bytes;
} ssfr_memory;

/* The i-th of them, by nodes; false past the end. Their bytes are the image_bytes of the report; buffers of particles
 * are not among them. */
SSFR_API bool ssfr_graph_memory_at(const ssfr_graph *graph, int i, ssfr_memory *out);

#ifdef __cplusplus
}
#endif
#endif
