/* SPDX-License-Identifier: BSD-3-Clause */
/* Compiled as C and as C++: the header stands alone, can be read twice, and its constants are integers. */
#include <sfdae/sfdae.h>

int status_of(sfdae_solver** solver, const sfdae_linear_problem* problem);

int status_of(sfdae_solver** solver, const sfdae_linear_problem* problem) {
  switch (sfdae_create_linear(solver, problem, NULL)) {
    case SFDAE_OK: return 0;
    case SFDAE_ILLEGAL_ARGUMENT: return 1;
    case SFDAE_OUT_OF_MEMORY: return 2;
    default: return 3;
  }
}
