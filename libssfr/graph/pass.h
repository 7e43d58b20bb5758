/* SPDX-License-Identifier: MIT */
/* pass.h: what a pass is, what a node and a pipeline are, and what a pass gets when it runs.
 *
 *      slot ---in---> [ node = pass + params ] ---out---> slot
 *
 * A pass is one algorithm, twice: cpu_run in double, the specification, and the shaders. It allocates nothing. */
#ifndef SSFR_PASS_H
#define SSFR_PASS_H

#include "base/field.h"
#include "base/half.h"
#include "base/lookup.h"
#include "base/param.h"
#include "graph/frame.h"

enum { SSFR_MAX_PORTS = 12, SSFR_MAX_OUTPUTS = 4, SSFR_MAX_SCRATCH = 2, SSFR_MAX_PROGRAMS = 4,
       SSFR_MAX_VALUES = 4, /* ports of a pass that carry values of particles */
       SSFR_MAX_TABLES = 3, /* that a pass may read */
       SSFR_DEFINES = 128 /* bytes */,
       SSFR_COUNTS = 2 /* the first of the words that a run is lent: the GPU gives them back */ };

typedef enum ssfr_slot_id {
    SSFR_NO_SLOT, /* a port that is not named in a node keeps its own slot */
#define X(kind, name, channels, exr, unit, neutral, help) SSFR_SLOT_##name,
#include "graph/slots.def"
#undef X
    SSFR_N_SLOTS
} ssfr_slot_id;

typedef enum ssfr_slot_kind {
    SSFR_IMAGE,     /* of the view: of its resolution, or of a part of that */
    SSFR_MAP,       /* an image of another view, or of none: its writer says its size */
    SSFR_PARTICLES, /* values of each particle */
} ssfr_slot_kind;

typedef struct ssfr_slot {
    ssfr_slot_kind kind;
    const char *name;
    int channels;
    const char *exr, *unit;
    double neutral;
    const char *help;
} ssfr_slot;

extern const ssfr_slot ssfr_slots[SSFR_N_SLOTS];
ssfr_slot_id ssfr_slot_find(const char *name); /* SSFR_NO_SLOT when there is none */
bool ssfr_slot_is_fluid(ssfr_slot_id slot);    /* a depth that says where fluid is */
bool ssfr_slot_is_layer(ssfr_slot_id slot);    /* foam, or a thickness: it shows without a depth of the fluid */

/* What a particle slot holds: `c` values of each of n particles, in their packed order. They are floats, as particles
 * are: then the scene's own arrays are read where they stand, and both twins read the same bits. */
typedef struct ssfr_values {
    size_t n;
    int c;
    bool same;         /* one entry for all particles: the slot's neutral value; n is 1 */
    const float *data; /* n c */
} ssfr_values;

static inline const float *ssfr_values_at(const ssfr_values *v, size_t i)
{
    return v->data + (v->same ? 0 : i * (size_t)v->c);
}

/* A port carries images like those of `slot` (channels, neutral value), which is also its binding by default, or values
 * of particles. */
typedef struct ssfr_port {
    const char *name; /* NULL ends a list; the sampler is t_<name> */
    ssfr_slot_id slot;
    bool any_size;    /* inputs: may be of a lower resolution than the outputs, of a higher one if shrink is there */
    /* outputs: */
    bool optional;    /* left out where nobody wants it; those come last, after one that is not */
    const char *like; /* the input whose size it has; NULL for the frame's */
    const char *from; /* the input that takes its place when the node is left out; NULL for the neutral value */
    const char *over; /* the input that the output begins as, to be drawn over; NULL: the neutral value */
    bool widens;      /* inputs of values: they multiply how far a particle's splat reaches */
} ssfr_port;

/* A coefficient that the shaders see as a uniform: `n` doubles at `offset` of the coefficients become float, vec2..
 * or int. */
typedef struct ssfr_uniform {
    const char *name; /* NULL ends a list */
    size_t offset;
    int n;            /* 1 to 4 reals, or 0: one int */
} ssfr_uniform;

typedef struct ssfr_program_row {
    const char *vert, *frag, *defines;
} ssfr_program_row;

/* A constant table that a pass looks things up in where a choice among its parameters is this word. It is made when a
 * node that does first runs, once for all nodes of a graph. */
typedef struct ssfr_lookup_use {
    const ssfr_lookup *table; /* NULL ends a list */
    size_t choice;            /* its offset in the parameters */
    int word;
} ssfr_lookup_use;

/* One execution of one node: everything that both twins may know. */
typedef struct ssfr_run {
    const ssfr_frame *frame;
    const void *params, *coeffs;
    int divisor_in[SSFR_MAX_PORTS]; /* resolution divisor of each input */
    int divisor;    /* of the outputs */
    int w, h;       /* px, of the outputs */
    int n_out;      /* outputs that the frame needs and somebody wants, the first ones */
    bool is_neutral[SSFR_MAX_PORTS]; /* inputs that are images which nobody made in this frame: one neutral pixel */
    /* the CPU twin */
    const ssfr_field *in[SSFR_MAX_PORTS];
    ssfr_field *out[SSFR_MAX_OUTPUTS]; /* NULL from n_out on */
    ssfr_field *scratch[SSFR_MAX_SCRATCH];
    const ssfr_texels *tables[SSFR_MAX_TABLES]; /* in the order of the pass's; NULL: not read */
    /* As many as n_words says, zero at first. On the GPU a buffer of the shaders is in their place, and when the frame
     * is finished its first SSFR_COUNTS stand here. */
    uint32_t *words;
    /* Ports that carry values of particles are counted apart: the j-th is values[j]; NULL past the last. */
    const ssfr_values *values[SSFR_MAX_VALUES];
    size_t n_valued[SSFR_MAX_VALUES]; /* particles in view with a value that is not 0; not for particles_run */
    /* particles_run */
    float *values_out[SSFR_MAX_OUTPUTS]; /* for frame->particles */
    void *state;  /* state_size bytes, zeroed at first, kept from run to run */
    double dt;    /* s, from 0: since the frame that this node ran for last; NaN: there is no history to go on from */
    /* the GPU twin; what these point to is in gl/ */
    struct ssfr_draw *draw;
} ssfr_run;

/* `needed` and `needless` of passes that do nothing without fluid, or without what shows of it. */
static inline bool ssfr_needs_fluid(const ssfr_run *run) { return run->frame->facts.fluid; }
static inline bool ssfr_needs_layers(const ssfr_run *run)
{
    return run->frame->facts.fluid || run->frame->facts.layers;
}
#define SSFR_NO_FLUID "no fluid in view"

typedef struct ssfr_tolerance { /* between the twins, per value: |gl - cpu| <= abs + rel |cpu| */
    double abs, rel;
    double outliers; /* share of values that may exceed it: silhouettes, where a float decides otherwise */
} ssfr_tolerance;

struct ssfr_pass {
    const char *name, *source, *help;
    ssfr_port inputs[SSFR_MAX_PORTS];
    ssfr_port outputs[SSFR_MAX_OUTPUTS + 1];
    ssfr_lookup_use tables[SSFR_MAX_TABLES + 1];
    const ssfr_param *params;
    size_t params_size, coeffs_size;
    int n_scratch;     /* images like output 0 that the graph lends */
    size_t (*n_words)(const ssfr_run *run); /* that the graph lends, 0 or from SSFR_COUNTS; NULL: none */
    double taps;       /* samples a written pixel, where they are always as many; 0: one of each input */
    bool whole_screen; /* writes every pixel; else only tiles with fluid, the rest is neutral */
    bool uses_ids;     /* draws particles by id: the ids are uploaded */

    /* Coefficients from parameters, once a frame, for both twins. */
    void (*derive)(const ssfr_run *run, void *coeffs);
    /* False when the node would change nothing; `needless` says when that is. NULL: always needed. */
    bool (*needed)(const ssfr_run *run);
    const char *needless;
    /* False for an input that goes unread with these parameters: nothing is run for it, and it holds the neutral value.
     * NULL: all are read. */
    bool (*reads)(const void *params, int port);
    /* By what its outputs' resolution divisor exceeds its input's. NULL: 1. */
    int (*shrink)(const void *params);
    /* How many of the outputs, the first ones, the frame needs, from 1: the others would be neutral everywhere, and are
     * not made. By facts, parameters and is_neutral. NULL: all. Made all the same, they must be neutral, and the rest
     * change no bit. */
    int (*n_needed)(const ssfr_run *run);
    /* What the GPU stores the outputs and scratch in: as halves it rounds what it writes, and every sum of blending.
     * cpu_run rounds as often, by ssfr_half_round. NULL: floats. */
    ssfr_storage (*storage)(const void *params);
    /* Outputs that are maps: their size, px; in: that of the first input, where this is a map, else 1 x 1. Such a pass
     * writes every pixel (whole_screen). NULL: its outputs are images of the view. */
    void (*size)(const void *params, const int in[2], int out[2]);
    /* How far splats reach from a particle, in particle radii. NULL: no splats. */
    double (*reach)(const void *params);

    void (*cpu_run)(const ssfr_run *run);

    /* In the place of cpu_run and programs: the pass reads and writes values of particles alone. It runs on the CPU on
     * both backends, before anything is planned, and not again for the same particles, time and parameters. */
    ssfr_result (*particles_run)(const ssfr_run *run);
    size_t state_size;
    void (*state_finish)(void *state);
    /* How far back frames matter to it, s, but for one more. With state_size. */
    double (*history)(const void *params);

    ssfr_program_row programs[SSFR_MAX_PROGRAMS + 1];
    /* Lines after #version in the place of the row's, by what the frame needs of program i; false: it does not run in
     * this frame. NULL: the row's own lines. */
    bool (*defines)(const ssfr_run *run, int i, char text[SSFR_DEFINES]);
    const ssfr_uniform *uniforms;
    /* NULL: program 0, once over the outputs. */
    ssfr_result (*gl_run)(const ssfr_run *run);

    /* Of a finished frame: fails where its counts or images that were given say that it cannot stand; pass: whose, for
     * the error line. NULL: it always can. */
    ssfr_result (*check)(const ssfr_run *run, const char *pass);

    /* Of a finished frame: fills the report's taps, iterations, vertices, bytes, tiles and unstable; the graph has put
     * in one sweep that reads each input and writes each output once. NULL: that is right. */
    void (*work)(const ssfr_run *run, ssfr_node_report *report);
    ssfr_tolerance tolerance, half_tolerance; /* the second where halves are stored */
    /* Adds to it what the tables that are read widen it by, after a run. NULL: nothing. */
    void (*widen)(const ssfr_run *run, ssfr_tolerance *tolerance);
};

typedef struct ssfr_binding {
    const char *port; /* NULL ends a list */
    ssfr_slot_id slot;
} ssfr_binding;

typedef struct ssfr_node {
    const char *name; /* NULL ends a list */
    const char *pass; /* NULL: the pass of that name */
    ssfr_binding ports[SSFR_MAX_PORTS]; /* only those that differ from the port's own slot */
    const char *settings[8];            /* "param=value", NULL-terminated */
    const char *stage;                  /* of the frame, as the paper divides it; NULL: none of its stages */
} ssfr_node;

struct ssfr_pipeline {
    const char *name, *source, *help;
    ssfr_slot_id result;
    ssfr_node nodes[32];
};

#endif
