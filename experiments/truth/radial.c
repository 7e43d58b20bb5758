/* SPDX-License-Identifier: GPL-3.0-or-later */
/* radial.c: three kernels, each as a power of its distance to the cut-off, so that digits last up to there.
 *
 * Chords. With q^2 = b^2 + s^2 the integrals I_n = int_0^s q^n ds are
 *
 *      I_n = (s q^n + n b^2 I_{n-2}) / (n + 1),    I_0 = s,    I_{-1} = asinh(s / b) = l,
 *
 * so that a polynomial in q gives s times a polynomial in q and b^2, and b^2 l times one in b^2. */
#include "experiments/truth/radial.h"

/* A line in the unit ball at the distance b, from its middle to s, both within the ball. */
typedef struct half_chord {
    double s, q, b2;
    double log; /* b^2 asinh(s / b), which goes to 0 with b */
} half_chord;

/* False where nothing is met. */
static bool clamp(double b, double s, half_chord *out)
{
    if (b >= 1) return false;
    const double half = sqrt((1 - b) * (1 + b));
    out->b2 = b * b;
    out->s = s >= half ? half : s;
    out->q = s >= half ? 1 : sqrt(out->b2 + s * s);
    /* asinh(x) = log1p(x + x^2 / (1 + sqrt(1 + x^2))), x = s / b: faster than the library's and as exact. */
    out->log = b > 1e-100 ? out->b2 * log1p((out->s + out->s * out->s / (out->q + b)) / b) : 0;
    return true;
}

/* ---- cubic spline: w = (8 / pi) (2 (1 - q)+^3 - 8 (1/2 - q)+^3) -------------------------------------------------- */

static double cubic_spline_value(double q)
{
    const double outer = 1 - q, inner = 0.5 - q;
    if (inner > 0) return 8 / M_PI * (1 - 6 * q * q * outer);
    return outer <= 0 ? 0 : 16 / M_PI * outer * outer * outer;
}

/* -w' = (8 / pi) (6 (1 - q)^2 - 24 (1/2 - q)^2) = (8 / pi) (12 q - 18 q^2) within 1/2. */
static double cubic_spline_steepness(double q)
{
    if (q < 0.5) return 8 / M_PI * (12 - 18 * q);
    const double outer = 1 - q;
    return outer <= 0 ? 0 : 48 / M_PI * outer * outer / q;
}

static double cubic_spline_both(double q, double *steepness)
{
    *steepness = cubic_spline_steepness(q);
    return cubic_spline_value(q);
}

/* That of (1 - q)^3 = 1 + 3 q^2 - q (3 + q^2). */
static double cubic_chord(double b, double s)
{
    half_chord c;
    if (!clamp(b, s, &c)) return 0;
    const double odd = 0.375 * (4 + c.b2), q2 = c.q * c.q;
    return c.s * (1 + q2 + 2 * c.b2 - c.q * (0.25 * q2 + odd)) - odd * c.log;
}

/* The inner piece is the outer one at half the size: -8 (1/2 - q)^3 = -(1 - 2 q)^3, and ds is half of d(2 s). */
static double cubic_spline_chord(double b, double s)
{
    const double outer = 2 * cubic_chord(b, fabs(s)), inner = b < 0.5 ? 0.5 * cubic_chord(2 * b, 2 * fabs(s)) : 0;
    return copysign(8 / M_PI * (outer - inner), s);
}

/* Value and steepness by what gives both. */
#define ALONE(kernel)                                                                 \
    static double kernel##_value(double q) { return kernel##_both(q, &(double){0}); } \
    static double kernel##_steepness(double q) { double k; kernel##_both(q, &k); return k; }

/* ---- poly6: w = 315 / (64 pi) (1 - q^2)+^3 ----------------------------------------------------------------------- */

static double poly6_both(double q, double *steepness)
{
    const double left = q >= 1 ? 0 : (1 - q) * (1 + q);
    *steepness = 6 * 315 / (64 * M_PI) * left * left;
    return 315 / (64 * M_PI) * left * left * left;
}

ALONE(poly6)

/* 1 - q^2 = H^2 - s^2 with H half the length in the ball: no roots of q, no logarithm. */
static double poly6_chord(double b, double s)
{
    if (b >= 1) return 0;
    const double half2 = (1 - b) * (1 + b), s2 = s * s < half2 ? s * s : half2;
    const double t = fabs(s) * fabs(s) < half2 ? fabs(s) : sqrt(half2);
    const double sum = half2 * half2 * half2 + s2 * (s2 * (0.6 * half2 - s2 / 7) - half2 * half2);
    return copysign(315 / (64 * M_PI) * t * sum, s);
}

/* ---- Wendland's C2: w = 21 / (2 pi) (1 - q)+^4 (1 + 4 q) --------------------------------------------------------- */

static double wendland_both(double q, double *steepness)
{
    const double left = 1 - fmin(q, 1), cube = left * left * left;
    *steepness = 20 * 21 / (2 * M_PI) * cube;
    return 21 / (2 * M_PI) * cube * left * (5 - 4 * left);
}

ALONE(wendland)

/* That of 1 - 10 q^2 + 20 q^3 - 15 q^4 + 4 q^5. */
static double wendland_chord(double b, double s)
{
    half_chord c;
    if (!clamp(b, fabs(s), &c)) return 0;
    const double b2 = c.b2, odd = b2 * (7.5 + 1.25 * b2);
    const double even = 1 - b2 * (20.0 / 3 + 8 * b2) + c.q * (odd - c.q * (10.0 / 3 + 4 * b2));
    const double q3 = c.q * c.q * c.q;
    const double sum = c.s * (even + q3 * (5 + b2 * (5.0 / 6) + c.q * (c.q * (2.0 / 3) - 3))) + odd * c.log;
    return copysign(21 / (2 * M_PI) * sum, s);
}

/* ------------------------------------------------------------------------------------------------------------------ */

/* Errors of chords: the largest of three million against quadruple precision were 4.3e-15, 0.8e-15 and 1.2e-14. */
#define RADIAL(kernel, from, chord_err, seam, even) \
    { #kernel, from, kernel##_value, kernel##_steepness, kernel##_both, kernel##_chord, chord_err, seam, even }

const ssfr_radial ssfr_radials[SSFR_N_RADIALS] = {
    RADIAL(cubic_spline, "Monaghan 1992", 6e-15, 0.5, false),
    RADIAL(poly6, "Muller et al. 2003", 1.5e-15, 1, true),
    RADIAL(wendland, "Wendland 1995, C2", 1.6e-14, 1, false),
};

const char *const ssfr_radial_names[SSFR_N_RADIALS + 1] = {"cubic_spline", "poly6", "wendland", NULL};
