/* SPDX-License-Identifier: BSD-3-Clause
 * A two-transistor amplifier as nodal analysis gives it, one equation for each of the nodes 1 ... 8, with the signal
 * 0.1 V sin(200 pi t) at the input and 6 V supply. U: voltages of the nodes; currents into a node add up to zero:
 *
 *     node 1:  (U_in - U1) / R0 + C1 (U2 - U1)' = 0
 *     node 2:  (6 - U2) / R - U2 / R + C1 (U1 - U2)' - 0.01 I(U2 - U3) = 0, and so on
 *
 * A transistor with the voltage U between base and emitter takes 0.01 I(U) from the base and 0.99 I(U) from the
 * collector, I(U) = 1e-6 A (exp(U / 26 mV) - 1). Strangeness index 0, d = 5, a = 3. Reference values: IVP test set. */
#include <math.h>
#include <sfdae/sfdae.h>
#include <stdio.h>

/* Every element adds its current to the nodes that it connects. */
static void conductor(double G, sfdae_expression from, sfdae_expression to, sfdae_expression* into) {
  *into = sfdae_add(*into, sfdae_multiply(sfdae_number(G), sfdae_subtract(from, to)));
}
static void transistor(const sfdae_expression* U, int base, int collector, sfdae_expression* F) {
  sfdae_expression u = sfdae_divide(sfdae_subtract(U[base], U[base + 1]), sfdae_number(0.026));
  sfdae_expression I = sfdae_multiply(sfdae_number(1e-6), sfdae_subtract(sfdae_exp(u), sfdae_number(1)));
  F[base] = sfdae_subtract(F[base], sfdae_multiply(sfdae_number(0.01), I));
  F[base + 1] = sfdae_add(F[base + 1], I);
  F[collector] = sfdae_subtract(F[collector], sfdae_multiply(sfdae_number(0.99), I));
}

static int equations(sfdae_record* record, sfdae_expression t, const sfdae_expression* U,
                     const sfdae_expression* Udot, sfdae_expression* F, void* user) {
  static const int from[5] = {0, 3, 6, 2, 5}, to[5] = {1, 4, 7, -1, -1};
  static const double C[5] = {1e-6, 3e-6, 5e-6, 2e-6, 4e-6}, R = 9000;
  const sfdae_expression ground = sfdae_number(0), supply = sfdae_parameter(record, "supply", 6);
  const sfdae_expression wt = sfdae_multiply(sfdae_number(200 * acos(-1.0)), t);
  int k;
  (void)user;
  for (k = 0; k < 8; k++) F[k] = ground;
  conductor(1 / 1000.0, sfdae_multiply(sfdae_number(0.1), sfdae_sin(wt)), U[0], &F[0]);
  for (k = 1; k < 7; k++)
    if (k != 2 && k != 5) conductor(1 / R, supply, U[k], &F[k]);
  for (k = 1; k < 8; k++)
    if (k != 3 && k != 6) conductor(1 / R, ground, U[k], &F[k]);
  transistor(U, 1, 3, F), transistor(U, 4, 6, F);
  for (k = 0; k < 5; k++) {
    conductor(C[k], to[k] < 0 ? ground : Udot[to[k]], Udot[from[k]], &F[from[k]]);
    if (to[k] >= 0) conductor(C[k], Udot[from[k]], Udot[to[k]], &F[to[k]]);
  }
  return 0;
}

int main(void) {
  double t = 0, U[8] = {0, 3, 3, 6, 3, 3, 6, 0}, error = HUGE_VAL;
  sfdae_nonlinear_problem problem;
  sfdae_solver* solver = NULL;
  int status = sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 8;
  problem.equations = equations;
  status = sfdae_create_nonlinear(&solver, &problem, NULL);
  if (status >= 0) status = sfdae_start(solver, 0, 0.2, U, NULL);
  if (status >= 0) status = sfdae_advance(solver, 0.2, &t, U, NULL);
  if (status >= 0) error = fmax(fabs(U[6] - 4.770927631616772), fabs(U[7] - 1.236995868091548));
  printf("U7 = %.6f, U8 = %.6f, error %.1e %s\n", U[6], U[7], error, sfdae_message(solver));
  sfdae_destroy(&solver);
  return !(error < 1e-4);
}
