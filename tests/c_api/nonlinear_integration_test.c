/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Integration of nonlinear problems in all its forms, and from checkpoints.
 */
#include <stdio.h>
#include <stdlib.h>

#include "nonlinear_pendulum.h"

/* Iterations end where a relative change is below 1e-9 and converges quadratically. */
static const double still_rounding = 1e-8;

static sfdae_options options_for(int method, double tol) {
  sfdae_options options = default_options();
  options.method = method;
  options.rtol = options.atol = tol;
  return options;
}

static sfdae_nonlinear_problem form(int k) { return k == 0 ? recorded_pendulum() : differentiated_pendulum(); }

/* ---- The pendulum that is pushed ------------------------------------------------------------------ */

static void both_forms_are_accurate_forward_and_backward(void) {
  static const double tolerances[] = {1e-4, 1e-7, 1e-10};
  int method, k, i, direction;
  for (method = 0; method < 3; method++)
    for (k = 0; k < 2; k++)
      for (i = 0; i < 3; i++)
        for (direction = -1; direction <= 1; direction += 2) {
          const double tol = tolerances[i];
          sfdae_nonlinear_problem problem = form(k);
          sfdae_options options = options_for(method, tol);
          sfdae_solver* solver = CREATE(&problem, &options);
          sfdae_characteristics c;
          double t = unset, x[N], xdot[N], from[N];
          int step;
          sfdae_characteristics_init(&c, sizeof c);
          exact(1, x);
          exact(1, from);
          CHECK_STATUS(sfdae_start(solver, 1, 1 + direction, x, xdot), SFDAE_OK);
          CHECK(memcmp(x, from, sizeof x) != 0 ? accurate(1, x, 1e-14) : 1);
          CHECK(fabs(xdot[0] - x[2]) <= 1e-12 && fabs(xdot[1] - x[3]) <= 1e-12);
          sfdae_get_characteristics(solver, &c);
          CHECK(c.strangeness_index == 2 && c.differential == 2 && c.algebraic == 3);
          CHECK(c.undetermined == 1 && c.redundant == 0 && c.rank_E == 4);
          for (step = 1; step <= 4; step++) {
            CHECK_STATUS(sfdae_advance(solver, 1 + direction * step * 0.5, &t, x, NULL), SFDAE_OK);
            CHECK(t == 1 + direction * step * 0.5 && accurate(t, x, tol) && violation(x) <= still_rounding);
            CHECK(fabs(x[5] - force(t)) <= 1e-14);
          }
          sfdae_destroy(&solver);
        }
}

/* Both forms have the same Taylor coefficients up to rounding; steps differ by little then. */
static void both_forms_do_the_same(void) {
  int method;
  for (method = 0; method < 2; method++) {
    double x[2][N];
    sfdae_statistics s[2];
    int k, i;
    for (k = 0; k < 2; k++) {
      sfdae_nonlinear_problem problem = form(k);
      sfdae_options options = options_for(method, 1e-7);
      sfdae_solver* solver = CREATE(&problem, &options);
      double t;
      exact(0, x[k]);
      sfdae_start(solver, 0, 2, x[k], NULL);
      CHECK_STATUS(sfdae_advance(solver, 2, &t, x[k], NULL), SFDAE_OK);
      sfdae_statistics_init(&s[k], sizeof s[k]);
      sfdae_get_statistics(solver, &s[k]);
      CHECK(s[k].evaluations_F > 0 && s[k].linearizations > 0 && s[k].evaluations_E == 0);
      sfdae_destroy(&solver);
    }
    CHECK(labs(s[0].steps - s[1].steps) <= 1 + s[0].steps / 20);
    for (i = 0; i < N; i++) CHECK(fabs(x[0][i] - x[1][i]) <= 1e-7 * (1 + fabs(x[0][i])));
  }
}

static void steps_are_taken_one_by_one(void) {
  int method;
  for (method = 0; method < 2; method++) {
    sfdae_nonlinear_problem problem = recorded_pendulum();
    sfdae_options options = options_for(method, 1e-6);
    sfdae_solver* solver = CREATE(&problem, &options);
    double t = 0, before = 0, x[N];
    long steps = 0;
    int status;
    exact(0, x);
    sfdae_start(solver, 0, 1, x, NULL);
    while ((status = sfdae_step(solver, 1, &t, x, NULL)) == SFDAE_STEP_TAKEN) {
      CHECK(t > before && t <= 1 && accurate(t, x, 1e-6));
      before = t;
      steps++;
    }
    CHECK(status == SFDAE_OK && t == 1 && steps > 1 && accurate(t, x, 1e-6));
    sfdae_destroy(&solver);
  }
}

/* After an event, say. */
static void restarts_take_other_values(void) {
  sfdae_nonlinear_problem problem = recorded_pendulum();
  sfdae_solver* solver = CREATE(&problem, NULL);
  double t = unset, x[N];
  int k;
  exact(0, x);
  for (k = 0; k < 5; k++) {
    CHECK_STATUS(sfdae_start(solver, k, k + 1, x, NULL), SFDAE_OK);
    CHECK_STATUS(sfdae_advance(solver, k + 0.5, &t, x, NULL), SFDAE_OK);
    CHECK(violation(x) <= still_rounding);
    exact(k + 1, x); /* elsewhere */
  }
  CHECK_STATUS(sfdae_start(solver, 5, 4, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 4.5, &t, x, NULL), SFDAE_OK);
  CHECK(accurate(t, x, 1e-6));
  sfdae_destroy(&solver);
}

/* u = 1: without a prescription x keeps its free part; the force changes as little as it must. */
static void what_is_free_is_held(void) {
  int method;
  for (method = 0; method < 2; method++) {
    sfdae_nonlinear_problem problem = recorded_pendulum();
    sfdae_options options = options_for(method, 1e-6);
    sfdae_solver* solver;
    double t = unset, x[N];
    problem.num_prescribed = 0;
    problem.prescribed_values = NULL;
    solver = CREATE(&problem, &options);
    exact(0, x);
    CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_NOT_UNIQUE);
    CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
    CHECK(t == 1 && violation(x) <= still_rounding && fabs(x[5]) < 10);
    sfdae_destroy(&solver);
  }
}

/* The angle or a velocity as input would fix what is determined by the initial values. */
static void wrong_inputs_are_refused(void) {
  static const int position[1] = {0}, both[2] = {4, 5};
  sfdae_nonlinear_problem problem = recorded_pendulum();
  sfdae_solver* solver;
  double x[N], before[N];
  problem.prescribed = position;
  solver = CREATE(&problem, NULL);
  exact(0, x);
  memcpy(before, x, sizeof x);
  CHECK(sfdae_start(solver, 0, 1, x, NULL) < 0);
  CHECK(memcmp(x, before, sizeof x) == 0 && strlen(sfdae_message(solver)) > 10);
  sfdae_destroy(&solver);
  problem.num_prescribed = 2;
  problem.prescribed = both;
  solver = CREATE(&problem, NULL);
  CHECK(sfdae_start(solver, 0, 1, x, NULL) < 0);
  CHECK(memcmp(x, before, sizeof x) == 0 && strlen(sfdae_message(solver)) > 10);
  sfdae_destroy(&solver);
}

/* ---- Redundant, overdetermined, linear ------------------------------------------------------------ */

/* The length twice, with two multipliers: v = u = 1. x = (cos t, sin t, -sin t, cos t), x5 + x6 = 1/2. */
static int redundant_equations(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                               const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  const sfdae_expression rod = sfdae_multiply(sfdae_number(2), sfdae_add(x[4], x[5]));
  const sfdae_expression square = sfdae_add(sfdae_multiply(x[0], x[0]), sfdae_multiply(x[1], x[1]));
  (void)record, (void)t, (void)user;
  F[0] = sfdae_subtract(xdot[0], x[2]);
  F[1] = sfdae_subtract(xdot[1], x[3]);
  F[2] = sfdae_add(xdot[2], sfdae_multiply(x[0], rod));
  F[3] = sfdae_add(xdot[3], sfdae_multiply(x[1], rod));
  F[4] = sfdae_subtract(square, sfdae_number(1));
  F[5] = sfdae_subtract(sfdae_multiply(sfdae_number(2), square), sfdae_number(user ? 3 : 2));
  return 0;
}

static void redundant_constraints_are_found(void) {
  int method;
  for (method = 0; method < 2; method++) {
    sfdae_nonlinear_problem problem = pendulum_problem();
    sfdae_options options = options_for(method, 1e-7);
    sfdae_characteristics c;
    sfdae_solver* solver;
    double t = unset, x[N] = {1, 0, 0, 1, 0.25, 0.25};
    problem.num_equations = N;
    problem.num_prescribed = 0;
    problem.equations = redundant_equations;
    solver = CREATE(&problem, &options);
    sfdae_characteristics_init(&c, sizeof c);
    CHECK_STATUS(sfdae_analyze_at(solver, 0, 2, x, &c), SFDAE_NOT_UNIQUE);
    CHECK(c.strangeness_index == 2 && c.differential == 2 && c.algebraic == 3);
    CHECK(c.undetermined == 1 && c.redundant == 1);
    CHECK_STATUS(sfdae_start(solver, 0, 2, x, NULL), SFDAE_NOT_UNIQUE);
    CHECK_STATUS(sfdae_advance(solver, 2, &t, x, NULL), SFDAE_OK);
    CHECK(fabs(x[0] - cos(2.0)) <= 2e-6 && fabs(x[1] - sin(2.0)) <= 2e-6 && fabs(x[4] + x[5] - 0.5) <= 2e-6);
    CHECK(fabs(x[0] * x[0] + x[1] * x[1] - 1) <= still_rounding);
    sfdae_destroy(&solver);

    /* Lengths that contradict each other leave no consistent values. */
    problem.user = &t;
    solver = CREATE(&problem, &options);
    CHECK(sfdae_start(solver, 0, 2, x, NULL) < 0);
    CHECK(strlen(sfdae_message(solver)) > 10);
    sfdae_destroy(&solver);
  }
}

/* Three equations for two unknowns: x1' = x2, x1^2 + x2^2 = 1, x2' = -x1. One of them follows. x = (sin t, cos t). */
static int overdetermined_equations(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                                    const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  (void)record, (void)t, (void)user;
  F[0] = sfdae_subtract(xdot[0], x[1]);
  F[1] = sfdae_add(xdot[1], x[0]);
  F[2] = sfdae_add(sfdae_multiply(x[0], x[0]), sfdae_multiply(x[1], x[1]));
  F[2] = sfdae_subtract(F[2], sfdae_number(1));
  return 0;
}

static void overdetermined_problems_are_solved(void) {
  int method;
  for (method = 0; method < 2; method++) {
    sfdae_nonlinear_problem problem = pendulum_problem();
    sfdae_options options = options_for(method, 1e-7);
    sfdae_characteristics c;
    sfdae_solver* solver;
    double t = unset, x[2] = {0, 1.1};
    problem.num_equations = 3;
    problem.num_unknowns = 2;
    problem.num_prescribed = 0;
    problem.equations = overdetermined_equations;
    options.consistency_tol = 1e-4; /* what the iteration leaves counts, too */
    solver = CREATE(&problem, &options);
    sfdae_characteristics_init(&c, sizeof c);
    CHECK_STATUS(sfdae_start(solver, 0, 2, x, NULL), SFDAE_VALUES_CHANGED);
    CHECK(fabs(x[0]) <= 1e-14 && fabs(x[1] - 1) <= 1e-14);
    sfdae_get_characteristics(solver, &c);
    CHECK(c.differential + c.algebraic == 2 && c.undetermined == 0 && c.redundant == 1);
    CHECK_STATUS(sfdae_advance(solver, 2, &t, x, NULL), SFDAE_OK);
    CHECK(fabs(x[0] - sin(2.0)) <= 2e-6 && fabs(x[1] - cos(2.0)) <= 2e-6);
    sfdae_destroy(&solver);
  }
}

/* Gear & Petzold: x1 + eta t x2 = e^-t,  x1' + eta t x2' + (1 + eta) x2 = 0; x = ((1 - eta t) e^-t, e^-t). mu = 1, a
 * = 2. */
static const double eta = -1;

static int gear_petzold(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                        const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  const sfdae_expression eta_t = sfdae_multiply(sfdae_parameter(record, "eta", eta), t);
  (void)user;
  F[0] = sfdae_subtract(sfdae_add(x[0], sfdae_multiply(eta_t, x[1])), sfdae_exp(sfdae_negate(t)));
  F[1] = sfdae_add(xdot[0], sfdae_multiply(eta_t, xdot[1]));
  F[1] = sfdae_add(F[1], sfdae_multiply(sfdae_add(sfdae_number(1), sfdae_parameter(record, "eta", 0)), x[1]));
  return 0;
}

static int gear_petzold_coefficients(sfdae_record* record, sfdae_expression t, sfdae_expression* E,
                                     sfdae_expression* A, sfdae_expression* f, void* user) {
  const sfdae_expression eta_t = sfdae_multiply(sfdae_parameter(record, "eta", eta), t);
  (void)user;
  E[1] = A[0] = sfdae_number(1);
  A[2] = E[3] = eta_t;
  A[3] = sfdae_number(-(1 + eta));
  f[0] = sfdae_negate(sfdae_exp(sfdae_negate(t)));
  return 0;
}

static int E(double t, int order, double* matrix, void* user) {
  (void)user;
  if (order == 0) matrix[1] = 1;
  if (order <= 1) matrix[3] = order == 0 ? eta * t : eta;
  return 0;
}
static int A(double t, int order, double* matrix, void* user) {
  (void)user;
  if (order == 0) matrix[0] = 1, matrix[3] = -(1 + eta);
  if (order <= 1) matrix[2] = order == 0 ? eta * t : eta;
  return 0;
}
static int f(double t, int order, double* vector, void* user) {
  (void)user;
  vector[0] = order % 2 ? exp(-t) : -exp(-t);
  return 0;
}

static void solve_linear(sfdae_solver* solver, double* x, double* M_array) {
  sfdae_derivative_check check;
  sfdae_characteristics c;
  double t = unset, T2[4], A2[4];
  int vhat = -1;
  sfdae_derivative_check_init(&check, sizeof check);
  sfdae_characteristics_init(&c, sizeof c);
  CHECK_STATUS(sfdae_analyze(solver, 0, 2, &c), SFDAE_OK);
  CHECK(c.strangeness_index == 1 && c.differential == 0 && c.algebraic == 2);
  x[0] = 5, x[1] = -3;
  CHECK_STATUS(sfdae_start(solver, 0, 2, x, NULL), SFDAE_VALUES_CHANGED);
  CHECK_STATUS(sfdae_advance(solver, 2, &t, x, NULL), SFDAE_OK);
  CHECK(fabs(x[0] - (1 - eta * t) * exp(-t)) <= 1e-13 && fabs(x[1] - exp(-t)) <= 1e-13);
  CHECK_STATUS(sfdae_check_derivatives(solver, 0.5, 2, &check), SFDAE_OK);
  CHECK(!check.suspicious);
  CHECK_STATUS(sfdae_get_derivative_array(solver, 0.5, 1, M_array, NULL, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_projectors(solver, 0.5, NULL, NULL, NULL, T2, &vhat), SFDAE_OK);
  CHECK_STATUS(sfdae_get_strangeness_free(solver, 0.5, NULL, NULL, NULL, A2, NULL, NULL), SFDAE_OK);
}

/* Whichever way the problem is given. */
static void linear_equations_are_solved_as_linear_problems(void) {
  double x[3][2], arrays[3][16];
  int form_of_problem, k;
  for (form_of_problem = 0; form_of_problem < 3; form_of_problem++) {
    sfdae_nonlinear_problem problem = pendulum_problem();
    sfdae_linear_problem linear;
    sfdae_solver* solver = NULL;
    problem.num_equations = problem.num_unknowns = 2;
    problem.num_prescribed = 0;
    if (form_of_problem == 0) problem.equations = gear_petzold;
    if (form_of_problem == 1) problem.linear_equations = gear_petzold_coefficients;
    sfdae_linear_problem_init(&linear, sizeof linear);
    linear.num_equations = linear.num_unknowns = 2;
    linear.E = E;
    linear.A = A;
    linear.f = f;
    if (form_of_problem < 2) solver = CREATE(&problem, NULL);
    else CHECK_STATUS(sfdae_create_linear(&solver, &linear, NULL), SFDAE_OK);
    solve_linear(solver, x[form_of_problem], arrays[form_of_problem]);
    if (form_of_problem < 2) {
      CHECK_STATUS(sfdae_set_parameter(solver, "eta", 3), SFDAE_OK);
      CHECK_STATUS(sfdae_start(solver, 0, 2, x[form_of_problem], NULL), SFDAE_VALUES_CHANGED);
      CHECK(fabs(x[form_of_problem][1] - 1) <= 1e-13 || form_of_problem == 1); /* A(1, 1) is no parameter there */
    }
    sfdae_destroy(&solver);
    for (k = 0; k < 16; k++) /* signs of rows may differ */
      CHECK(fabs(fabs(arrays[form_of_problem][k]) - fabs(arrays[0][k])) <= 1e-14);
  }
}

/* ---- Checkpoints ---------------------------------------------------------------------------------- */

static double* save(sfdae_solver* solver, size_t* length) {
  double* checkpoint;
  CHECK_STATUS(sfdae_get_checkpoint_length(solver, length), SFDAE_OK);
  checkpoint = (double*)malloc(*length * sizeof *checkpoint);
  CHECK_STATUS(sfdae_save_checkpoint(solver, checkpoint, *length), SFDAE_OK);
  return checkpoint;
}

/* Saved at every time of `times`, destroyed, created anew. */
static void restored_runs_go_on(void) {
  static const double times[] = {0, 0.001, 0.1, 0.15, 0.7, 1.6};
  int method, k, i;
  for (method = 0; method < 3; method++)
    for (k = 0; k < 2; k++)
      for (i = 0; i < 6; i++) {
        sfdae_nonlinear_problem problem = form(k);
        sfdae_options options = options_for(method, 1e-7);
        sfdae_solver* solver = CREATE(&problem, &options);
        double t, x[N], other_t, other_x[N], *checkpoint;
        size_t length;
        exact(0, x);
        sfdae_start(solver, 0, 2, x, NULL);
        if (times[i] > 0) CHECK_STATUS(sfdae_advance(solver, times[i], &t, x, NULL), SFDAE_OK);
        checkpoint = save(solver, &length);
        CHECK_STATUS(sfdae_advance(solver, 2, &t, x, NULL), SFDAE_OK);
        sfdae_destroy(&solver);

        solver = CREATE(&problem, &options);
        CHECK_STATUS(sfdae_restore_checkpoint(solver, checkpoint, length), SFDAE_OK);
        CHECK_STATUS(sfdae_advance(solver, 2, &other_t, other_x, NULL), SFDAE_OK);
        CHECK(t == other_t && accurate(t, x, 1e-6) && accurate(t, other_x, 1e-6));
        sfdae_destroy(&solver);
        free(checkpoint);
      }
}

/* Whatever a checkpoint contains: refused, or an integration with an answer, and no crash. */
static void damaged_checkpoints_are_survived(void) {
  static const double values[] = {-1, 0, 0.5, 7, 1e6, 1e18, -1e300};
  int method;
  for (method = 0; method < 2; method++) {
    sfdae_nonlinear_problem problem = recorded_pendulum();
    sfdae_options options = options_for(method, 1e-4);
    sfdae_solver* solver = CREATE(&problem, &options);
    double t, x[N], *checkpoint;
    size_t length, i;
    int k;
    options.max_steps = 20;
    sfdae_set_options(solver, &options);
    exact(0, x);
    sfdae_start(solver, 0, 2, x, NULL);
    sfdae_step(solver, 2, &t, x, NULL);
    sfdae_step(solver, 2, &t, x, NULL);
    checkpoint = save(solver, &length);
    for (i = 0; i < length; i++) CHECK(sfdae_restore_checkpoint(solver, checkpoint, i) == SFDAE_ILLEGAL_ARGUMENT);
    for (i = 0; i < length; i++)
      for (k = 0; k < 9; k++) {
        const double kept = checkpoint[i];
        int status;
        checkpoint[i] = k < 7 ? values[k] : k == 7 ? NAN : INFINITY;
        status = sfdae_restore_checkpoint(solver, checkpoint, length);
        checkpoint[i] = kept;
        CHECK(status == SFDAE_OK || status == SFDAE_ILLEGAL_ARGUMENT);
        if (status == SFDAE_OK) CHECK(sfdae_advance(solver, 0.2, &t, x, NULL) != SFDAE_INTERNAL);
      }
    CHECK_STATUS(sfdae_restore_checkpoint(solver, checkpoint, length), SFDAE_OK);
    options.max_steps = 1000;
    sfdae_set_options(solver, &options);
    CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
    CHECK(accurate(t, x, 1e-4));
    free(checkpoint);
    sfdae_destroy(&solver);
  }
}

int main(void) {
  both_forms_are_accurate_forward_and_backward();
  both_forms_do_the_same();
  steps_are_taken_one_by_one();
  restarts_take_other_values();
  what_is_free_is_held();
  wrong_inputs_are_refused();
  redundant_constraints_are_found();
  overdetermined_problems_are_solved();
  linear_equations_are_solved_as_linear_problems();
  restored_runs_go_on();
  damaged_checkpoints_are_survived();
  return failures != 0;
}
