/* SPDX-License-Identifier: MIT */
/* particles.c: particles in packets: sorting along a Morton curve, packing, bounds, spacing. */
#include "scene/reader.h"

#include <float.h>
#include <stdatomic.h>

#define X(name, type, count, unit) \
    {#name, unit, offsetof(ssfr_particles, name), count, _Generic((type)0, float: true, default: false)},
const ssfr_array ssfr_arrays[SSFR_N_ARRAYS] = {SSFR_ATTRIBUTES(X)};
#undef X

#define X(name, type, count, unit) _Static_assert(sizeof(type) == SSFR_ARRAY_VALUE, #name);
SSFR_ATTRIBUTES(X)
#undef X

/* ---- the order: particles that are near in space come near in memory --------------------------------------------- */

enum { AXIS_BITS = 21, DIGIT_BITS = 11, N_DIGITS = 1 << DIGIT_BITS };

typedef struct box {
    double lo[3], hi[3]; /* m, world */
} box;

typedef struct entry {
    uint64_t code; /* along the curve */
    uint32_t index;
} entry;

/* Puts two zero bits between any two of the low 21 bits. */
static uint64_t spread(uint64_t v)
{
    v = (v | v << 32) & 0x001f00000000ffffu;
    v = (v | v << 16) & 0x001f0000ff0000ffu;
    v = (v | v << 8) & 0x100f00f00f00f00fu;
    v = (v | v << 4) & 0x10c30c30c30c30c3u;
    return (v | v << 2) & 0x1249249249249249u;
}

/* scale: cells a metre, the same along all axes, so that packets come out cubical. */
static uint64_t morton(const double position[3], const box *bounds, double scale)
{
    const double last = (1 << AXIS_BITS) - 1;
    uint64_t code = 0;
    for (int k = 0; k < 3; k++) {
        const double cell = ssfr_clamp((position[k] - bounds->lo[k]) * scale, 0, last);
        code |= spread((uint64_t)cell) << k;
    }
    return code;
}

/* One stable pass of the radix sort. False when all digits are the same and nothing was moved. */
static bool sort_by_digit(const entry *from, entry *to, size_t n, int shift)
{
    size_t starts[N_DIGITS] = {0};
    for (size_t i = 0; i < n; i++) starts[from[i].code >> shift & (N_DIGITS - 1)]++;
    if (starts[from[0].code >> shift & (N_DIGITS - 1)] == n) return false;
    size_t start = 0;
    for (int d = 0; d < N_DIGITS; d++) {
        const size_t count = starts[d];
        starts[d] = start;
        start += count;
    }
    for (size_t i = 0; i < n; i++) to[starts[from[i].code >> shift & (N_DIGITS - 1)]++] = from[i];
    return true;
}

static ssfr_result sort(size_t n, const double *positions, const box *bounds, uint32_t *order)
{
    ssfr_result result = SSFR_OK;
    entry *entries = NULL, *spare = NULL;
    double extent = 0;
    for (int k = 0; k < 3; k++) extent = fmax(extent, bounds->hi[k] - bounds->lo[k]);
    const double cells = (1 << AXIS_BITS) / extent, scale = isfinite(cells) ? cells : 0;
    SSFR_TRY(ssfr_alloc(&entries, n, sizeof *entries, "particle codes"));
    SSFR_TRY(ssfr_alloc(&spare, n, sizeof *spare, "particle codes"));
    for (size_t i = 0; i < n; i++) entries[i] = (entry){morton(positions + 3 * i, bounds, scale), (uint32_t)i};
    for (int shift = 0; shift < 3 * AXIS_BITS && n > 0; shift += DIGIT_BITS)
        if (sort_by_digit(entries, spare, n, shift)) {
            entry *const swap = entries;
            entries = spare;
            spare = swap;
        }
    for (size_t i = 0; i < n; i++) order[i] = entries[i].index;
end:
    free(entries);
    free(spare);
    return result;
}

/* ---- packing ----------------------------------------------------------------------------------------------------- */

static void extend(box *b, const double position[3])
{
    for (int k = 0; k < 3; k++) {
        if (position[k] < b->lo[k]) b->lo[k] = position[k];
        if (position[k] > b->hi[k]) b->hi[k] = position[k];
    }
}

static const box nothing = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

/* Checks all positions on the way: afterwards every difference of two fits a float. */
static ssfr_result measure(size_t n, const double *positions, box *bounds)
{
    *bounds = nothing;
    for (size_t i = 0; i < n; i++) {
        const double *at = positions + 3 * i;
        if (!isfinite(at[0]) || !isfinite(at[1]) || !isfinite(at[2]))
            return ssfr_fail(SSFR_ERR_VALUE, "particle %zu (from 0): position (%g, %g, %g) is not finite", i, at[0],
                             at[1], at[2]);
        extend(bounds, at);
    }
    for (int k = 0; k < 3 && n > 0; k++)
        if (0.5 * bounds->hi[k] - 0.5 * bounds->lo[k] > 0.25 * FLT_MAX)
            return ssfr_fail(SSFR_ERR_VALUE, "particles from %g to %g m along %c: too far apart", bounds->lo[k],
                             bounds->hi[k], "xyz"[k]);
    return SSFR_OK;
}

/* The middle of [lo, hi], rounded to 2^-16 of the box. A centre of few digits leaves the differences of most
 * floats to it exact, and stays the same when particles are written and read again. */
static double find_centre(double lo, double hi)
{
    const double middle = 0.5 * lo + 0.5 * hi;
    int exponent = 0;
    frexp(0.5 * hi - 0.5 * lo, &exponent);
    const double step = ldexp(1, exponent - 16);
    return hi > lo && step > DBL_MIN ? rint(middle / step) * step : middle;
}

/* Fills packet p of the set: its box, and its particles' positions relative to the box's middle. */
static void pack(ssfr_particles *set, size_t p, const double *positions, const uint32_t *order)
{
    ssfr_packet *packet = set->packets + p;
    const size_t first = p * SSFR_PACKET, last = first + SSFR_PACKET < set->n ? first + SSFR_PACKET : set->n;
    box b = nothing;
    for (size_t i = first; i < last; i++) extend(&b, positions + 3 * (size_t)order[i]);
    for (size_t k = 0; k < 3; k++) {
        packet->centre[k] = find_centre(b.lo[k], b.hi[k]);
        packet->half[k] = 0;
        for (size_t i = first; i < last; i++) {
            const float relative = (float)(positions[3 * (size_t)order[i] + k] - packet->centre[k]);
            set->position[3 * i + k] = relative;
            packet->half[k] = fmaxf(packet->half[k], fabsf(relative));
        }
    }
}

/* The given array in the set's order. */
static ssfr_result copy_array(ssfr_particles *set, const ssfr_array *array, const void *given, const uint32_t *order)
{
    ssfr_result result = SSFR_OK;
    const size_t size = array->count * SSFR_ARRAY_VALUE;
    char *values = NULL;
    SSFR_TRY(ssfr_alloc(&values, set->n, size, array->name));
    for (size_t i = 0; i < set->n; i++) memcpy(values + i * size, (const char *)given + order[i] * size, size);
    ssfr_array_set(set, array, values);
end:
    return result;
}

ssfr_result ssfr_particles_create(ssfr_particles **out, size_t n, const double *positions, const ssfr_particles *given)
{
    static atomic_uint_fast64_t serial;
    static const ssfr_particles none;
    ssfr_result result = SSFR_OK;
    ssfr_particles *set = NULL;
    uint32_t *order = NULL;
    box bounds;
    if (!given) given = &none;
    *out = NULL;
    if (n > UINT32_MAX) return ssfr_fail(SSFR_ERR_VALUE, "%zu particles: at most %u", n, UINT32_MAX);
    if (!(given->radius >= 0 && isfinite(given->radius)))
        return ssfr_fail(SSFR_ERR_VALUE, "particle radius %g m: expected a finite number from 0", given->radius);
    SSFR_TRY(measure(n, positions, &bounds));
    SSFR_TRY(ssfr_alloc(&set, 1, sizeof *set, "a particle set"));
    *set = (ssfr_particles){.n = n, .n_packets = (n + SSFR_PACKET - 1) / SSFR_PACKET, .radius = given->radius};
    SSFR_TRY(ssfr_alloc(&order, n, sizeof *order, "the particles' order"));
    SSFR_TRY(sort(n, positions, &bounds, order));
    SSFR_TRY(ssfr_alloc(&set->packets, set->n_packets, sizeof *set->packets, "packets"));
    SSFR_TRY(ssfr_alloc(&set->position, n, 3 * sizeof *set->position, "positions"));
    for (size_t p = 0; p < set->n_packets; p++) pack(set, p, positions, order);
    for (size_t a = 0; a < SSFR_N_ARRAYS; a++) {
        const void *values = ssfr_array_get(given, ssfr_arrays + a);
        if (values) SSFR_TRY(copy_array(set, ssfr_arrays + a, values, order));
    }
    set->serial = ++serial;
    *out = set;
    set = NULL;
end:
    free(order);
    ssfr_particles_destroy(&set);
    return result;
}

void ssfr_particles_destroy(ssfr_particles **particles)
{
    ssfr_particles *set = *particles;
    if (set) {
        for (size_t a = 0; a < SSFR_N_ARRAYS; a++) free(ssfr_array_get(set, ssfr_arrays + a));
        free(set->packets);
        free(set->position);
    }
    free(set);
    *particles = NULL;
}

/* ---- measures ---------------------------------------------------------------------------------------------------- */

void ssfr_particles_bounds(const ssfr_particles *particles, double lo[3], double hi[3])
{
    box b = nothing;
    for (size_t p = 0; p < particles->n_packets; p++) {
        const ssfr_packet *packet = particles->packets + p;
        bool beyond = false; /* only then its particles need a look */
        for (int k = 0; k < 3; k++)
            beyond = beyond || packet->centre[k] - (double)packet->half[k] < b.lo[k] ||
                     packet->centre[k] + (double)packet->half[k] > b.hi[k];
        for (size_t i = p * SSFR_PACKET; beyond && i < particles->n && i / SSFR_PACKET == p; i++) {
            double at[3];
            ssfr_particles_position(particles, i, at);
            extend(&b, at);
        }
    }
    for (int k = 0; k < 3; k++) {
        lo[k] = particles->n ? b.lo[k] : 0;
        hi[k] = particles->n ? b.hi[k] : 0;
    }
}

/* m^2, from a point to the packet's box; 0 inside. */
static double distance_to_box(const ssfr_packet *packet, const double at[3])
{
    double sum = 0;
    for (int k = 0; k < 3; k++)
        sum += ssfr_square(fmax(fabs(at[k] - packet->centre[k]) - (double)packet->half[k], 0));
    return sum;
}

/* m^2, the least of `best` and the distances to the packet's particles, but for particle `self`. */
static double nearest_in(const ssfr_particles *set, size_t p, const double at[3], size_t self, double best)
{
    const size_t first = p * SSFR_PACKET, last = first + SSFR_PACKET < set->n ? first + SSFR_PACKET : set->n;
    double local[3];
    for (int k = 0; k < 3; k++) local[k] = at[k] - set->packets[p].centre[k];
    for (size_t i = first; i < last; i++) {
        const float *q = set->position + 3 * i;
        const double d[3] = {local[0] - (double)q[0], local[1] - (double)q[1], local[2] - (double)q[2]};
        const double distance = ssfr_dot(d, d);
        if (distance < best && i != self) best = distance;
    }
    return best;
}

/* m, from particle i to the one nearest to it. Its own packet comes first, so that few others need a look. */
static double nearest(const ssfr_particles *set, size_t i)
{
    const size_t own = i / SSFR_PACKET;
    double at[3];
    ssfr_particles_position(set, i, at);
    double best = nearest_in(set, own, at, i, INFINITY);
    for (size_t p = 0; p < set->n_packets; p++)
        if (p != own && distance_to_box(set->packets + p, at) < best) best = nearest_in(set, p, at, i, best);
    return sqrt(best);
}

double ssfr_particles_spacing(const ssfr_particles *particles)
{
    enum { MAX_SAMPLES = 512 };
    double distances[MAX_SAMPLES];
    const size_t n = particles->n, m = n < MAX_SAMPLES ? n : MAX_SAMPLES;
    if (n < 2) return 0;
    for (size_t s = 0; s < m; s++) distances[s] = nearest(particles, s * n / m);
    qsort(distances, m, sizeof *distances, ssfr_by_value);
    return 0.25 * (distances[(m - 1) / 2] + distances[m / 2]);
}
