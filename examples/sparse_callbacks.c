/* SPDX-License-Identifier: BSD-3-Clause
 *
 * 10,000 unknowns from a callback: heat on a line of N points, and a quantity w that follows from u, h = 1 / (N + 1):
 *
 *     u_i' = (u_i-1 - 2 u_i + u_i+1) / h^2 + w_i - u_i^3,   0 = w_i - u_i^3,   u_0 = u_N+1 = 0
 *
 * The callback writes F alone. It says which entries F_x and F_x' have; they are differences of F then, of groups of
 * unknowns that no equation shares: a Jacobian takes some 12 evaluations of F. Strangeness index 0, d = a = N. Check:
 * u_i = exp(-4 t sin^2(pi h / 2) / h^2) sin(pi i h).
 */
#include <math.h>
#include <sfdae/sfdae.h>
#include <stdio.h>

enum { N = 5000 };
static int x_start[2 * N + 1], x_rows[6 * N], xdot_start[2 * N + 1], xdot_rows[N];
static double x[2 * N], xdot[2 * N];

static int F(double t, int order, const double* derivatives, double* f, double* f_x, double* f_xdot, void* user) {
  const double *u = derivatives, *w = u + N, *slope = u + 2 * N, rate = (N + 1.0) * (N + 1.0);
  (void)t, (void)f_x, (void)f_xdot, (void)user;
  if (order > 0) return SFDAE_ORDER_NOT_AVAILABLE;
  for (int i = 0; i < N; i++) {
    f[N + i] = w[i] - u[i] * u[i] * u[i];
    f[i] = slope[i] - rate * ((i > 0 ? u[i - 1] : 0) - 2 * u[i] + (i < N - 1 ? u[i + 1] : 0)) - f[N + i];
  }
  return 0;
}

int main(void) {
  const double pi = 2 * acos(0.0), h = 1.0 / (N + 1), decay = 4 * pow(sin(pi * h / 2) / h, 2), tend = 0.1;
  sfdae_nonlinear_problem problem;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  for (int j = 0; j < 2 * N; j++) { /* rows of column j */
    const int i = j % N;
    if (j < N && i > 0) x_rows[problem.F_x_entries++] = i - 1;
    x_rows[problem.F_x_entries++] = i;
    if (j < N && i < N - 1) x_rows[problem.F_x_entries++] = i + 1;
    x_rows[problem.F_x_entries++] = N + i;
    if (j < N) xdot_rows[problem.F_xdot_entries++] = i;
    x_start[j + 1] = problem.F_x_entries;
    xdot_start[j + 1] = problem.F_xdot_entries;
    x[j] = j < N ? sin(pi * (i + 1) * h) : pow(x[i], 3);
  }
  problem.num_equations = problem.num_unknowns = 2 * N;
  problem.total_derivative = F;
  problem.F_x_col_start = x_start, problem.F_x_row_index = x_rows;
  problem.F_xdot_col_start = xdot_start, problem.F_xdot_row_index = xdot_rows;
  problem.matrices = SFDAE_MATRICES_DIFFERENCES;

  sfdae_solver* solver = NULL;
  double t = 0, error = 0;
  int status = sfdae_create_nonlinear(&solver, &problem, NULL);
  if (status >= 0) status = sfdae_start(solver, t, tend, x, xdot);
  if (status >= 0) status = sfdae_advance(solver, tend, &t, x, xdot);
  for (int i = 0; i < N; i++) error = fmax(error, fabs(x[i] - exp(-decay * t) * sin(pi * (i + 1) * h)));
  printf("%s at t = %g, largest error %.1e %s\n", sfdae_status_name(status), t, error, sfdae_message(solver));
  sfdae_destroy(&solver);
  return !(status >= 0 && error < 1e-5);
}
