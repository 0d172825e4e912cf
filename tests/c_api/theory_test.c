/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The theory's objects of nonlinear problems and of mechanical systems. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "../theory/theory_check.h"
#include "checks.h"

/* ---- A pendulum ------------------------------------------------------------------------------------------- */

/* x1' = x3, x2' = x4, x3' = -2 x1 x5, x4' = -2 x2 x5 - g, 0 = x1^2 + x2^2 - 1: mu = 2, d = 2, a = 3. */
enum { N = 5, MU = 2, D = 2, A = 3, ROWS = (MU + 1) * N };
static const double g = 9.81;

static sfdae_expression product(sfdae_expression a, sfdae_expression b) { return sfdae_multiply(a, b); }

static int formulas(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                    sfdae_expression* F, void* user) {
  const sfdae_expression two = sfdae_number(2), force = product(two, x[4]);
  (void)record, (void)t, (void)user;
  F[0] = sfdae_subtract(xdot[0], x[2]);
  F[1] = sfdae_subtract(xdot[1], x[3]);
  F[2] = sfdae_add(xdot[2], product(x[0], force));
  F[3] = sfdae_add(sfdae_add(xdot[3], product(x[1], force)), sfdae_number(g));
  F[4] = sfdae_subtract(sfdae_add(product(x[0], x[0]), product(x[1], x[1])), sfdae_number(1));
  return 0;
}

static double binomial(int n, int k) {
  double result = 1;
  int i;
  for (i = 1; i <= k; i++) result = result * (n - k + i) / i;
  return result;
}

/* The k-th derivative of x_i x_j along the jet, Leibniz's rule. */
static double leibniz(const double* jet, int i, int j, int k) {
  double sum = 0;
  int q;
  for (q = 0; q <= k; q++) sum += binomial(k, q) * jet[i + N * q] * jet[j + N * (k - q)];
  return sum;
}

/* Total derivatives written by hand. */
static int total_derivative(double t, int order, const double* jet, double* F, double* F_x, double* F_xdot,
                            void* user) {
  const double *x = jet + N * order, *xdot = x + N;
  const int* highest = (const int*)user;
  (void)t;
  if (highest && order > *highest) return SFDAE_ORDER_NOT_AVAILABLE;
  F[0] = xdot[0] - x[2];
  F[1] = xdot[1] - x[3];
  F[2] = xdot[2] + 2 * leibniz(jet, 0, 4, order);
  F[3] = xdot[3] + 2 * leibniz(jet, 1, 4, order) + (order == 0 ? g : 0);
  F[4] = leibniz(jet, 0, 0, order) + leibniz(jet, 1, 1, order) - (order == 0);
  if (F_x) {
    if (order == 0) F_x[0 + N * 2] = F_x[1 + N * 3] = -1;
    F_x[2 + N * 0] = F_x[3 + N * 1] = 2 * x[4];
    F_x[2 + N * 4] = F_x[4 + N * 0] = 2 * x[0];
    F_x[3 + N * 4] = F_x[4 + N * 1] = 2 * x[1];
  }
  if (F_xdot && order == 0) F_xdot[0] = F_xdot[1 + N] = F_xdot[2 + 2 * N] = F_xdot[3 + 3 * N] = 1;
  return 0;
}

static sfdae_solver* pendulum(int by_callback, int method, int* highest) {
  sfdae_nonlinear_problem problem;
  sfdae_options options;
  sfdae_solver* solver = NULL;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  sfdae_options_init(&options, sizeof options);
  options.method = method;
  options.rtol = options.atol = 1e-7;
  problem.num_equations = problem.num_unknowns = N;
  if (by_callback) problem.total_derivative = total_derivative, problem.user = highest;
  else problem.equations = formulas;
  CHECK_STATUS(sfdae_create_nonlinear(&solver, &problem, &options), SFDAE_OK);
  return solver;
}

/* ---- Arrays ------------------------------------------------------------------------------------------------- */

/* Blocks (i, j) of M are C(i,j) (F_x')^(i-j) + C(i,j+1) (F_x)^(i-j-1), here with a constant F_x'; N_i = -(F_x)^(i),
 * g_i = -F^(i): at any jet, consistent or not, analyzed or not. */
static void array_has_the_blocks_written_by_hand(void) {
  enum { LEVEL = 3, M_ROWS = (LEVEL + 1) * N };
  double jet[N * (LEVEL + 2)], M[M_ROWS * M_ROWS], array_N[M_ROWS * N], array_g[M_ROWS];
  int by_callback, i, j, row, column;
  for (i = 0; i < N * (LEVEL + 2); i++) jet[i] = sin(1.0 + 3 * i);
  for (by_callback = 0; by_callback < 2; by_callback++) {
    sfdae_solver* solver = pendulum(by_callback, SFDAE_METHOD_BDF, NULL);
    double worst = 0;
    CHECK_STATUS(sfdae_get_derivative_array_at(solver, 0.5, jet, LEVEL, M, array_N, array_g), SFDAE_OK);
    for (i = 0; i <= LEVEL; i++) {
      double F[LEVEL + 1][N], F_x[LEVEL + 1][N * N] = {{0}}, F_xdot[LEVEL + 1][N * N] = {{0}};
      for (j = 0; j <= LEVEL; j++) total_derivative(0.5, j, jet, F[j], F_x[j], F_xdot[j], NULL);
      for (row = 0; row < N; row++) {
        worst = fmax(worst, fabs(array_g[i * N + row] + F[i][row]));
        for (column = 0; column < N; column++) {
          const int entry = row + N * column;
          worst = fmax(worst, fabs(array_N[i * N + row + M_ROWS * column] + F_x[i][entry]));
          for (j = 0; j <= LEVEL; j++) {
            double expected = 0;
            if (j <= i) expected += binomial(i, j) * F_xdot[i - j][entry];
            if (j < i) expected += binomial(i, j + 1) * F_x[i - j - 1][entry];
            worst = fmax(worst, fabs(M[i * N + row + M_ROWS * (j * N + column)] - expected));
          }
        }
      }
    }
    CHECK(worst <= 1000 * DBL_EPSILON); /* entries up to 20, sums of up to 10 terms, factorials back and forth */
    sfdae_destroy(&solver);
  }
}

/* For E x' = A x + f the array at a jet is that at t, and g what is left of it: g + N x - M y. At 0 it is the same. */
static int linear_E(double t, int order, double* matrix, void* user) {
  (void)user;
  if (order == 0) matrix[1] = 1, matrix[3] = -t;
  if (order == 1) matrix[3] = -1;
  return 0;
}
static int linear_A(double t, int order, double* matrix, void* user) {
  (void)user;
  if (order == 0) matrix[0] = -1, matrix[2] = t;
  if (order == 1) matrix[2] = 1;
  return 0;
}
static int linear_f(double t, int order, double* vector, void* user) {
  (void)user;
  vector[0] = order % 2 ? -exp(-t) : exp(-t);
  return 0;
}

static void linear_problems_are_a_special_case(void) {
  sfdae_linear_problem problem;
  sfdae_solver* solver = NULL;
  const double t = 0.3, e = exp(-t), zero[6] = {0};
  /* x = ((1 + t) e^-t, e^-t) with x', x'', determined at level 2. */
  const double exact[8] = {(1 + t) * e, e, -t * e, -e, (t - 1) * e, e, (2 - t) * e, -e};
  double M[16], N_[8], g_[4], M_at[16], N_at[8], g_at[4], jet[8], f1[2], f2[2], residual;
  int i;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 2;
  problem.E = linear_E, problem.A = linear_A, problem.f = linear_f;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_jet(solver, t, exact, 2, jet), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_analyze(solver, 0, 1, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_jet(solver, t, NULL, 2, jet), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_get_derivative_array(solver, t, 1, M, N_, g_), SFDAE_OK);
  CHECK_STATUS(sfdae_get_derivative_array_at(solver, t, zero, 1, M_at, N_at, g_at), SFDAE_OK);
  CHECK(memcmp(M, M_at, sizeof M) == 0 && memcmp(N_, N_at, sizeof N_) == 0 && memcmp(g_, g_at, sizeof g_) == 0);
  CHECK_STATUS(sfdae_get_derivative_array_at(solver, t, exact, 1, M_at, N_at, g_at), SFDAE_OK);
  CHECK(memcmp(M, M_at, sizeof M) == 0 && memcmp(N_, N_at, sizeof N_) == 0);
  for (i = 0; i < 4; i++) CHECK(fabs(g_at[i]) <= 20 * DBL_EPSILON);
  CHECK_STATUS(sfdae_get_strangeness_free_at(solver, t, exact, NULL, NULL, f1, NULL, f2, &residual), SFDAE_OK);
  CHECK(fabs(f2[0]) <= 20 * DBL_EPSILON && fabs(f2[1]) <= 20 * DBL_EPSILON);
  {
    double x[2] = {exact[0], exact[1]};
    CHECK_STATUS(sfdae_get_jet(solver, t, x, 2, jet), SFDAE_OK);
    for (i = 0; i < 4; i++) CHECK(fabs(jet[i] - exact[i]) <= 1000 * DBL_EPSILON); /* x and x'; x'' stays open */
    x[0] += 1e-3;
    CHECK_STATUS(sfdae_get_jet(solver, t, x, 2, jet), SFDAE_INCONSISTENT_VALUES);
  }
  sfdae_destroy(&solver);
}

/* ---- Along solutions ---------------------------------------------------------------------------------------- */

static void properties_hold_along_the_pendulum(void) {
  int by_callback, method, step;
  for (by_callback = 0; by_callback < 2; by_callback++)
    for (method = SFDAE_METHOD_BDF; method <= SFDAE_METHOD_RADAU; method++) {
      sfdae_solver* solver = pendulum(by_callback, method, NULL);
      const theory_subject subject = {"pendulum", THEORY_NONLINEAR, N, N, solver};
      double x[N] = {0.8, -0.6, 0, 0, 0}, xdot[N], t = 0;
      CHECK_STATUS(sfdae_analyze_at(solver, 0, 1, x, NULL), SFDAE_OK);
      CHECK(theory_check(&subject, 0) == 0); /* the point of the analysis */
      CHECK_STATUS(sfdae_start(solver, 0, 2, x, NULL), SFDAE_OK);
      CHECK(theory_check(&subject, 0) == 0);
      for (step = 0; step < 6; step++) {
        sfdae_statistics s;
        double level0[2 * N], M[N * N], Z1[N * D], left[N];
        int i, k;
        CHECK_STATUS(sfdae_step(solver, 2, &t, x, xdot), SFDAE_STEP_TAKEN);
        CHECK(theory_check(&subject, t) == 0);
        /* x' of the integrator: its error is about that of x over the step. */
        sfdae_statistics_init(&s, sizeof s);
        sfdae_get_statistics(solver, &s);
        memcpy(level0, x, sizeof x);
        memcpy(level0 + N, xdot, sizeof xdot);
        CHECK_STATUS(sfdae_get_derivative_array_at(solver, t, level0, 0, M, NULL, left), SFDAE_OK);
        CHECK_STATUS(sfdae_get_projectors(solver, t, Z1, NULL, NULL, NULL, NULL), SFDAE_OK);
        for (i = 0; i < D; i++) {
          double sum = 0;
          for (k = 0; k < N; k++) sum += Z1[k + N * i] * left[k];
          CHECK(fabs(sum) <= 100 * 1e-7 * (1 + g) / fmin(1, fabs(s.last_step)));
        }
      }
      sfdae_destroy(&solver);
    }
}

static void jets_are_those_of_the_solution(void) {
  sfdae_solver* solver = pendulum(0, SFDAE_METHOD_BDF, NULL);
  double x[N] = {0.8, -0.6, 0, 0, 0}, xdot[N], jet[N * (MU + 4)], wrong[N];
  int i;
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, xdot), SFDAE_OK);
  /* At level mu + 1 x' is that of the solution. */
  CHECK_STATUS(sfdae_get_jet(solver, 0, NULL, MU + 2, jet), SFDAE_OK);
  for (i = 0; i < N; i++) CHECK(fabs(jet[i] - x[i]) <= 1e-14 && fabs(jet[N + i] - xdot[i]) <= 1e-11);
  /* 2 x5 = v^2 - g x2: from rest x5' = v v' - g x4 / 2 = 0. */
  CHECK(fabs(jet[N + 4]) <= 1e-11);
  CHECK_STATUS(sfdae_get_jet(solver, 0, x, MU, jet), SFDAE_OK);
  memcpy(wrong, x, sizeof x);
  wrong[4] += 0.1; /* hidden constraints count */
  CHECK_STATUS(sfdae_get_jet(solver, 0, wrong, MU, jet), SFDAE_INCONSISTENT_VALUES);
  CHECK(strstr(sfdae_message(solver), "sfdae_make_consistent") != NULL);
  sfdae_destroy(&solver);
}

static void looking_inside_leaves_integrations_alone(void) {
  int method, step;
  for (method = SFDAE_METHOD_BDF; method <= SFDAE_METHOD_RADAU; method++) {
    sfdae_solver *looked_at = pendulum(0, method, NULL), *left_alone = pendulum(0, method, NULL);
    const theory_subject subject = {"pendulum", THEORY_NONLINEAR, N, N, looked_at};
    double x[N] = {0.8, -0.6, 0, 0, 0}, y[N] = {0.8, -0.6, 0, 0, 0}, t = 0, before;
    CHECK_STATUS(sfdae_start(looked_at, 0, 5, x, NULL), SFDAE_OK);
    CHECK_STATUS(sfdae_start(left_alone, 0, 5, y, NULL), SFDAE_OK);
    for (step = 0; step < 40 && t < 5; step++) {
      before = t;
      sfdae_step(left_alone, 5, &t, y, NULL);
      sfdae_step(looked_at, 5, &t, x, NULL);
      CHECK(memcmp(x, y, sizeof x) == 0);
      CHECK(theory_check(&subject, before + 0.7 * (t - before)) == 0);
    }
    sfdae_destroy(&looked_at);
    sfdae_destroy(&left_alone);
  }
}

/* ---- Mechanical systems -------------------------------------------------------------------------------------- */

/* The pendulum again, q = (x1, x2), G^T lambda for the force. user: copies of the constraint beside it, e^x1 times as
 * large, redundant. */
static int forces(double t, const double* q, const double* v, double* f, void* user) {
  (void)t, (void)q, (void)v, (void)user;
  f[1] = -g;
  return 0;
}
static int constraints(double t, const double* q, double* c, void* user) {
  const double value = q[0] * q[0] + q[1] * q[1] - 1;
  (void)t;
  c[0] = value;
  if (user) c[1] = exp(q[0]) * value;
  return 0;
}
static int constraint_jacobian(double t, const double* q, double* G, void* user) {
  const double value = q[0] * q[0] + q[1] * q[1] - 1, e = exp(q[0]);
  const int rows = user ? 2 : 1;
  (void)t;
  G[0] = 2 * q[0];
  G[rows] = 2 * q[1];
  if (user) G[1] = e * (2 * q[0] + value), G[1 + rows] = e * 2 * q[1];
  return 0;
}
static int mechanical_formulas(sfdae_record* record, sfdae_expression t, const sfdae_expression* q,
                               const sfdae_expression* v, const sfdae_multibody_formulas* to, void* user) {
  const sfdae_expression value = sfdae_subtract(sfdae_add(product(q[0], q[0]), product(q[1], q[1])), sfdae_number(1));
  (void)t, (void)v;
  to->M[0] = to->M[3] = sfdae_number(1);
  to->f[1] = sfdae_negate(sfdae_parameter(record, "g", g));
  to->g[0] = value;
  if (user) to->g[1] = product(sfdae_exp(q[0]), value);
  return 0;
}

static sfdae_solver* mechanical(int by_callbacks, void* redundant) {
  sfdae_multibody_problem problem;
  sfdae_solver* solver = NULL;
  sfdae_multibody_problem_init(&problem, sizeof problem);
  problem.num_positions = 2;
  problem.num_constraints = redundant ? 2 : 1;
  problem.user = redundant;
  if (by_callbacks) {
    problem.forces = forces;
    problem.constraints = constraints;
    problem.constraint_jacobian = constraint_jacobian;
  } else {
    problem.equations = mechanical_formulas;
  }
  CHECK_STATUS(sfdae_create_multibody(&solver, &problem, NULL), SFDAE_OK);
  return solver;
}

static void properties_hold_for_mechanical_systems(void) {
  static int yes;
  int by_callbacks, redundant, step;
  for (by_callbacks = 0; by_callbacks < 2; by_callbacks++)
    for (redundant = 0; redundant < 2; redundant++) {
      const int n = 5 + redundant;
      sfdae_solver* solver = mechanical(by_callbacks, redundant ? &yes : NULL);
      const theory_subject subject = {"mechanical pendulum",
                                      by_callbacks ? THEORY_MULTIBODY_CALLBACKS : THEORY_MULTIBODY, n, n, solver};
      double x[6] = {0.8, -0.6, 0, 0, 0, 0}, t = 0;
      CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
      CHECK(theory_check(&subject, 0) == 0);
      for (step = 0; step < 4; step++) {
        CHECK_STATUS(sfdae_step(solver, 1, &t, x, NULL), SFDAE_STEP_TAKEN);
        CHECK(theory_check(&subject, t) == 0);
      }
      if (!by_callbacks) { /* all equations know of another value */
        CHECK_STATUS(sfdae_set_parameter(solver, "g", 5), SFDAE_OK);
        CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
        CHECK(theory_check(&subject, 0) == 0);
      }
      sfdae_destroy(&solver);
    }
}

/* What A2 says of the multipliers, -dmu + mu_q dq + mu_v dv = 0 along T2, is what they do at consistent points
 * near by: differences with steps of 1e-4 have errors of 1e-8 times third derivatives below 100. */
static void multipliers_follow_A2(void) {
  static int yes;
  int by_callbacks, redundant, i, j, side;
  for (by_callbacks = 0; by_callbacks < 2; by_callbacks++)
    for (redundant = 0; redundant < 2; redundant++) {
      const int n = 5 + redundant, a = n - 2;
      const double step = 1e-4;
      sfdae_solver* solver = mechanical(by_callbacks, redundant ? &yes : NULL);
      double x[6] = {0.8, -0.6, 0.3, 0.4, 0, 0}, T2[12], A2[24];
      CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
      CHECK_STATUS(sfdae_get_projectors(solver, 0, NULL, NULL, NULL, T2, NULL), SFDAE_OK);
      CHECK_STATUS(sfdae_get_strangeness_free(solver, 0, NULL, NULL, NULL, A2, NULL, NULL), SFDAE_OK);
      for (j = 0; j < 2; j++) {
        double moved[2][6] = {{0}};
        for (side = 0; side < 2; side++) {
          for (i = 0; i < n; i++) moved[side][i] = x[i] + (side ? step : -step) * T2[i + n * j];
          CHECK_STATUS(sfdae_make_consistent(solver, 0, moved[side], NULL), SFDAE_OK);
        }
        for (i = 4; i < n; i++) {
          int row;
          const double slope = (moved[1][i] - moved[0][i]) / (2 * step);
          double found = 0;
          for (row = 0; row < 4; row++) found += A2[a - (n - 4) + (i - 4) + a * row] * T2[row + n * j];
          CHECK(fabs(slope - T2[i + n * j]) <= 1e-5 && fabs(slope - found) <= 1e-5);
        }
      }
      sfdae_destroy(&solver);
    }
}

/* x = (q, v, lambda) from rest at (0.8, -0.6): lambda = -g x2 / 2, v' = -g (0, 1) - 2 q lambda. */
static void callbacks_give_what_they_can(void) {
  sfdae_solver* solver = mechanical(1, NULL);
  double x[5] = {0.8, -0.6, 0, 0, 0}, jet[20], M[25], array_N[25], left[5], Z1[10], Z2[45], T2[10];
  const double lambda = g * 0.6 / 2;
  int vhat = -7, i;
  CHECK_STATUS(sfdae_get_jet(solver, 0, x, 0, jet), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_jet(solver, 0, NULL, 0, jet), SFDAE_OK);
  CHECK(fabs(jet[4] - lambda) <= 1e-13 && fabs(jet[7] + 2 * 0.8 * lambda) <= 1e-13);
  CHECK(fabs(jet[8] - (-g + 2 * 0.6 * lambda)) <= 1e-13 && fabs(jet[9]) <= 1e-6);
  CHECK_STATUS(sfdae_get_derivative_array(solver, 0, 0, M, array_N, left), SFDAE_OK);
  for (i = 0; i < 5; i++) CHECK(fabs(left[i]) <= 1e-13 && M[6 * i] == (i < 4));
  /* N = -F_x: q' = v, v' = f - 2 q lambda, -g. */
  CHECK(array_N[0 + 5 * 2] == 1 && fabs(array_N[2 + 5 * 0] + 2 * lambda) <= 1e-6);
  CHECK(fabs(array_N[2 + 5 * 4] + 1.6) <= 1e-13 && fabs(array_N[4 + 5 * 0] + 1.6) <= 1e-13);
  CHECK_STATUS(sfdae_get_projectors(solver, 0, Z1, NULL, NULL, T2, NULL), SFDAE_OK);
  memset(Z2, 0xA5, sizeof Z2);
  CHECK_STATUS(sfdae_get_projectors(solver, 0, Z1, Z2, NULL, T2, NULL), SFDAE_ORDER_MISSING);
  CHECK_STATUS(sfdae_get_projectors(solver, 0, Z1, NULL, NULL, T2, &vhat), SFDAE_ORDER_MISSING);
  CHECK(vhat == -7 && ((unsigned char*)Z2)[0] == 0xA5);
  CHECK(strstr(sfdae_message(solver), "formulas") != NULL);
  CHECK_STATUS(sfdae_get_derivative_array(solver, 0, 1, NULL, NULL, NULL), SFDAE_ORDER_MISSING);
  CHECK_STATUS(sfdae_get_jet(solver, 0, NULL, 1, jet), SFDAE_ORDER_MISSING);
  sfdae_destroy(&solver);
}

/* ---- Wrong use ------------------------------------------------------------------------------------------------ */

static void wrong_calls_leave_outputs_alone(void) {
  enum { SIZE = 400 };
  int highest = MU;
  sfdae_solver *solver = pendulum(1, SFDAE_METHOD_BDF, &highest), *system = mechanical(0, NULL);
  double x[N] = {0.8, -0.6, 0, 0, 0}, jet[SIZE] = {0}, out[SIZE], t = 0;
  const double nan = NAN, no_numbers[N] = {NAN, NAN, NAN, NAN, NAN};
  int vhat = -7;
  size_t i;
  memset(out, 0xA5, sizeof out);
  CHECK_STATUS(sfdae_get_jet(solver, 0, x, 0, out), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_get_derivative_array(solver, 0, 0, out, out, out), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_get_projectors(solver, 0, out, out, out, out, &vhat), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_get_projectors_at(solver, 0, jet, out, out, out, out, &vhat), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_get_strangeness_free(solver, 0, out, out, out, out, out, out), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_get_strangeness_free_at(solver, 0, jet, out, out, out, out, out, out), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_get_extended_system(system, 0, NULL, out, out, out, out, out, out), SFDAE_NOT_STARTED);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_step(solver, 1, &t, x, NULL), SFDAE_STEP_TAKEN);
  CHECK_STATUS(sfdae_get_extended_system(solver, t, NULL, out, out, out, out, out, out), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_jet(solver, t, NULL, -1, out), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_jet(solver, t, NULL, 13, out), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_jet(solver, nan, NULL, 0, out), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_jet(solver, t, no_numbers, 0, out), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_jet(solver, t, x, 0, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_jet(solver, t + 1, NULL, 0, out), SFDAE_ILLEGAL_ARGUMENT); /* outside the last step */
  CHECK_STATUS(sfdae_get_jet(solver, t, NULL, MU + 2, out), SFDAE_ORDER_MISSING);
  CHECK_STATUS(sfdae_get_derivative_array(solver, t - 1, 0, out, out, out), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_derivative_array(solver, t, MU + 1, out, out, out), SFDAE_ORDER_MISSING);
  CHECK_STATUS(sfdae_get_derivative_array_at(solver, t, NULL, 0, out, out, out), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_derivative_array_at(solver, t, jet, 13, out, out, out), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_projectors_at(solver, t, NULL, out, out, out, out, &vhat), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_strangeness_free_at(solver, t, NULL, out, out, out, out, out, out), SFDAE_ILLEGAL_ARGUMENT);
  jet[3] = HUGE_VAL;
  CHECK_STATUS(sfdae_get_derivative_array_at(solver, t, jet, 0, out, out, out), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_projectors_at(solver, t, jet, out, out, out, out, &vhat), SFDAE_ILLEGAL_ARGUMENT);
  for (i = 0; i < sizeof out; i++) CHECK(((unsigned char*)out)[i] == 0xA5);
  CHECK(vhat == -7);
  CHECK_STATUS(sfdae_get_jet(NULL, 0, x, 0, out), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_derivative_array_at(NULL, 0, jet, 0, out, out, out), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_extended_system(NULL, 0, NULL, out, out, out, out, out, out), SFDAE_ILLEGAL_ARGUMENT);
  sfdae_destroy(&solver);
  sfdae_destroy(&system);
}

int main(void) {
  array_has_the_blocks_written_by_hand();
  linear_problems_are_a_special_case();
  properties_hold_along_the_pendulum();
  jets_are_those_of_the_solution();
  looking_inside_leaves_integrations_alone();
  properties_hold_for_mechanical_systems();
  multipliers_follow_A2();
  callbacks_give_what_they_can();
  wrong_calls_leave_outputs_alone();
  return failures != 0;
}
