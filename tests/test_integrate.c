/* SPDX-License-Identifier: GPL-3.0-or-later */
/* test_integrate.c: every rule on functions whose integrals are known: values, error estimates, orders, refusals. */
#include "experiments/truth/integrate.h"
#include "tests/util.h"

#include <float.h>

static const ssfr_integrate_params usual = {1e-12, 1e-12, 8, 4096};
static ssfr_integration *work;

static int make_work(void **state)
{
    test_capture_log(state);
    return ssfr_integration_create(&work) == SSFR_OK ? 0 : -1;
}

static int drop_work(void **state)
{
    (void)state;
    ssfr_integration_destroy(&work);
    return 0;
}

static ssfr_integral integrate(ssfr_integrator_id id, const ssfr_integrand *f, const ssfr_integrate_params *params)
{
    ssfr_integral out;
    assert_int_equal(ssfr_integrate(work, id, f, params, &out), SSFR_OK);
    assert_true(isfinite(out.value) && out.err >= 0);
    return out;
}

/* ---- functions and their integrals ------------------------------------------------------------------------------- */

static const double kink = 1.0 / 3, spike = 1e-3, spike_at = 0.61803398875;

static double cubic(double t, void *user)
{
    (void)user;
    return 4 * t * t * t - 2.385;
}

static double wave(double t, void *user)
{
    (void)user;
    return sin(23.85 * t);
}

static double fold(double t, void *user)
{
    (void)user;
    return fabs(t - kink);
}

/* A bump of the width 2 spike that is 0 outside, with its first two derivatives. */
static double bump(double t, void *user)
{
    (void)user;
    const double u = (t - spike_at) / spike;
    return fabs(u) < 1 ? pow(1 - u * u, 3) : 0;
}

static double root(double t, void *user)
{
    (void)user;
    return sqrt(t);
}

static double tiny(double t, void *user)
{
    (void)user;
    return 1e-200 * exp(t);
}

static double zero(double t, void *user)
{
    (void)t, (void)user;
    return 0;
}

typedef struct known {
    const char *name;
    double (*value)(double t, void *user);
    double integral; /* from 0 to 1 */
    double breaks[5];
    size_t n_breaks;
    bool smooth; /* between the breaks */
} known;

static const known functions[] = {
    {"cubic", cubic, 1 - 2.385, {0, 1}, 2, true},
    {"wave", wave, 0.03001727483875591, {0, 1}, 2, true}, /* (1 - cos 23.85) / 23.85 */
    {"fold", fold, 5.0 / 18, {0, 1.0 / 3, 1}, 3, true},
    {"bump", bump, 1e-3 * 32 / 35, {0, 0.61703398875, 0.61903398875, 1}, 4, true},
    {"root", root, 2.0 / 3, {0, 1}, 2, false},
    {"tiny", tiny, 1.718281828459045e-200, {0, 0.2385, 0.2385, 1}, 4, true}, /* a piece may be empty */
    {"zero", zero, 0, {0, 0.5, 1}, 3, true},
};

static ssfr_integrand integrand_of(const known *f)
{
    return (ssfr_integrand){f->value, NULL, f->n_breaks, f->breaks};
}

#define EACH(f) const known *f = functions; f < functions + SSFR_COUNT(functions); f++

/* ---- values and estimates ---------------------------------------------------------------------------------------- */

static bool sees(ssfr_integrator_id id, const known *f)
{
    /* Those that are not told of the bump find it by luck: see narrow_spikes_are_missed_without_break_points. */
    return f->value != bump || id == SSFR_INTEGRATOR_qagp || id == SSFR_INTEGRATOR_gauss;
}

/* Once the points are dense enough to see what there is: 16 for less than four waves. */
static void values_are_within_their_error_estimates(void **state)
{
    (void)state;
    for (int id = SSFR_INTEGRATOR_qags; id < SSFR_N_INTEGRATORS; id++)
        for (EACH(f)) {
            const ssfr_integrand integrand = integrand_of(f);
            if (!sees((ssfr_integrator_id)id, f)) continue;
            for (int k = 0; k <= 6; k++) {
                const double eps = pow(10, -2 * k);
                const ssfr_integrate_params params = {eps * 1e-3, eps, 16 + 4 * k, 16 << 2 * k};
                const ssfr_integral got = integrate((ssfr_integrator_id)id, &integrand, &params);
                if (!(fabs(got.value - f->integral) <= got.err + DBL_EPSILON * fabs(f->integral)))
                    fail_msg("%s of %s at %g: %.17g is %g from the integral, claimed %g", ssfr_integrators[id].name,
                             f->name, eps, got.value, fabs(got.value - f->integral), got.err);
            }
        }
}

static void rules_that_choose_reach_what_is_asked(void **state)
{
    (void)state;
    static const ssfr_integrator_id choosing[] = {SSFR_INTEGRATOR_qags, SSFR_INTEGRATOR_qagp, SSFR_INTEGRATOR_cquad};
    for (size_t i = 0; i < SSFR_COUNT(choosing); i++)
        for (EACH(f)) {
            const ssfr_integrand integrand = integrand_of(f);
            if (!sees(choosing[i], f)) continue;
            const ssfr_integral got = integrate(choosing[i], &integrand, &(ssfr_integrate_params){1e-10, 1e-10, 0, 0});
            assert_true(got.converged && got.err <= 1e-10 * fmax(1, fabs(got.value)));
            assert_close(got.value, f->integral, 1e-10, 1e-10);
            assert_true(got.evaluations >= 21 || choosing[i] == SSFR_INTEGRATOR_cquad);
        }
}

static double power(double t, void *n)
{
    return pow(t, *(const double *)n);
}

static void gauss_is_exact_for_polynomials_of_its_degree(void **state)
{
    (void)state;
    const double breaks[] = {-0.2385, 0.4, 1.7};
    for (int points = 1; points <= 64; points++) {
        const int degree = 2 * points - 1;
        double user = degree;
        const ssfr_integrand f = {power, &user, 3, breaks};
        const ssfr_integral got = integrate(SSFR_INTEGRATOR_gauss, &f, &(ssfr_integrate_params){0, 0, points, 0});
        const double exact = (pow(1.7, degree + 1) - pow(-0.2385, degree + 1)) / (degree + 1);
        assert_close(got.value, exact, 0, 1e-13);
        assert_int_equal(got.evaluations, 2 * (points + (points > 1 ? points / 2 : 2)));
    }
}

/* ---- orders ------------------------------------------------------------------------------------------------------ */

static double error_of(ssfr_integrator_id id, const ssfr_integrand *f, double integral, int points, int steps)
{
    const ssfr_integral got = integrate(id, f, &(ssfr_integrate_params){0, 0, points, steps});
    assert_false(got.converged);
    return fabs(got.value - integral);
}

static void equal_steps_converge_to_second_order(void **state)
{
    (void)state;
    const ssfr_integrand f = integrand_of(&functions[1]);
    for (int steps = 64; steps <= 16384; steps *= 2) {
        const double coarse = error_of(SSFR_INTEGRATOR_steps, &f, functions[1].integral, 0, steps);
        const double fine = error_of(SSFR_INTEGRATOR_steps, &f, functions[1].integral, 0, 2 * steps);
        assert_close(log2(coarse / fine), 2, 0.02, 0);
    }
}

/* On m pieces p points converge with m^-2p. */
static void gauss_converges_with_twice_its_points(void **state)
{
    (void)state;
    enum { MOST = 64 };
    double breaks[MOST + 1];
    for (int points = 1; points <= 3; points++) {
        double last = NAN;
        for (int m = 16; m <= (points < 3 ? MOST : 32); m *= 2) {
            for (int i = 0; i <= m; i++) breaks[i] = (double)i / m;
            const ssfr_integrand f = {wave, NULL, (size_t)m + 1, breaks};
            const double error = error_of(SSFR_INTEGRATOR_gauss, &f, functions[1].integral, points, 0);
            if (m > 16) assert_close(log2(last / error), 2 * points, 0.1, 0);
            last = error;
        }
    }
}

/* The sum of 2^20 steps is no worse than that of one: 0.1 is no binary number. */
static double tenth(double t, void *user)
{
    (void)t, (void)user;
    return 0.1;
}

static void many_steps_lose_no_digits(void **state)
{
    (void)state;
    const ssfr_integrand f = {tenth, NULL, 2, (const double[]){0, 3}};
    const ssfr_integral got = integrate(SSFR_INTEGRATOR_steps, &f, &(ssfr_integrate_params){1e-15, 0, 0, 1 << 20});
    assert_close(got.value, 0.3, 1e-16, 0);
    assert_true(got.err < 1e-15 && got.converged && got.evaluations == 3 << 19);
}

/* ---- break points ------------------------------------------------------------------------------------------------ */

/* What each rule says of a spike that none of its points meets: 0, with an error of next to nothing. This is where
 * estimates do not bound the error, and why break points are handed over. */
static void narrow_spikes_are_missed_without_break_points(void **state)
{
    (void)state;
    const known *f = &functions[3];
    const ssfr_integrand integrand = integrand_of(f);
    assert_close(integrate(SSFR_INTEGRATOR_qagp, &integrand, &usual).value, f->integral, 1e-15, 0);
    assert_close(integrate(SSFR_INTEGRATOR_gauss, &integrand, &usual).value, f->integral, 1e-15, 0);
    const ssfr_integral missed = integrate(SSFR_INTEGRATOR_qags, &integrand, &usual);
    assert_true(missed.value == 0 && missed.err < 1e-100 && missed.evaluations == 21);
    assert_close(integrate(SSFR_INTEGRATOR_steps, &integrand, &usual).value, f->integral, 1e-6, 0);
}

/* Kernels of a dense ray: thousands of pieces. */
static double saw(double t, void *user)
{
    const double n = *(const double *)user, u = n * t - floor(n * t);
    return u * (1 - u);
}

static void thousands_of_break_points_are_taken(void **state)
{
    (void)state;
    enum { N = 5000 };
    static double breaks[N + 1];
    double n = N;
    for (int i = 0; i <= N; i++) breaks[i] = i / n;
    const ssfr_integrand f = {saw, &n, N + 1, breaks};
    for (int k = 0; k < 2; k++) { /* the work space has grown the second time */
        const ssfr_integral got = integrate(SSFR_INTEGRATOR_qagp, &f, &(ssfr_integrate_params){0, 1e-8, 0, 0});
        assert_close(got.value, 1.0 / 6, got.err, 0);
        assert_true(got.converged && got.evaluations == 21 * N);
    }
    const ssfr_integral got = integrate(SSFR_INTEGRATOR_gauss, &f, &(ssfr_integrate_params){0, 1e-10, 4, 0});
    assert_close(got.value, 1.0 / 6, got.err, 0);
    assert_true(got.converged && got.evaluations == 6 * N);
}

static double roots(double t, void *user)
{
    const double n = *(const double *)user;
    return sqrt(fabs(n * t - floor(n * t)));
}

/* What may be wrong in all is shared out among the pieces. */
static void absolute_tolerances_hold_for_the_sum_of_all_pieces(void **state)
{
    (void)state;
    enum { N = 100 };
    double breaks[N + 1], n = N;
    for (int i = 0; i <= N; i++) breaks[i] = i / n;
    const ssfr_integrand f = {roots, &n, N + 1, breaks};
    for (int id = SSFR_INTEGRATOR_qagp; id <= SSFR_INTEGRATOR_cquad; id++)
        for (double eps = 1e-3; eps > 1e-9; eps *= 0.1) {
            const ssfr_integral got = integrate((ssfr_integrator_id)id, &f, &(ssfr_integrate_params){eps, 0, 0, 0});
            assert_true(got.converged && got.err <= eps);
            assert_close(got.value, 2.0 / 3, eps, 0);
        }
}

static void an_empty_interval_has_no_integral(void **state)
{
    (void)state;
    const ssfr_integrand f = {fold, NULL, 3, (const double[]){2.385, 2.385, 2.385}};
    for (int id = SSFR_INTEGRATOR_qags; id < SSFR_N_INTEGRATORS; id++) {
        const ssfr_integral got = integrate((ssfr_integrator_id)id, &f, &usual);
        assert_true(got.value == 0 && got.err == 0 && got.evaluations == 0 && got.converged);
    }
}

/* ---- the work space ---------------------------------------------------------------------------------------------- */

/* A thousand kinks. */
static double folds(double t, void *user)
{
    (void)user;
    return fabs(sin(3141.5 * t));
}

/* A rule that gives up does so for its own integrand's sake, however much room others before it took: else the bits of
 * an image would hang on which thread had which ray. */
static void what_was_integrated_before_changes_nothing(void **state)
{
    (void)state;
    enum { N = 5000 };
    static double breaks[N + 1];
    double n = N;
    for (int i = 0; i <= N; i++) breaks[i] = i / n;
    const ssfr_integrand large = {saw, &n, N + 1, breaks}, hard = {folds, NULL, 2, (const double[]){0, 1}};
    const ssfr_integrand harder = {folds, NULL, 3, (const double[]){0, 0.002385, 1}};
    const ssfr_integrate_params exact = {0, 1e-13, 8, 4096};
    ssfr_integration *fresh;
    assert_int_equal(integrate(SSFR_INTEGRATOR_qagp, &large, &(ssfr_integrate_params){0, 1e-8, 0, 0}).evaluations,
                     21 * N);
    for (int id = SSFR_INTEGRATOR_qags; id < SSFR_N_INTEGRATORS; id++) {
        const ssfr_integrand *f = id == SSFR_INTEGRATOR_qags ? &hard : &harder;
        ssfr_integral first;
        assert_int_equal(ssfr_integration_create(&fresh), SSFR_OK);
        assert_int_equal(ssfr_integrate(fresh, (ssfr_integrator_id)id, f, &exact, &first), SSFR_OK);
        ssfr_integration_destroy(&fresh);
        const ssfr_integral again = integrate((ssfr_integrator_id)id, f, &exact);
        assert_true(!first.converged || id > SSFR_INTEGRATOR_qagp);
        assert_true(again.value == first.value && again.err == first.err && again.evaluations == first.evaluations);
    }
}

static void room_is_given_and_kept(void **state)
{
    (void)state;
    double *few, *many, *fewer;
    const ssfr_collocation *four, *again;
    assert_int_equal(ssfr_integration_room(work, 3, sizeof *few, &few), SSFR_OK);
    for (int i = 0; i < 3; i++) few[i] = 2.385;
    assert_int_equal(ssfr_integration_room(work, 100000, sizeof *many, &many), SSFR_OK);
    for (int i = 0; i < 100000; i++) many[i] = i;
    assert_int_equal(ssfr_integration_room(work, 99999, sizeof *fewer, &fewer), SSFR_OK);
    assert_ptr_equal(fewer, many);
    assert_int_equal(ssfr_integration_collocation(work, 4, &four), SSFR_OK);
    assert_int_equal(ssfr_integration_collocation(work, 4, &again), SSFR_OK);
    assert_ptr_equal(again, four);
    assert_int_equal(four->n, 4);
    assert_fails(SSFR_ERR_VALUE, ssfr_integration_collocation(work, 0, &again), "0 points");
    assert_fails(SSFR_ERR_VALUE, ssfr_integration_collocation(work, SSFR_COLLOCATION_MOST + 1, &again), "17 points");
    assert_fails(SSFR_ERR_VALUE, ssfr_integration_collocation(work, -1, &again), "-1 points");
}

/* ---- what goes wrong --------------------------------------------------------------------------------------------- */

static double pole(double t, void *user)
{
    (void)user;
    return 1 / fabs(t - 0.5);
}

static double not_a_number(double t, void *user)
{
    (void)user;
    return t > 0.3 ? (double)NAN : t;
}

static double huge(double t, void *user)
{
    (void)user;
    return 1e308 * (2 + t);
}

static void functions_that_are_not_finite_have_an_infinite_error(void **state)
{
    (void)state;
    for (int id = SSFR_INTEGRATOR_qags; id < SSFR_N_INTEGRATORS; id++) {
        const ssfr_integrand nan = {not_a_number, NULL, 3, (const double[]){0, 0.3, 1}};
        const ssfr_integrand over = {huge, NULL, 2, (const double[]){0, 1}};
        ssfr_integral got = integrate((ssfr_integrator_id)id, &nan, &usual);
        assert_true(isinf(got.err) && !got.converged);
        got = integrate((ssfr_integrator_id)id, &over, &usual);
        assert_true(isinf(got.err) && !got.converged);
    }
}

static void a_missed_tolerance_is_told_and_no_error(void **state)
{
    (void)state;
    static const ssfr_integrator_id choosing[] = {SSFR_INTEGRATOR_qags, SSFR_INTEGRATOR_cquad};
    for (size_t i = 0; i < SSFR_COUNT(choosing); i++) {
        const ssfr_integrand f = {pole, NULL, 2, (const double[]){0, 1.1}}; /* it has no integral */
        const ssfr_integral got = integrate(choosing[i], &f, &usual);
        assert_false(got.converged);
        assert_true(got.err > 1e-3);
    }
}

static void without_tolerances_rules_do_their_best_and_claim_nothing(void **state)
{
    (void)state;
    for (int id = SSFR_INTEGRATOR_qags; id < SSFR_N_INTEGRATORS; id++) {
        const ssfr_integrand f = integrand_of(&functions[0]);
        const ssfr_integrand nothing = integrand_of(&functions[SSFR_COUNT(functions) - 1]);
        const ssfr_integrate_params none = {0, 0, 8, 4096};
        const ssfr_integral got = integrate((ssfr_integrator_id)id, &f, &none);
        assert_false(got.converged || integrate((ssfr_integrator_id)id, &nothing, &none).converged);
        assert_close(got.value, functions[0].integral, 1e-7, 0);
    }
}

static void what_cannot_be_is_refused(void **state)
{
    (void)state;
    const double ends[] = {0, 1}, falling[] = {0, 0.7, 0.3, 1}, endless[] = {0, INFINITY}, nan[] = {0, NAN, 1};
    const ssfr_integrand f = {fold, NULL, 2, ends};
    ssfr_integral out;
#define REFUSES(id, f, text, ...)                                                                                    \
    assert_fails(SSFR_ERR_VALUE,                                                                                     \
                 ssfr_integrate(work, SSFR_INTEGRATOR_##id, (f), &(ssfr_integrate_params){__VA_ARGS__}, &out), text)
    REFUSES(chords, &f, "chords is no rule", 1e-9, 0, 8, 64);
    REFUSES(qags, &f, "eps_abs -2.385", -2.385, 0, 8, 64);
    REFUSES(qagp, &f, "eps_rel nan", 0, NAN, 8, 64);
    REFUSES(cquad, &f, "eps_rel inf", 0, INFINITY, 8, 64);
    REFUSES(gauss, &f, "points 0", 0, 0, 0, 64);
    REFUSES(gauss, &f, "points 65", 0, 0, 65, 64);
    REFUSES(steps, &f, "steps 0", 0, 0, 8, 0);
    REFUSES(steps, &f, "steps 16777217", 0, 0, 8, (1 << 24) + 1);
    REFUSES(qags, (&(ssfr_integrand){fold, NULL, 1, ends}), "1 break points", 1e-9, 0, 8, 64);
    REFUSES(qagp, (&(ssfr_integrand){fold, NULL, 4, falling}), "break points 1 and 2 are 0.7 and 0.3", 1e-9, 0, 8, 64);
    REFUSES(steps, (&(ssfr_integrand){fold, NULL, 2, endless}), "are 0 and inf", 1e-9, 0, 8, 64);
    REFUSES(gauss, (&(ssfr_integrand){fold, NULL, 3, nan}), "are 0 and nan", 1e-9, 0, 8, 64);
    assert_true(out.value == 0 && out.evaluations == 0);
}

static void names_are_those_of_the_list(void **state)
{
    (void)state;
    for (int i = 0; i < SSFR_N_INTEGRATORS; i++)
        assert_string_equal(ssfr_integrator_names[i], ssfr_integrators[i].name);
    assert_null(ssfr_integrator_names[SSFR_N_INTEGRATORS]);
    assert_string_equal(ssfr_integrator_names[SSFR_INTEGRATOR_qagp], "qagp");
}

static void a_work_space_is_destroyed_once(void **state)
{
    (void)state;
    ssfr_integration *none = NULL, *unused;
    ssfr_integration_destroy(&none);
    assert_int_equal(ssfr_integration_create(&unused), SSFR_OK);
    ssfr_integration_destroy(&unused);
    assert_null(unused);
    ssfr_integration_destroy(&unused);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_are_within_their_error_estimates),
        cmocka_unit_test(rules_that_choose_reach_what_is_asked),
        cmocka_unit_test(gauss_is_exact_for_polynomials_of_its_degree),
        cmocka_unit_test(equal_steps_converge_to_second_order),
        cmocka_unit_test(gauss_converges_with_twice_its_points),
        cmocka_unit_test(many_steps_lose_no_digits),
        cmocka_unit_test(narrow_spikes_are_missed_without_break_points),
        cmocka_unit_test(thousands_of_break_points_are_taken),
        cmocka_unit_test(absolute_tolerances_hold_for_the_sum_of_all_pieces),
        cmocka_unit_test(an_empty_interval_has_no_integral),
        cmocka_unit_test(what_was_integrated_before_changes_nothing),
        cmocka_unit_test(room_is_given_and_kept),
        cmocka_unit_test(functions_that_are_not_finite_have_an_infinite_error),
        cmocka_unit_test(a_missed_tolerance_is_told_and_no_error),
        cmocka_unit_test(without_tolerances_rules_do_their_best_and_claim_nothing),
        cmocka_unit_test(what_cannot_be_is_refused),
        cmocka_unit_test(names_are_those_of_the_list),
        cmocka_unit_test(a_work_space_is_destroyed_once),
    };
    return cmocka_run_group_tests(tests, make_work, drop_work);
}
