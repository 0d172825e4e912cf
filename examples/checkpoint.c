/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Half of the way, a text file, and another solver for the other half: the result agrees in every bit.
 *
 *     x1' = -x1 + x3,   x2' = x3,   0 = x2 - sin t         strangeness index 1, d = 1, a = 2
 *
 * Check: from x1(0) = 1, x = (cos t + sin t + e^-t, 2 sin t, 2 cos t) / 2. By Radau IIA: change one line for BDF. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sfdae/sfdae.h>

static int E(double t, int order, double* matrix, void* user) {
  (void)t, (void)order, (void)user; /* constant: only order 0 is asked for */
  matrix[0] = matrix[4] = 1;
  return 0;
}

static int A(double t, int order, double* matrix, void* user) {
  (void)t, (void)order, (void)user;
  matrix[0] = -1, matrix[0 + 3 * 2] = matrix[1 + 3 * 2] = matrix[2 + 3 * 1] = 1;
  return 0;
}

static int f(double t, int order, double* vector, void* user) {
  (void)user;
  vector[2] = -sin(t + order * acos(0.0));
  return 0;
}

int main(void) {
  double t, x[3] = {1, 0, 1}, y[3], *state = NULL, error;
  size_t length = 0, i;
  sfdae_linear_problem problem;
  sfdae_options options;
  sfdae_solver *first = NULL, *second = NULL;
  FILE* file = tmpfile();
  int status;

  sfdae_linear_problem_init(&problem, sizeof problem);
  sfdae_options_init(&options, sizeof options);
  problem.num_equations = problem.num_unknowns = 3;
  problem.E = E, problem.A = A, problem.f = f, problem.constant_E = problem.constant_A = 1;
  options.method = SFDAE_METHOD_RADAU;
  status = sfdae_create_linear(&first, &problem, &options);
  if (status >= 0) status = sfdae_start(first, 0, 10, x, NULL);
  if (status >= 0) status = sfdae_advance(first, 5, &t, x, NULL);

  if (status >= 0) status = sfdae_get_checkpoint_length(first, &length);
  state = malloc((length + 1) * sizeof *state);
  if (state == NULL || file == NULL) return 1;
  if (status >= 0) status = sfdae_save_checkpoint(first, state, length);
  for (i = 0; i < length; i++) fprintf(file, "%.17g\n", state[i]);
  rewind(file);
  for (i = 0; i < length; i++) status = fscanf(file, "%lf", &state[i]) == 1 ? status : -1;

  if (status >= 0) status = sfdae_create_linear(&second, &problem, &options);
  if (status >= 0) status = sfdae_restore_checkpoint(second, state, length); /* instead of sfdae_start */
  if (status >= 0) status = sfdae_advance(second, 10, &t, y, NULL);
  if (status >= 0) status = sfdae_advance(first, 10, &t, x, NULL);
  error = fabs(y[0] - (cos(10) + sin(10) + exp(-10)) / 2) / (options.rtol * fabs(y[0]) + options.atol);
  printf("%s %s\n%d numbers, error %.2g times the tolerance\n", sfdae_status_name(status), sfdae_message(second),
         (int)length, error);
  sfdae_destroy(&first), sfdae_destroy(&second);
  fclose(file), free(state);
  return !(status == SFDAE_OK && error <= 10 && memcmp(x, y, sizeof x) == 0);
}
