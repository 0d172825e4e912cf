/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Derivative array, projectors and strangeness-free system by their defining properties.
 */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <sfdae/sfdae.h>

#include "checks.h"

static const double half_pi = 1.57079632679489661923;
static double sine(double t, int order) { return sin(t + order * half_pi); }
static double cosine(double t, int order) { return cos(t + order * half_pi); }

/* ---- The problems --------------------------------------------------------------------------------- */

/* GELDA's document problem:  0 = -x1 + t x2 + e^-t,  x1' - t x2' = 0;  x = ((1 + t) e^-t, e^-t).
 * mu = 1, d = 0, a = 2; M has rank 2 of 4 rows: vhat = 0. */
static int gelda_E(double t, int order, double* matrix, void* user) {
  (void)user;
  if (order == 0) matrix[1] = 1, matrix[3] = -t;
  if (order == 1) matrix[3] = -1;
  return 0;
}
static int gelda_A(double t, int order, double* matrix, void* user) {
  (void)user;
  if (order == 0) matrix[0] = -1, matrix[2] = t;
  if (order == 1) matrix[2] = 1;
  return 0;
}
static int gelda_f(double t, int order, double* vector, void* user) {
  (void)user;
  vector[0] = order % 2 ? -exp(-t) : exp(-t);
  return 0;
}

/* A reaction with its conservation law, 3 equations for 2 unknowns, k = 1 + sin(t) / 2:
 * x1' = -k x1,  x2' = k x1,  0 = x1 + x2 - 1.  The derivative of the law follows from the others:
 * mu = 1, d = 1, a = 1, v = 1; M has rank 4 of 6 rows: vhat = 1. */
static int reaction_E(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) matrix[0] = matrix[4] = 1;
  return 0;
}
static int reaction_A(double t, int order, double* matrix, void* user) {
  const double k = (order == 0 ? 1 : 0) + 0.5 * sine(t, order);
  (void)user;
  matrix[0] = -k;
  matrix[1] = k;
  if (order == 0) matrix[2] = matrix[5] = 1;
  return 0;
}
static int reaction_f(double t, int order, double* vector, void* user) {
  (void)t, (void)user;
  if (order == 0) vector[2] = -1;
  return 0;
}

/* 3 equations for 4 unknowns:  c x1' + s x2' = x3 + s,  0 = c x1 + s x2 + e^-t,  x4' = x1 - x4 + 1,
 * c = cos t, s = sin t. The derivative of the second row and the first give 0 = x3 + s - s x1 + c x2 - e^-t:
 * mu = 1, d = 1, a = 2, u = 1; M has rank 4 of 6 rows: vhat = 0. */
static int turning_E(double t, int order, double* matrix, void* user) {
  (void)user;
  matrix[0] = cosine(t, order);
  matrix[3] = sine(t, order);
  if (order == 0) matrix[2 + 3 * 3] = 1;
  return 0;
}
static int turning_A(double t, int order, double* matrix, void* user) {
  (void)user;
  matrix[1 + 3 * 0] = cosine(t, order);
  matrix[1 + 3 * 1] = sine(t, order);
  if (order == 0) {
    matrix[0 + 3 * 2] = 1;
    matrix[2 + 3 * 0] = 1;
    matrix[2 + 3 * 3] = -1;
  }
  return 0;
}
static int turning_f(double t, int order, double* vector, void* user) {
  (void)user;
  vector[0] = sine(t, order);
  vector[1] = order % 2 ? -exp(-t) : exp(-t);
  if (order == 0) vector[2] = 1;
  return 0;
}

/* x1' = x2, x2' = -x1: mu = 0, d = 2, and nothing else. */
static int spring_E(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) matrix[0] = matrix[3] = 1;
  return 0;
}
static int spring_A(double t, int order, double* matrix, void* user) {
  (void)t, (void)user;
  if (order == 0) matrix[1] = -1, matrix[2] = 1;
  return 0;
}

static const struct example {
  const char* name;
  int m, n;
  sfdae_matrix_function E, A;
  sfdae_vector_function f;
  int mu, d, a, u, v, vhat;
} examples[] = {
    {"gelda", 2, 2, gelda_E, gelda_A, gelda_f, 1, 0, 2, 0, 0, 0},
    {"reaction", 3, 2, reaction_E, reaction_A, reaction_f, 1, 1, 1, 0, 1, 1},
    {"turning", 3, 4, turning_E, turning_A, turning_f, 1, 1, 2, 1, 0, 0},
    {"spring", 2, 2, spring_E, spring_A, NULL, 0, 2, 0, 0, 0, 0},
};

static sfdae_solver* create(const struct example* example, int reduction) {
  sfdae_linear_problem problem;
  sfdae_options options;
  sfdae_solver* solver = NULL;
  sfdae_linear_problem_init(&problem, sizeof problem);
  sfdae_options_init(&options, sizeof options);
  options.reduction = reduction;
  problem.num_equations = example->m;
  problem.num_unknowns = example->n;
  problem.E = example->E;
  problem.A = example->A;
  problem.f = example->f;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, &options), SFDAE_OK);
  return solver;
}

/* ---- Small dense algebra ----------------------------------------------------------------------------- */

enum { ENTRIES = 64 };

/* X^T Y, X is r x p, Y is r x q. */
static void transpose_product(const double* X, const double* Y, int r, int p, int q, double* result) {
  int i, j, k;
  for (j = 0; j < q; j++)
    for (i = 0; i < p; i++) {
      double sum = 0;
      for (k = 0; k < r; k++) sum += X[k + r * i] * Y[k + r * j];
      result[i + p * j] = sum;
    }
}

/* X Y, X is r x p, Y is p x q. */
static void product(const double* X, const double* Y, int r, int p, int q, double* result) {
  int i, j, k;
  for (j = 0; j < q; j++)
    for (i = 0; i < r; i++) {
      double sum = 0;
      for (k = 0; k < p; k++) sum += X[i + r * k] * Y[k + p * j];
      result[i + r * j] = sum;
    }
}

static double max_abs(const double* X, int count) {
  double max = 0;
  int i;
  for (i = 0; i < count; i++) {
    if (!(fabs(X[i]) <= DBL_MAX)) return HUGE_VAL;
    if (fabs(X[i]) > max) max = fabs(X[i]);
  }
  return max;
}

static double max_difference(const double* X, const double* Y, int count) {
  double max = 0;
  int i;
  for (i = 0; i < count; i++) {
    const double difference = fabs(X[i] - Y[i]);
    if (!(difference <= DBL_MAX)) return HUGE_VAL;
    if (difference > max) max = difference;
  }
  return max;
}

static double larger(double a, double b) { return a > b ? a : b; }

/* What rounding errors amount to in sums of a few terms of size `scale`. */
static double rounding(double scale) { return 100 * DBL_EPSILON * larger(scale, 1); }

static int orthonormal(const double* Q, int rows, int columns) {
  double product_with_itself[ENTRIES];
  int i;
  transpose_product(Q, Q, rows, columns, columns, product_with_itself);
  for (i = 0; i < columns; i++) product_with_itself[i + columns * i] -= 1;
  return max_abs(product_with_itself, columns * columns) <= rounding(1);
}

/* Rank of X by elimination with full pivoting; for matrices whose rank is obvious. */
static int rank_of(const double* matrix, int rows, int columns) {
  double X[ENTRIES];
  const double size = larger(max_abs(matrix, rows * columns), DBL_MIN);
  int rank, i, j;
  memcpy(X, matrix, sizeof(double) * (size_t)(rows * columns));
  for (rank = 0; rank < rows && rank < columns; rank++) {
    int row = rank, column = rank;
    for (j = rank; j < columns; j++)
      for (i = rank; i < rows; i++)
        if (fabs(X[i + rows * j]) > fabs(X[row + rows * column])) row = i, column = j;
    if (fabs(X[row + rows * column]) <= 1e-10 * size) break;
    for (j = 0; j < columns; j++) {
      const double swapped = X[rank + rows * j];
      X[rank + rows * j] = X[row + rows * j];
      X[row + rows * j] = swapped;
    }
    for (i = 0; i < rows; i++) {
      const double swapped = X[i + rows * rank];
      X[i + rows * rank] = X[i + rows * column];
      X[i + rows * column] = swapped;
    }
    for (i = rank + 1; i < rows; i++) {
      const double factor = X[i + rows * rank] / X[rank + rows * rank];
      for (j = rank; j < columns; j++) X[i + rows * j] -= factor * X[rank + rows * j];
    }
  }
  return rank;
}

/* ---- Derivative array ---------------------------------------------------------------------------------- */

/* At t = 1/2:  E = [0 0; 1 -1/2], E' = [0 0; 0 -1], A = [-1 1/2; 0 0], A' = [0 1; 0 0], by hand
 *   E' - A = [1 -1/2; 0 -1],   E'' - 2 A' = [0 -2; 0 0],   2 E' - A = [1 -1/2; 0 -2] */
static void array_has_the_blocks_computed_by_hand(void) {
  static const double M_rows[6][6] = {
      {0, 0, 0, 0, 0, 0},     {1, -0.5, 0, 0, 0, 0},  /* E */
      {1, -0.5, 0, 0, 0, 0},  {0, -1, 1, -0.5, 0, 0}, /* E' - A, E */
      {0, -2, 1, -0.5, 0, 0}, {0, 0, 0, -2, 1, -0.5}, /* E'' - 2 A', 2 E' - A, E */
  };
  static const double N_rows[6][2] = {{-1, 0.5}, {0, 0}, {0, 1}, {0, 0}, {0, 0}, {0, 0}};
  const double e = exp(-0.5);
  const double g_rows[6] = {e, 0, -e, 0, e, 0};
  sfdae_solver* solver = create(&examples[0], SFDAE_REDUCTION_STAGED);
  double M[36], N[12], g[6];
  int level, i, j;
  for (level = 0; level <= 2; level++) {
    const int rows = 2 * (level + 1);
    CHECK_STATUS(sfdae_get_derivative_array(solver, 0.5, level, M, N, g), SFDAE_OK);
    for (i = 0; i < rows; i++) {
      for (j = 0; j < rows; j++) CHECK(fabs(M[i + rows * j] - M_rows[i][j]) <= rounding(1));
      for (j = 0; j < 2; j++) CHECK(fabs(N[i + rows * j] - N_rows[i][j]) <= rounding(1));
      CHECK(fabs(g[i] - g_rows[i]) <= rounding(1));
    }
  }
  sfdae_destroy(&solver);
}

/* M y = N x + g holds for the derivatives of any solution: x1^(k) = (-1)^k (1 + t - k) e^-t, x2^(k) = (-1)^k e^-t. */
static void exact_solution_satisfies_the_array(void) {
  enum { LEVEL = 4, ROWS = 2 * (LEVEL + 1) };
  const double t = 0.3;
  sfdae_solver* solver = create(&examples[0], SFDAE_REDUCTION_STAGED);
  double M[ROWS * ROWS], N[ROWS * 2], g[ROWS], y[ROWS], x[2], My[ROWS], Nx[ROWS];
  int i, k;
  x[0] = (1 + t) * exp(-t);
  x[1] = exp(-t);
  for (k = 1; k <= LEVEL + 1; k++) {
    const double sign = k % 2 ? -1 : 1;
    y[2 * (k - 1)] = sign * (1 + t - k) * exp(-t);
    y[2 * (k - 1) + 1] = sign * exp(-t);
  }
  CHECK_STATUS(sfdae_get_derivative_array(solver, t, LEVEL, M, N, g), SFDAE_OK);
  product(M, y, ROWS, ROWS, 1, My);
  product(N, x, ROWS, 2, 1, Nx);
  for (i = 0; i < ROWS; i++)
    CHECK(fabs(My[i] - Nx[i] - g[i]) <= rounding(ROWS * max_abs(M, ROWS * ROWS) * max_abs(y, ROWS)));
  sfdae_destroy(&solver);
}

static void parts_of_the_array_may_be_left_out(void) {
  sfdae_solver* solver = create(&examples[0], SFDAE_REDUCTION_STAGED);
  double M[16], N[8], g[4], M_alone[16], N_alone[8], g_alone[4];
  CHECK_STATUS(sfdae_get_derivative_array(solver, 0.5, 1, M, N, g), SFDAE_OK);
  CHECK_STATUS(sfdae_get_derivative_array(solver, 0.5, 1, M_alone, NULL, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_derivative_array(solver, 0.5, 1, NULL, N_alone, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_get_derivative_array(solver, 0.5, 1, NULL, NULL, g_alone), SFDAE_OK);
  CHECK_STATUS(sfdae_get_derivative_array(solver, 0.5, 1, NULL, NULL, NULL), SFDAE_OK);
  CHECK(memcmp(M, M_alone, sizeof M) == 0 && memcmp(N, N_alone, sizeof N) == 0 && memcmp(g, g_alone, sizeof g) == 0);
  sfdae_destroy(&solver);
}

/* ---- Projectors ------------------------------------------------------------------------------------------ */

static void check_characteristics(const struct example* example, sfdae_solver* solver) {
  sfdae_characteristics c;
  sfdae_characteristics_init(&c, sizeof c);
  CHECK_STATUS(sfdae_analyze(solver, 0.2, 1, &c), example->u ? SFDAE_NOT_UNIQUE : SFDAE_OK);
  CHECK(c.strangeness_index == example->mu && c.differential == example->d && c.algebraic == example->a);
  CHECK(c.undetermined == example->u && c.redundant == example->v);
}

static void check_point(const struct example* example, sfdae_solver* solver, double t) {
  const int m = example->m, n = example->n, d = example->d, a = example->a;
  const int rows = (example->mu + 1) * m, columns = (example->mu + 1) * n;
  double M[ENTRIES], N[ENTRIES], g[ENTRIES], E[ENTRIES] = {0}, A[ENTRIES] = {0}, f[ENTRIES] = {0};
  double Z1[ENTRIES], Z2[ENTRIES], Z3[ENTRIES], T2[ENTRIES], P[ENTRIES], Q[ENTRIES];
  double E1[ENTRIES], A1[ENTRIES], f1[ENTRIES], A2[ENTRIES], f2[ENTRIES], residual = -1;
  double size;
  int vhat = -1, i;

  CHECK_STATUS(sfdae_get_derivative_array(solver, t, example->mu, M, N, g), SFDAE_OK);
  CHECK_STATUS(sfdae_get_projectors(solver, t, NULL, NULL, NULL, NULL, &vhat), SFDAE_OK);
  CHECK(vhat == example->vhat);
  if (vhat != example->vhat) return;
  CHECK_STATUS(sfdae_get_projectors(solver, t, Z1, Z2, Z3, T2, &vhat), SFDAE_OK);
  CHECK_STATUS(sfdae_get_strangeness_free(solver, t, E1, A1, f1, A2, f2, &residual), SFDAE_OK);
  example->E(t, 0, E, NULL);
  example->A(t, 0, A, NULL);
  if (example->f) example->f(t, 0, f, NULL);
  size = larger(max_abs(M, rows * columns), max_abs(N, rows * n));

  CHECK(orthonormal(Z1, m, d) && orthonormal(Z2, rows, a) && orthonormal(Z3, rows, vhat));
  CHECK(orthonormal(T2, n, n - a));
  transpose_product(Z2, Z3, rows, a, vhat, P);
  CHECK(max_abs(P, a * vhat) <= rounding(1)); /* [Z2 Z3] is one basis of the left null space of M */

  transpose_product(Z2, M, rows, a, columns, P);
  CHECK(max_abs(P, a * columns) <= rounding(size));
  transpose_product(Z3, M, rows, vhat, columns, P);
  CHECK(max_abs(P, vhat * columns) <= rounding(size));
  transpose_product(Z3, N, rows, vhat, n, P);
  CHECK(max_abs(P, vhat * n) <= rounding(size));

  /* The strangeness-free system belongs to these projectors. */
  transpose_product(Z2, N, rows, a, n, P);
  CHECK(max_difference(P, A2, a * n) <= rounding(size));
  transpose_product(Z2, g, rows, a, 1, P);
  CHECK(max_difference(P, f2, a) <= rounding(max_abs(g, rows)));
  transpose_product(Z1, E, m, d, n, P);
  CHECK(max_difference(P, E1, d * n) <= rounding(max_abs(E, m * n)));
  transpose_product(Z1, A, m, d, n, P);
  CHECK(max_difference(P, A1, d * n) <= rounding(max_abs(A, m * n)));
  transpose_product(Z1, f, m, d, 1, P);
  CHECK(max_difference(P, f1, d) <= rounding(max_abs(f, m)));
  transpose_product(Z3, g, rows, vhat, 1, P);
  CHECK(fabs(residual - max_abs(P, vhat)) <= rounding(max_abs(g, rows)));

  /* Hypothesis: rank A2 = a, A2 T2 = 0, rank E T2 = d and Z1 spans its range. */
  CHECK(rank_of(A2, a, n) == a);
  product(A2, T2, a, n, n - a, P);
  CHECK(max_abs(P, a * (n - a)) <= rounding(size));
  product(E, T2, m, n, n - a, P);
  CHECK(rank_of(P, m, n - a) == d || d == 0);
  transpose_product(Z1, P, m, d, n - a, Q); /* (I - Z1 Z1^T) E T2 = 0 */
  {
    double projected[ENTRIES];
    product(Z1, Q, m, d, n - a, projected);
    CHECK(max_difference(projected, P, m * (n - a)) <= rounding(size));
  }
  /* [E1; A2] has full rank: what remains free is u. */
  for (i = 0; i < n; i++) {
    memcpy(P + i * (d + a), E1 + i * d, sizeof(double) * (size_t)d);
    memcpy(P + i * (d + a) + d, A2 + i * a, sizeof(double) * (size_t)a);
  }
  CHECK(rank_of(P, d + a, n) == d + a);
}

static void projectors_have_their_defining_properties(void) {
  size_t k;
  int reduction, i;
  for (k = 0; k < sizeof examples / sizeof examples[0]; k++)
    for (reduction = SFDAE_REDUCTION_STAGED; reduction <= SFDAE_REDUCTION_SVD; reduction++) {
      sfdae_solver* solver = create(&examples[k], reduction);
      const int failures_before = failures;
      check_characteristics(&examples[k], solver);
      for (i = 0; i <= 20; i++) check_point(&examples[k], solver, 0.2 + 0.31 * i);
      sfdae_destroy(&solver);
      if (failures > failures_before) fprintf(stderr, "  ... for %s, reduction %d\n", examples[k].name, reduction);
    }
}

static void each_projector_may_be_asked_for_alone(void) {
  const struct example* example = &examples[1];
  sfdae_solver* solver = create(example, SFDAE_REDUCTION_STAGED);
  double Z1[3], Z2[6], Z3[6], T2[2], alone[6], E1[2], A1[2], f1[1], A2[2], f2[1], residual, residual_alone;
  int vhat;
  check_characteristics(example, solver);
  CHECK_STATUS(sfdae_get_projectors(solver, 0.4, Z1, Z2, Z3, T2, &vhat), SFDAE_OK);
  CHECK_STATUS(sfdae_get_projectors(solver, 0.4, alone, NULL, NULL, NULL, NULL), SFDAE_OK);
  CHECK(memcmp(alone, Z1, sizeof Z1) == 0);
  CHECK_STATUS(sfdae_get_projectors(solver, 0.4, NULL, alone, NULL, NULL, NULL), SFDAE_OK);
  CHECK(memcmp(alone, Z2, sizeof Z2) == 0);
  CHECK_STATUS(sfdae_get_projectors(solver, 0.4, NULL, NULL, alone, NULL, NULL), SFDAE_OK);
  CHECK(memcmp(alone, Z3, sizeof Z3) == 0);
  CHECK_STATUS(sfdae_get_projectors(solver, 0.4, NULL, NULL, NULL, alone, NULL), SFDAE_OK);
  CHECK(memcmp(alone, T2, sizeof T2) == 0);
  CHECK_STATUS(sfdae_get_projectors(solver, 0.4, NULL, NULL, NULL, NULL, NULL), SFDAE_OK);

  CHECK_STATUS(sfdae_get_strangeness_free(solver, 0.4, E1, A1, f1, A2, f2, &residual), SFDAE_OK);
  CHECK_STATUS(sfdae_get_strangeness_free(solver, 0.4, alone, NULL, NULL, NULL, NULL, NULL), SFDAE_OK);
  CHECK(memcmp(alone, E1, sizeof E1) == 0);
  CHECK_STATUS(sfdae_get_strangeness_free(solver, 0.4, NULL, alone, NULL, NULL, NULL, NULL), SFDAE_OK);
  CHECK(memcmp(alone, A1, sizeof A1) == 0);
  CHECK_STATUS(sfdae_get_strangeness_free(solver, 0.4, NULL, NULL, alone, NULL, NULL, NULL), SFDAE_OK);
  CHECK(memcmp(alone, f1, sizeof f1) == 0);
  CHECK_STATUS(sfdae_get_strangeness_free(solver, 0.4, NULL, NULL, NULL, alone, NULL, NULL), SFDAE_OK);
  CHECK(memcmp(alone, A2, sizeof A2) == 0);
  CHECK_STATUS(sfdae_get_strangeness_free(solver, 0.4, NULL, NULL, NULL, NULL, alone, NULL), SFDAE_OK);
  CHECK(memcmp(alone, f2, sizeof f2) == 0);
  CHECK_STATUS(sfdae_get_strangeness_free(solver, 0.4, NULL, NULL, NULL, NULL, NULL, &residual_alone), SFDAE_OK);
  CHECK(residual_alone == residual);
  sfdae_destroy(&solver);
}

/* Looking at other points does not disturb the integration. */
static void looking_inside_leaves_the_integration_alone(void) {
  sfdae_solver* looked_at = create(&examples[1], SFDAE_REDUCTION_STAGED);
  sfdae_solver* left_alone = create(&examples[1], SFDAE_REDUCTION_STAGED);
  double t, x[2] = {0.8, 0.2}, y[2] = {0.8, 0.2}, E1[2], Z2[6];
  int i;
  CHECK_STATUS(sfdae_start(looked_at, 0, 2, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_start(left_alone, 0, 2, y, NULL), SFDAE_OK);
  for (i = 1; i <= 10; i++) {
    CHECK_STATUS(sfdae_get_strangeness_free(looked_at, 5 - i, E1, NULL, NULL, NULL, NULL, NULL), SFDAE_OK);
    CHECK_STATUS(sfdae_get_projectors(looked_at, -i, NULL, Z2, NULL, NULL, NULL), SFDAE_OK);
    CHECK_STATUS(sfdae_advance(looked_at, 0.2 * i, &t, x, NULL), SFDAE_OK);
    CHECK_STATUS(sfdae_advance(left_alone, 0.2 * i, &t, y, NULL), SFDAE_OK);
    CHECK(memcmp(x, y, sizeof x) == 0);
  }
  /* x1 = 0.8 exp(-(t + (1 - cos t) / 2)) */
  CHECK(fabs(x[0] - 0.8 * exp(-(2 + (1 - cos(2)) / 2))) <= 10 * 2e-6);
  CHECK(fabs(x[0] + x[1] - 1) <= rounding(1));
  sfdae_destroy(&looked_at);
  sfdae_destroy(&left_alone);
}

int main(void) {
  array_has_the_blocks_computed_by_hand();
  exact_solution_satisfies_the_array();
  parts_of_the_array_may_be_left_out();
  projectors_have_their_defining_properties();
  each_projector_may_be_asked_for_alone();
  looking_inside_leaves_the_integration_alone();
  return failures != 0;
}
