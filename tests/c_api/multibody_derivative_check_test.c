/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Derivatives that callbacks of a mechanical system supply are compared with differences. A bead on a rod that turns,
 * and a condition on velocities:
 *
 *     0 = q1 sin t - q2 cos t,   0 = q1 v1 + q2 v2 - t
 *     gamma = 2 (v1 cos t + v2 sin t) - q1 sin t + q2 cos t,   eta = v1^2 + v2^2 - 1
 */
#include <math.h>
#include <string.h>

#include "checks.h"

static double wrong[4]; /* added to g_q, g_t, gamma, eta */
static int status_of_g;

static int forces(double t, const double* q, const double* v, double* f, void* user) {
  (void)t, (void)q, (void)v, (void)f, (void)user;
  return 0;
}
static int g(double t, const double* q, double* result, void* user) {
  (void)user;
  result[0] = q[0] * sin(t) - q[1] * cos(t);
  return status_of_g;
}
static int g_q(double t, const double* q, double* result, void* user) {
  (void)q, (void)user;
  result[0] = sin(t);
  result[1] = wrong[0] - cos(t);
  return 0;
}
static int g_t(double t, const double* q, double* result, void* user) {
  (void)user;
  result[0] = q[0] * cos(t) + q[1] * sin(t) + wrong[1];
  return 0;
}
static int gamma_of(double t, const double* q, const double* v, double* result, void* user) {
  (void)user;
  result[0] = 2 * (v[0] * cos(t) + v[1] * sin(t)) - q[0] * sin(t) + q[1] * cos(t) + wrong[2];
  return 0;
}
static int H(double t, const double* q, double* result, void* user) {
  (void)t, (void)user;
  result[0] = q[0];
  result[1] = q[1];
  return 0;
}
static int h(double t, const double* q, double* result, void* user) {
  (void)q, (void)user;
  result[0] = -t;
  return 0;
}
static int eta(double t, const double* q, const double* v, double* result, void* user) {
  (void)t, (void)q, (void)user;
  result[0] = v[0] * v[0] + v[1] * v[1] - 1 + wrong[3];
  return 0;
}

static sfdae_multibody_problem bead(void) {
  sfdae_multibody_problem problem;
  sfdae_multibody_problem_init(&problem, sizeof problem);
  problem.num_positions = 2;
  problem.num_constraints = 1;
  problem.num_nonholonomic = 1;
  problem.forces = forces;
  problem.constraints = g;
  problem.constraint_jacobian = g_q;
  problem.constraint_rate = g_t;
  problem.nonholonomic_matrix = H;
  problem.nonholonomic_offset = h;
  problem.constraint_curvature = gamma_of;
  problem.nonholonomic_curvature = eta;
  return problem;
}

static const double q[2] = {0.6, 0.7}, v[2] = {1.5, -2};

static sfdae_solver* created(const sfdae_multibody_problem* problem) {
  sfdae_solver* solver = NULL;
  CHECK_STATUS(sfdae_create_multibody(&solver, problem, NULL), SFDAE_OK);
  return solver;
}

static void mistakes_are_found(void) {
  static const char names[] = "GTCH";
  static const char* const words[] = {"g_q", "g_t", "gamma", "eta"};
  const sfdae_multibody_problem problem = bead();
  sfdae_solver* solver = created(&problem);
  sfdae_derivative_check result;
  int i;
  sfdae_derivative_check_init(&result, sizeof result);
  CHECK_STATUS(sfdae_check_multibody_derivatives(solver, 0.3, q, v, &result), SFDAE_OK);
  CHECK(!result.suspicious);
  CHECK(strcmp(sfdae_message(solver), "") == 0);
  for (i = 0; i < 4; i++) {
    wrong[i] = 1e-4;
    CHECK_STATUS(sfdae_check_multibody_derivatives(solver, 0.3, q, v, &result), SFDAE_OK);
    CHECK(result.suspicious == 1);
    CHECK(result.function == names[i]);
    CHECK(result.row == 0 && result.column == (i == 0));
    CHECK(fabs(result.supplied - result.difference - 1e-4) < 1e-9);
    CHECK(strstr(sfdae_message(solver), words[i]) != NULL);
    wrong[i] = 0;
  }
  sfdae_destroy(&solver);
}

static int recorded(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                    const sfdae_multibody_formulas* formulas, void* user) {
  (void)record, (void)t, (void)x, (void)xdot, (void)formulas, (void)user;
  return 0;
}

static void wrong_arguments_are_refused(void) {
  const double bad[2] = {0, NAN};
  sfdae_multibody_problem problem = bead();
  sfdae_solver* solver = created(&problem);
  sfdae_derivative_check result, before;
  sfdae_derivative_check_init(&result, sizeof result);
  before = result;
  CHECK_STATUS(sfdae_check_multibody_derivatives(NULL, 0, q, v, &result), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_check_multibody_derivatives(solver, INFINITY, q, v, &result), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_check_multibody_derivatives(solver, 0, NULL, v, &result), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_check_multibody_derivatives(solver, 0, q, NULL, &result), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_check_multibody_derivatives(solver, 0, bad, v, &result), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_check_multibody_derivatives(solver, 0, q, bad, &result), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_check_multibody_derivatives(solver, 0, q, v, NULL), SFDAE_ILLEGAL_ARGUMENT);
  status_of_g = -1;
  CHECK_STATUS(sfdae_check_multibody_derivatives(solver, 0, q, v, &result), SFDAE_CALLBACK_STOPPED);
  CHECK(strstr(sfdae_message(solver), "constraints returned -1") != NULL);
  status_of_g = 0;
  CHECK_STATUS(sfdae_check_derivatives(solver, 0, 1, &result), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(memcmp(&result, &before, sizeof result) == 0);
  sfdae_destroy(&solver);

  problem.equations = recorded;
  solver = created(&problem);
  CHECK_STATUS(sfdae_check_multibody_derivatives(solver, 0, q, v, &result), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(memcmp(&result, &before, sizeof result) == 0);
  sfdae_destroy(&solver);
}

int main(void) {
  mistakes_are_found();
  wrong_arguments_are_refused();
  return failures != 0;
}
