/* SPDX-License-Identifier: BSD-3-Clause */
/* Compiled as C and as C++ with each of the headers, HEADER, in the first place: it stands alone, brings the others
 * along, can be read twice, and its constants are integers. */
#include HEADER

#include <sfdae/events.h>
#include <sfdae/expression.h>
#include <sfdae/multibody.h>
#include <sfdae/sfdae.h>

int status_of(sfdae_solver** solver, const sfdae_linear_problem* problem);
int product(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
            sfdae_expression* residual, void* user);
sfdae_equations_function equations_of(const sfdae_nonlinear_problem* problem);
int is_orthogonal(const sfdae_multibody_problem* problem);
int watch(sfdae_solver* solver, sfdae_event_function function);

int status_of(sfdae_solver** solver, const sfdae_linear_problem* problem) {
  switch (sfdae_create_linear(solver, problem, NULL)) {
    case SFDAE_OK: return 0;
    case SFDAE_ILLEGAL_ARGUMENT: return 1;
    case SFDAE_OUT_OF_MEMORY: return 2;
    default: return 3;
  }
}

int product(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
            sfdae_expression* residual, void* user) {
  (void)record, (void)user;
  residual[0] = sfdae_subtract(xdot[0], sfdae_multiply(t, x[0]));
  return 0;
}

sfdae_equations_function equations_of(const sfdae_nonlinear_problem* problem) {
  return problem->equations != NULL ? problem->equations : product;
}

int is_orthogonal(const sfdae_multibody_problem* problem) {
  switch (problem->coordinates) {
    case SFDAE_COORDINATES_ORTHOGONAL: return 1;
    case SFDAE_COORDINATES_PERMUTATION: return 0;
    default: return -1;
  }
}

int watch(sfdae_solver* solver, sfdae_event_function function) {
  return sfdae_set_events(solver, 1, function, NULL, NULL);
}
