/* SPDX-License-Identifier: BSD-3-Clause
 *
 * A chain of ten masses between two walls, linked by springs and dampers, whose positions q are driven through
 * two constraints that turn with time (index 3, strangeness index 2):
 *
 *     q'   = v                                          M = diag(1 + sin(i) / 2)
 *     M v' = -K q - D v + G(t)^T lambda + f1(t)         springs 10 + 5 cos i, dampers 0.5 + 0.2 sin i, i = 1 ... 11
 *     0    = G(t) q + f3(t)                             G_j,2j-1 = cos th_j, G_j,2j = sin th_j, th_j = 0.3 j + t / 2
 *
 * f1 and f3 are chosen for the exact solution q_i = sin(nu_i t + 0.7 i), nu_i = 1 + sin(i) / 2, v = q',
 * lambda_j = cos(t + j). x = (q, v, lambda) has 22 components; d = 16, a = 6: positions, velocities and multipliers
 * all obey constraints, most of them hidden. At the start positions and velocities are known, the multipliers are not:
 * the solver finds them and leaves the others as they are.
 *
 * Prints the diagnostics report, a table and statistics; writes constrained_chain.csv, which constrained_chain.gp
 * draws.
 */
#include <float.h>
#include <math.h>
#include <stdio.h>

#include <sfdae/sfdae.h>

enum { MASSES = 10, LINKS = 2, N = 2 * MASSES + LINKS, Q = 0, V = MASSES, LAMBDA = 2 * MASSES, A_COUNT = 3 * LINKS };
static const double t_end = 10, tolerance = 1e-6;

/* ---- The problem. i and j count from 1 as above, order is that of the derivative. ------------------------- */

static double mass(int i) { return 1 + 0.5 * sin(i); }
static double spring(int i) { return 10 + 5 * cos(i); }
static double damper(int i) { return 0.5 + 0.2 * sin(i); }

/* Derivative of cos(w t + p). */
static double cosine(double w, double p, double t, int order) {
  const double quarter_turn = acos(0.0);
  return pow(w, order) * cos(w * t + p + order * quarter_turn);
}

static double position(int i, double t, int order) { return cosine(1 + 0.5 * sin(i), 0.7 * i - acos(0.0), t, order); }
static double multiplier(int j, double t, int order) { return cosine(1, j, t, order); }

/* G_ji: row j holds masses 2j - 1 and 2j. */
static double G(int j, int i, double t, int order) {
  if (i == 2 * j - 1) return cosine(0.5, 0.3 * j, t, order);
  if (i == 2 * j) return cosine(0.5, 0.3 * j - acos(0.0), t, order);
  return 0;
}

/* K or D in row i, column k: springs in series. */
static double series(double (*link)(int), int i, int k) {
  return i == k ? link(i) + link(i + 1) : i + 1 == k ? -link(k) : k + 1 == i ? -link(i) : 0;
}

static double binomial(int n, int k) { return k == 0 ? 1 : binomial(n, k - 1) * (n - k + 1) / k; }

static int E(double t, int order, double* matrix, void* user) {
  int i;
  (void)t, (void)order, (void)user; /* constant: only order 0 is asked for */
  for (i = 1; i <= MASSES; i++) matrix[(Q + i - 1) * (N + 1)] = 1, matrix[(V + i - 1) * (N + 1)] = mass(i);
  return 0;
}

static int A(double t, int order, double* matrix, void* user) {
  int i, j, k;
  (void)user;
  for (i = 1; i <= MASSES; i++)
    for (j = 1; j <= LINKS; j++)
      matrix[(V + i - 1) + N * (LAMBDA + j - 1)] = matrix[(LAMBDA + j - 1) + N * (Q + i - 1)] = G(j, i, t, order);
  if (order > 0) return 0; /* the rest is constant */
  for (i = 1; i <= MASSES; i++)
    for (k = 1; k <= MASSES; k++) {
      matrix[(Q + i - 1) + N * (V + k - 1)] = i == k;
      matrix[(V + i - 1) + N * (Q + k - 1)] = -series(spring, i, k);
      matrix[(V + i - 1) + N * (V + k - 1)] = -series(damper, i, k);
    }
  return 0;
}

/* f1 = M q'' + K q + D q' - G^T lambda,  f3 = -G q;  products are differentiated by Leibniz' rule. */
static int f(double t, int order, double* vector, void* user) {
  int i, j, k, l;
  (void)user;
  for (i = 1; i <= MASSES; i++) {
    double* f1 = &vector[V + i - 1];
    *f1 = mass(i) * position(i, t, order + 2);
    for (k = 1; k <= MASSES; k++)
      *f1 += series(spring, i, k) * position(k, t, order) + series(damper, i, k) * position(k, t, order + 1);
    for (j = 1; j <= LINKS; j++)
      for (l = 0; l <= order; l++) {
        const double G_l = binomial(order, l) * G(j, i, t, l);
        *f1 -= G_l * multiplier(j, t, order - l);
        vector[LAMBDA + j - 1] -= G_l * position(i, t, order - l);
      }
  }
  return 0;
}

static void exact(double t, double* x) {
  int i;
  for (i = 1; i <= MASSES; i++) x[Q + i - 1] = position(i, t, 0), x[V + i - 1] = position(i, t, 1);
  for (i = 1; i <= LINKS; i++) x[LAMBDA + i - 1] = multiplier(i, t, 0);
}

/* ---- What is checked ------------------------------------------------------------------------------------------ */

/* Largest error in units of rtol |x| + atol. */
static double error_of(double t, const double* x) {
  double xe[N], error = 0;
  int i;
  exact(t, xe);
  for (i = 0; i < N; i++) error = fmax(error, fabs(x[i] - xe[i]) / (tolerance * (fabs(xe[i]) + 1)));
  return error;
}

/* Largest |A x + f| of rows first ... end - 1 of a matrix with `end` rows, in units of the rounding errors of it. */
static double largest_residual(const double* matrix, const double* vector, int first, int end, const double* x) {
  double largest = 0;
  int i, j;
  for (i = first; i < end; i++) {
    double sum = vector[i], size = fabs(vector[i]);
    for (j = 0; j < N; j++) sum += matrix[i + end * j] * x[j], size += fabs(matrix[i + end * j] * x[j]);
    largest = fmax(largest, fabs(sum) / (DBL_EPSILON * N * size));
  }
  return largest;
}

/* All constraints, the hidden ones included: A2 x + f2. */
static double residual_of(sfdae_solver* solver, double t, const double* x) {
  double A2[A_COUNT * N], f2[A_COUNT];
  const int status = sfdae_get_strangeness_free(solver, t, NULL, NULL, NULL, A2, f2, NULL);
  return status < 0 ? HUGE_VAL : largest_residual(A2, f2, 0, A_COUNT, x);
}

/* The constraints as they were given: G q + f3, the last rows of A x + f. */
static double raw_residual_of(double t, const double* x) {
  double matrix[N * N] = {0}, vector[N] = {0};
  A(t, 0, matrix, NULL);
  f(t, 0, vector, NULL);
  return largest_residual(matrix, vector, LAMBDA, N, x);
}

/* What is known at t. Zero takes the place of the multipliers. */
static void known_values(double t, double* x) {
  int i;
  exact(t, x);
  for (i = 0; i < LINKS; i++) x[LAMBDA + i] = 0;
}

/* Integrates, fills the table and the file; worst: largest error and residuals met. */
static int integrate(sfdae_solver* solver, double* x, FILE* csv, double worst[3]) {
  int k;
  puts("      t         q1         q5    lambda1   error/tol   A2 x + f2    G q + f3   (in roundings)");
  if (csv) fputs("t,q1,q2,q5,q10,lambda1,lambda2,error/tol\n", csv);
  for (k = 0; k <= 500; k++) {
    double t;
    const int status = sfdae_advance(solver, t_end * k / 500, &t, x, NULL);
    const double e = error_of(t, x), r = residual_of(solver, t, x), s = raw_residual_of(t, x);
    if (status < 0) return status;
    worst[0] = fmax(worst[0], e), worst[1] = fmax(worst[1], r), worst[2] = fmax(worst[2], s);
    if (csv)
      fprintf(csv, "%g,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.3g\n", t, x[0], x[1], x[4], x[9], x[LAMBDA], x[LAMBDA + 1], e);
    if (k % 50 == 0) printf("%7.3f %10.6f %10.6f %10.6f %11.2g %11.2g %11.2g\n", t, x[0], x[4], x[LAMBDA], e, r, s);
  }
  return SFDAE_OK;
}

int main(void) {
  sfdae_linear_problem problem;
  sfdae_options options;
  sfdae_statistics statistics;
  sfdae_solver* solver = NULL;
  FILE* csv = fopen("constrained_chain.csv", "w");
  double x[N], worst[3] = {0, 0, 0};
  char report[20000];
  int status;

  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = N;
  problem.E = E, problem.A = A, problem.f = f, problem.constant_E = 1;
  sfdae_options_init(&options, sizeof options);
  options.rtol = options.atol = tolerance;
  sfdae_statistics_init(&statistics, sizeof statistics);

  status = sfdae_create_linear(&solver, &problem, &options);
  known_values(0, x);
  if (status >= 0) status = sfdae_start(solver, 0, t_end, x, NULL);
  if (status >= 0) status = integrate(solver, x, csv, worst);
  if (status < 0) printf("%s: %s\n", sfdae_status_name(status), sfdae_message(solver));
  if (sfdae_report(solver, report, sizeof report, NULL) >= 0) fputs(report, stdout);
  if (sfdae_get_statistics(solver, &statistics) >= 0)
    printf("%ld steps, %ld rejected by the error test, %ld strangeness-free systems\n", statistics.steps,
           statistics.error_failures, statistics.reductions);
  printf("error %.2g times the tolerance, constraints met to %.2g roundings, those given to %.2g\n", worst[0],
         worst[1], worst[2]);
  if (csv && fclose(csv) == 0) puts("wrote constrained_chain.csv, which examples/constrained_chain.gp draws");
  sfdae_destroy(&solver);
  return !(status >= 0 && worst[0] <= 10 && worst[1] <= 100 && worst[2] <= 100);
}
