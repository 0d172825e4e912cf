/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Descriptor systems: linearization at a point, poles, zeros and transfer functions. */
#include <string.h>

#include "sfdae_mex.h"

static void set_matrices(mxArray* result, const sfdae_descriptor* d) {
  int m = 0, n = 0, q = 0, p = 0;
  mxArray *E, *A, *B, *C, *D;
  sfdae_get_descriptor_sizes(d, &m, &n, &q, &p);
  E = matrix_of(NULL, (size_t)m, (size_t)n), A = matrix_of(NULL, (size_t)m, (size_t)n);
  B = matrix_of(NULL, (size_t)m, (size_t)q), C = matrix_of(NULL, (size_t)p, (size_t)n);
  D = matrix_of(NULL, (size_t)p, (size_t)q);
  sfdae_get_descriptor_matrices(d, mxGetPr(E), mxGetPr(A), mxGetPr(B), mxGetPr(C), mxGetPr(D));
  set_field(result, "E", E);
  set_field(result, "A", A);
  set_field(result, "B", B);
  set_field(result, "C", C);
  set_field(result, "D", D);
}

static sfdae_linearization read_choice(const mxArray* at, const problem* p) {
  const size_t m = (size_t)p->num_equations, n = (size_t)p->num_unknowns;
  sfdae_linearization choice;
  sfdae_linearization_init(&choice, sizeof choice);
  choice.t = number_in(at, "t", 0.0);
  choice.x = numbers_in(at, "x", n);
  choice.xdot = numbers_in(at, "xdot", n);
  choice.input_parameters = texts_in(at, "input_parameters", &choice.num_input_parameters);
  choice.num_input_unknowns = (int)length_of(at, "input_unknowns");
  choice.input_unknowns = integers_in(at, "input_unknowns", (size_t)choice.num_input_unknowns, 1);
  choice.num_input_columns = (int)(length_of(at, "input_columns") / m);
  choice.input_columns = numbers_in(at, "input_columns", m * (size_t)choice.num_input_columns);
  choice.num_output_unknowns = (int)length_of(at, "output_unknowns");
  choice.output_unknowns = integers_in(at, "output_unknowns", (size_t)choice.num_output_unknowns, 1);
  choice.num_output_rows = (int)(length_of(at, "output_rows") / n);
  choice.output_rows = numbers_in(at, "output_rows", n * (size_t)choice.num_output_rows);
  return choice;
}

mxArray* linearize_command(const mxArray* from, const mxArray* options, const mxArray* at) {
  problem* p = read_problem(from);
  const sfdae_options* o = read_options(options, p->num_unknowns);
  sfdae_linearization choice;
  mxArray* result = new_struct();
  sfdae_descriptor* d = NULL;
  sfdae_solver* solver;
  int status;
  if (p->num_unknowns == 0 || p->num_equations == 0) refuse("the problem has no equations or no unknowns");
  choice = read_choice(at, p);
  status = open_solver(p, o, &solver);
  /* The jet through x needs an analysis; linear problems need neither. */
  if (status >= 0 && choice.x != NULL && choice.xdot == NULL) {
    status = sfdae_analyze_at(solver, choice.t, choice.t + 1.0, choice.x, NULL);
  }
  if (status >= 0) status = sfdae_linearize(solver, &choice, &d);
  set_status(result, p, solver, status, NULL);
  if (d != NULL) set_matrices(result, d);
  sfdae_destroy_descriptor(&d);
  close_solver(&solver);
  return result;
}

/* ---- Poles, zeros, transfer functions --------------------------------------------------------- */

static sfdae_descriptor_matrices read_matrices(const mxArray* from) {
  sfdae_descriptor_matrices to;
  const mxArray *E = field_of(from, "E"), *B = mxGetField(from, 0, "B"), *C = mxGetField(from, 0, "C");
  size_t m, n;
  sfdae_descriptor_matrices_init(&to, sizeof to);
  if (E == NULL) refuse("E is missing");
  m = mxGetM(E), n = mxGetN(E);
  to.num_equations = (int)m, to.num_unknowns = (int)n;
  to.num_inputs = B == NULL ? 0 : (int)mxGetN(B);
  to.num_outputs = C == NULL ? 0 : (int)mxGetM(C);
  to.E = numbers_in(from, "E", m * n);
  to.A = numbers_in(from, "A", m * n);
  if (to.A == NULL) refuse("A is missing");
  to.B = numbers_in(from, "B", m * (size_t)to.num_inputs);
  to.C = numbers_in(from, "C", n * (size_t)to.num_outputs);
  to.D = numbers_in(from, "D", (size_t)to.num_inputs * (size_t)to.num_outputs);
  to.rank_tol = number_in(from, "rank_tol", 0.0);
  return to;
}

static int find_roots(sfdae_descriptor* d, int is_poles, int n, mxArray* result) {
  double* real = (double*)mxCalloc((size_t)n + 1, sizeof(double));
  double* imaginary = (double*)mxCalloc((size_t)n + 1, sizeof(double));
  double* errors = (double*)mxCalloc((size_t)n + 1, sizeof(double));
  sfdae_spectrum s;
  int status;
  sfdae_spectrum_init(&s, sizeof s);
  status =
      is_poles ? sfdae_get_poles(d, &s, real, imaginary, errors) : sfdae_get_zeros(d, &s, real, imaginary, errors);
  if (status < 0) return status;
  set_field(result, "real", matrix_of(real, (size_t)s.num_finite, 1));
  set_field(result, "imaginary", matrix_of(imaginary, (size_t)s.num_finite, 1));
  set_field(result, "errors", matrix_of(errors, (size_t)s.num_finite, 1));
  set_number(result, "num_infinite", s.num_infinite);
  set_number(result, "strangeness_index", s.strangeness_index);
  return status;
}

static int find_transfer(sfdae_descriptor* d, size_t rows, size_t columns, int count, const double* real,
                         const double* imaginary, mxArray* result) {
  mxArray *re = matrix_of(NULL, rows * columns, (size_t)count), *im = matrix_of(NULL, rows * columns, (size_t)count);
  const int status = sfdae_get_transfer(d, count, real, imaginary, mxGetPr(re), mxGetPr(im));
  set_field(result, "real", re);
  set_field(result, "imaginary", im);
  return status;
}

mxArray* descriptor_command(const mxArray* matrices, const mxArray* request) {
  const sfdae_descriptor_matrices from = read_matrices(matrices);
  const char* what = text_in(request, "what");
  const int count = (int)length_of(request, "real");
  const double* real = numbers_in(request, "real", (size_t)count);
  const double* imaginary = numbers_in(request, "imaginary", (size_t)count);
  mxArray* result = new_struct();
  sfdae_descriptor* d = NULL;
  int status;
  if (count > 0 && imaginary == NULL) refuse("imaginary parts are missing");
  status = sfdae_create_descriptor(&from, &d);
  if (status < 0) set_field(result, "message", mxCreateString(sfdae_message(NULL)));
  if (status >= 0 && strcmp(what, "poles") == 0) status = find_roots(d, 1, from.num_unknowns, result);
  else if (status >= 0 && strcmp(what, "zeros") == 0) status = find_roots(d, 0, from.num_unknowns, result);
  else if (status >= 0) {
    status = find_transfer(d, (size_t)from.num_outputs, (size_t)from.num_inputs, count, real, imaginary, result);
  }
  if (d != NULL) set_field(result, "message", mxCreateString(sfdae_descriptor_message(d)));
  set_number(result, "status", status);
  set_field(result, "status_name", mxCreateString(sfdae_status_name(status)));
  sfdae_destroy_descriptor(&d);
  return result;
}
