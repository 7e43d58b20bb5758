/* SPDX-License-Identifier: MIT */
/* frame.h: what is the same for all nodes of one frame: camera, world, facts about the scene. */
#ifndef SSFR_FRAME_H
#define SSFR_FRAME_H

#include "base/base.h"

enum { SSFR_TILE = 32 }; /* px at full resolution; divisors of the resolution divide it */
enum { SSFR_SOLID_WORDS = SSFR_MAX_SOLIDS / 32 }; /* that hold a bit a solid */

/* Which of the frame's solids, a bit each. */
typedef uint32_t ssfr_solid_set[SSFR_SOLID_WORDS];

/* The scene-wide parameter groups. One line is one group: member, type, rows (in frame.c). */
#define SSFR_GROUPS(X)               \
    X(medium, ssfr_medium)           \
    X(light, ssfr_light)             \
    X(sky, ssfr_sky)                 \
    X(floor, ssfr_floor)

typedef struct ssfr_medium {
    double ior;                                         /* index of refraction */
    double absorption_r, absorption_g, absorption_b;    /* 1/m */
    double color_r, color_g, color_b;                   /* linear, what infinitely thick fluid shows */
} ssfr_medium;

typedef struct ssfr_light {
    double azimuth_deg, elevation_deg; /* towards the light, from +x to +z, above the horizon */
    double intensity;
    double ambient;                    /* share of the light that reaches shaded faces of solids */
} ssfr_light;

typedef struct ssfr_sky {
    double zenith_r, zenith_g, zenith_b;
    double horizon_r, horizon_g, horizon_b;
} ssfr_sky;

typedef struct ssfr_floor {
    double tile;                /* m, side of a chequered tile */
    double light, dark;         /* linear reflectance of the two kinds of tile */
    double haze;                /* m */
} ssfr_floor;

typedef struct ssfr_world {
#define X(name, type) type name;
    SSFR_GROUPS(X)
#undef X
} ssfr_world;

/* What shaders read as the uniform block Frame (shaders/common.glsl, vec4 by vec4) and the twins as it stands.
 * World directions have world axes; positions are relative to the eye, so that no large number reaches a float. */
typedef struct ssfr_block {
    double image[4];       /* w px, h px, c_x, c_y: eye-space width and height of a pixel at unit depth */
    double right[4];       /* xyz: eye-space x axis in world; w: floor's y minus the eye's, m, -SSFR_EMPTY for none */
    double up[4];          /* xyz: eye-space y axis; w: the eye's x modulo two tiles, m */
    double back[4];        /* xyz: eye-space z axis; w: the eye's z modulo two tiles, m */
    double light[4];       /* xyz: unit vector towards the light, world; w: intensity */
    double absorption[4];  /* rgb, 1/m; w: index of refraction */
    double fluid[4];       /* rgb: colour of infinitely thick fluid; w: ambient */
    double zenith[4];      /* rgb; w: number of solids */
    double horizon[4];     /* rgb; w: near distance, m */
    double floor[4];       /* tile m, light, dark, haze m */
    double map[4];         /* w px, h px of the environment's map; 0: none */
    /* Centre relative to the eye, of a mesh its middle, of a plane its point next to the eye, w: square of a radius
     * around it that holds the solid, m^2; the axes with the half extent in w; colour; shape, inner radius and the
     * mesh's first node. */
    double solid[SSFR_MAX_SOLIDS][6][4];
} ssfr_block;

typedef enum ssfr_tile_kind { SSFR_TILE_PLAIN, SSFR_TILE_SOLIDS, SSFR_TILE_MESHES, SSFR_N_TILE_KINDS } ssfr_tile_kind;

/* Counted once a frame, on the CPU, from packets: every number is a safe bound. */
typedef struct ssfr_facts {
    size_t n_particles;   /* in packets that touch the view */
    size_t n_packets;     /* that touch the view */
    bool fluid;           /* false: nothing in view is fluid, for there is no particle and no depth of it is given */
    bool layers;          /* foam or a thickness is given, which may show where no other fluid is in view */
    bool seen;            /* particles in view say where the fluid is */
    double nearest;       /* m, no particle's surface in view is nearer to the eye plane; >= the camera's near */
    double mean;          /* m, mean distance of the particles in view from the eye plane; >= near */
    /* m, from the eye along light_axis: fluid in view is between; lo > hi: there is none, or no solid */
    double lit_lo[3], lit_hi[3];
    int n_ranges;         /* runs of consecutive visible particles */
    int *first, *count;   /* of each run, in particles */
    int tiles_x, tiles_y; /* the image in tiles */
    int n_tiles;          /* that may hold fluid */
    uint32_t *tiles;      /* x + 65536 y each */
    unsigned char *mask;  /* tiles_x tiles_y, scratch */
    double covered;       /* n_tiles over all */
    ssfr_solid_set *solids; /* a tile's, row by row: bit i says that solid i may be seen in it */
    uint32_t *by_solids;  /* all tiles, as in `tiles`: first those without, then those with solids, then with meshes */
    int n_by_solids[SSFR_N_TILE_KINDS];
} ssfr_facts;

typedef struct ssfr_frame {
    const ssfr_scene *scene;
    const ssfr_particles *particles; /* NULL when the positions are in the host's buffer */
    size_t n_particles;
    double radius;                   /* m */
    int w, h;                        /* px */
    double near;                     /* m */
    size_t n_packets;
    double (*offset)[3];             /* m, eye-space packet centres */
    double rotation[3][3];           /* eye from world */
    double light_axis[3][3];         /* unit, right-handed, world: two across the light, and towards it */
    ssfr_block block;
    ssfr_facts facts;
    int n_solids;
    ssfr_solid solids[SSFR_MAX_SOLIDS]; /* the scene's, their centres relative to the eye */
    int n_meshes;
    const ssfr_mesh *meshes[SSFR_MAX_SOLIDS]; /* the solids', each once */
    size_t first_node[SSFR_MAX_SOLIDS];       /* of each mesh, when all their nodes stand in one array */
    size_t n_nodes, n_triangles;              /* of all meshes */
    uint64_t environment_key;                 /* of the environment that was found well; 0: none */
    size_t cap_packets, cap_tiles;   /* allocated */
} ssfr_frame;

void ssfr_world_default(ssfr_world *world);
/* Rows and address of the i-th group; NULL past the end. */
const char *ssfr_world_group(int i, const ssfr_param **rows, size_t *offset);

/* What is not left out though nobody sees it, a bit each. */
typedef enum ssfr_keep {
    SSFR_KEEP_PARTICLES = 1, /* all packets are drawn, and on all tiles */
    SSFR_KEEP_SOLIDS = 2,    /* every tile asks for all solids */
    SSFR_KEEP_ALL = 3,
} ssfr_keep;

/* Fills the frame from the scene and the world. reach: how far splats extend, in particle radii; keep: of ssfr_keep.
 * *grew counts allocations: none when the sizes are as before. */
SSFR_MUST ssfr_result ssfr_frame_prepare(ssfr_frame *frame, const ssfr_scene *scene, const ssfr_world *world,
                                         double reach, unsigned keep, long *grew);
/* The same for n particles in a host's buffer, relative to origin: nothing is known of where they are. */
SSFR_MUST ssfr_result ssfr_frame_prepare_host(ssfr_frame *frame, const ssfr_scene *scene, const ssfr_world *world,
                                              size_t n, const double origin[3], double radius, unsigned keep,
                                              long *grew);
/* Some of the host's positions, spread evenly: the mean distance of those in view stands for that of all. */
void ssfr_frame_sample_host(ssfr_frame *frame, size_t n, const float (*positions)[3]);
/* There may be fluid in every tile, between these distances (m); 0: not known. Where no particle in view says how far
 * it is, these do. */
void ssfr_frame_assume_fluid(ssfr_frame *frame, double nearest, double mean, double farthest);
/* There may be layers of fluid in every tile. */
void ssfr_frame_assume_layers(ssfr_frame *frame);
void ssfr_frame_finish(ssfr_frame *frame);

/* All solids of the frame. */
static inline void ssfr_frame_all_solids(const ssfr_frame *frame, ssfr_solid_set out)
{
    for (int i = 0; i < SSFR_SOLID_WORDS; i++) {
        const int n = ssfr_clamp_int(frame->n_solids - 32 * i, 0, 32);
        out[i] = n == 32 ? UINT32_MAX : (1u << n) - 1;
    }
}

/* Eye-space position of particle i, m. */
static inline void ssfr_frame_eye(const ssfr_frame *frame, size_t i, double out[3])
{
    const double *offset = frame->offset[i / SSFR_PACKET];
    const float *p = frame->particles->position + 3 * i;
    for (int k = 0; k < 3; k++)
        out[k] = offset[k] + frame->rotation[k][0] * (double)p[0] + frame->rotation[k][1] * (double)p[1] +
                 frame->rotation[k][2] * (double)p[2];
}

#endif
