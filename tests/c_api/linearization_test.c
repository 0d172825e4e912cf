/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Linearization in C: what is written, what is refused, and what stays untouched then. x1' = -2 x1 + x2 + u, 0 = x2 -
 * k x1: one pole at k - 2, x1 / u = 1 / (s + 2 - k).
 */
#include <math.h>
#include <stddef.h>
#include <string.h>

#include <sfdae/sfdae.h>

#include "checks.h"

static int equations(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                     const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  const sfdae_expression u = sfdae_parameter(record, "u", 0), k = sfdae_parameter(record, "k", 0.5);
  (void)t, (void)user;
  F[0] = sfdae_subtract(sfdae_add(xdot[0], sfdae_multiply(sfdae_number(2), x[0])), sfdae_add(x[1], u));
  F[1] = sfdae_subtract(x[1], sfdae_multiply(k, x[0]));
  return 0;
}

static sfdae_solver* create(void) {
  sfdae_solver* solver = NULL;
  sfdae_nonlinear_problem problem;
  CHECK_STATUS(sfdae_nonlinear_problem_init(&problem, sizeof problem), SFDAE_OK);
  problem.num_equations = problem.num_unknowns = 2;
  problem.equations = equations;
  CHECK_STATUS(sfdae_create_nonlinear(&solver, &problem, NULL), SFDAE_OK);
  return solver;
}

static const char* const names[] = {"u", "k"};
static const int first_unknown[] = {0};

static void choose(sfdae_linearization* choice) {
  CHECK_STATUS(sfdae_linearization_init(choice, sizeof *choice), SFDAE_OK);
  choice->num_input_parameters = 1;
  choice->input_parameters = names;
  choice->num_output_unknowns = 1;
  choice->output_unknowns = first_unknown;
}

static void linear_formulas_need_no_start(void) {
  sfdae_solver* solver = create();
  sfdae_descriptor* descriptor = NULL;
  sfdae_linearization choice;
  sfdae_spectrum spectrum;
  int m = 0, n = 0, q = 0, p = 0;
  double real[2] = {9, 9}, imaginary[2] = {9, 9}, errors[2] = {9, 9}, H_real[2], H_imaginary[2];
  const double s_real[] = {0.0, 1.0}, s_imaginary[] = {1.5, 0.0};
  double E[4], A[4], B[2], C[2], D[1];
  choose(&choice);
  CHECK_STATUS(sfdae_linearize(solver, &choice, &descriptor), SFDAE_OK);
  CHECK_STATUS(sfdae_destroy(&solver), SFDAE_OK); /* which the descriptor system does not need */
  CHECK_STATUS(sfdae_get_descriptor_sizes(descriptor, &m, &n, &q, &p), SFDAE_OK);
  CHECK(m == 2 && n == 2 && q == 1 && p == 1);
  CHECK_STATUS(sfdae_get_descriptor_matrices(descriptor, E, A, B, C, D), SFDAE_OK);
  CHECK(E[0] == 1 && E[1] == 0 && E[2] == 0 && E[3] == 0);
  CHECK(A[0] == -2 && A[1] == 0.5 && A[2] == 1 && A[3] == -1);
  CHECK(B[0] == 1 && B[1] == 0 && C[0] == 1 && C[1] == 0 && D[0] == 0);
  CHECK_STATUS(sfdae_spectrum_init(&spectrum, sizeof spectrum), SFDAE_OK);
  CHECK_STATUS(sfdae_get_poles(descriptor, &spectrum, real, imaginary, errors), SFDAE_OK);
  CHECK(spectrum.num_finite == 1 && spectrum.num_infinite == 1 && spectrum.strangeness_index == 0);
  CHECK(spectrum.differential == 1 && spectrum.algebraic == 1 && spectrum.undetermined == 0 &&
        spectrum.redundant == 0);
  CHECK(fabs(real[0] + 1.5) < 1e-15 && imaginary[0] == 0 && errors[0] < 1e-14);
  CHECK(real[1] == 9 && imaginary[1] == 9 && errors[1] == 9);
  CHECK_STATUS(sfdae_get_zeros(descriptor, &spectrum, real, imaginary, NULL), SFDAE_OK);
  CHECK(spectrum.num_finite == 0 && spectrum.num_infinite == 3);
  CHECK_STATUS(sfdae_get_transfer(descriptor, 2, s_real, s_imaginary, H_real, H_imaginary), SFDAE_OK);
  CHECK(fabs(H_real[0] - 1 / 3.0) < 1e-15 && fabs(H_imaginary[0] + 1 / 3.0) < 1e-15);
  CHECK(fabs(H_real[1] - 0.4) < 1e-15 && H_imaginary[1] == 0);
  CHECK(strcmp(sfdae_descriptor_message(descriptor), "") == 0);
  CHECK_STATUS(sfdae_destroy_descriptor(&descriptor), SFDAE_OK);
  CHECK(descriptor == NULL);
  CHECK_STATUS(sfdae_destroy_descriptor(&descriptor), SFDAE_OK);
}

/* B by k is x1, so that the solution is needed; and values are those at the time of the call. */
static void inputs_that_multiply_unknowns_need_the_solution(void) {
  sfdae_solver* solver = create();
  sfdae_descriptor* descriptor = NULL;
  sfdae_linearization choice;
  double B[4], A[4], x[2] = {3, 0};
  choose(&choice);
  choice.num_input_parameters = 2;
  CHECK_STATUS(sfdae_linearize(solver, &choice, &descriptor), SFDAE_NOT_STARTED);
  CHECK(descriptor == NULL && strlen(sfdae_message(solver)) > 0);
  CHECK_STATUS(sfdae_set_parameter(solver, "k", 0.25), SFDAE_OK);
  CHECK_STATUS(sfdae_start(solver, 0.0, 1.0, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_linearize(solver, &choice, &descriptor), SFDAE_OK);
  CHECK_STATUS(sfdae_get_descriptor_matrices(descriptor, NULL, A, B, NULL, NULL), SFDAE_OK);
  CHECK(A[1] == 0.25 && B[2] == 0 && fabs(B[3] - 3) < 1e-12);
  CHECK_STATUS(sfdae_destroy_descriptor(&descriptor), SFDAE_OK);
  CHECK_STATUS(sfdae_destroy(&solver), SFDAE_OK);
}

static void what_is_wrong_is_refused(void) {
  sfdae_solver* solver = create();
  sfdae_descriptor *descriptor = NULL, *none = (sfdae_descriptor*)(void*)&solver;
  sfdae_linearization choice;
  sfdae_descriptor_matrices matrices;
  sfdae_spectrum spectrum;
  const double one = 1, zero = 0, minus = -1;
  double real = 7, imaginary = 7, H_real = 7, H_imaginary = 7;
  choose(&choice);
  CHECK_STATUS(sfdae_linearize(NULL, &choice, &none), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(none == NULL);
  CHECK_STATUS(sfdae_linearize(solver, NULL, &descriptor), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_linearize(solver, &choice, NULL), SFDAE_ILLEGAL_ARGUMENT);
  choice.size = 0;
  CHECK_STATUS(sfdae_linearize(solver, &choice, &descriptor), SFDAE_ILLEGAL_ARGUMENT);
  choose(&choice);
  choice.num_input_parameters = -1;
  CHECK_STATUS(sfdae_linearize(solver, &choice, &descriptor), SFDAE_ILLEGAL_ARGUMENT);
  choose(&choice);
  choice.output_unknowns = NULL;
  CHECK_STATUS(sfdae_linearize(solver, &choice, &descriptor), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_linearization_init(NULL, sizeof choice), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_descriptor_matrices_init(NULL, sizeof matrices), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_spectrum_init(NULL, sizeof spectrum), SFDAE_ILLEGAL_ARGUMENT);

  CHECK_STATUS(sfdae_descriptor_matrices_init(&matrices, sizeof matrices), SFDAE_OK);
  CHECK_STATUS(sfdae_create_descriptor(&matrices, &descriptor), SFDAE_ILLEGAL_ARGUMENT);
  matrices.num_equations = matrices.num_unknowns = matrices.num_inputs = matrices.num_outputs = 1;
  matrices.E = matrices.B = matrices.C = &one;
  CHECK_STATUS(sfdae_create_descriptor(&matrices, &descriptor), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(descriptor == NULL);
  matrices.A = &minus;
  CHECK_STATUS(sfdae_create_descriptor(&matrices, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_create_descriptor(&matrices, &descriptor), SFDAE_OK);
  CHECK_STATUS(sfdae_get_poles(descriptor, NULL, &real, &imaginary, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_spectrum_init(&spectrum, sizeof spectrum), SFDAE_OK);
  CHECK_STATUS(sfdae_get_poles(descriptor, &spectrum, NULL, &imaginary, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_poles(NULL, &spectrum, &real, &imaginary, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_transfer(descriptor, -1, &one, &zero, &H_real, &H_imaginary), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_transfer(descriptor, 1, &one, NULL, &H_real, &H_imaginary), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_transfer(descriptor, 1, &minus, &zero, &H_real, &H_imaginary), SFDAE_SINGULAR);
  CHECK(strlen(sfdae_descriptor_message(descriptor)) > 0);
  CHECK(real == 7 && imaginary == 7 && H_real == 7 && H_imaginary == 7);
  CHECK_STATUS(sfdae_get_descriptor_sizes(NULL, NULL, NULL, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_get_descriptor_matrices(NULL, NULL, NULL, NULL, NULL, NULL), SFDAE_ILLEGAL_ARGUMENT);
  CHECK(strlen(sfdae_descriptor_message(NULL)) > 0);
  CHECK_STATUS(sfdae_destroy_descriptor(&descriptor), SFDAE_OK);
  CHECK_STATUS(sfdae_destroy(&solver), SFDAE_OK);
}

/* E = 0, A = 0: 0 = 0 determines nothing. A pencil that is not square has no poles either. */
static void singular_pencils_are_named(void) {
  const double zeros[2] = {0, 0}, ones[2] = {1, 1};
  double real[2] = {7, 7}, imaginary[2] = {7, 7};
  int n;
  for (n = 1; n <= 2; n++) {
    sfdae_descriptor* descriptor = NULL;
    sfdae_descriptor_matrices matrices;
    sfdae_spectrum spectrum;
    CHECK_STATUS(sfdae_descriptor_matrices_init(&matrices, sizeof matrices), SFDAE_OK);
    matrices.num_equations = 1;
    matrices.num_unknowns = n;
    matrices.E = zeros;
    matrices.A = n == 1 ? zeros : ones;
    CHECK_STATUS(sfdae_create_descriptor(&matrices, &descriptor), SFDAE_OK);
    CHECK_STATUS(sfdae_spectrum_init(&spectrum, sizeof spectrum), SFDAE_OK);
    CHECK_STATUS(sfdae_get_poles(descriptor, &spectrum, real, imaginary, NULL), SFDAE_SINGULAR);
    CHECK(strstr(sfdae_descriptor_message(descriptor), "u = 1") != NULL);
    CHECK(real[0] == 7 && spectrum.num_finite == 0);
    CHECK_STATUS(sfdae_destroy_descriptor(&descriptor), SFDAE_OK);
  }
}

int main(void) {
  linear_formulas_need_no_start();
  inputs_that_multiply_unknowns_need_the_solution();
  what_is_wrong_is_refused();
  singular_pencils_are_named();
  return failures != 0;
}
