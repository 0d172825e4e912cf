/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The only function of the package that is written in C: sfdae_mex(command, ...). Users call the functions in inst/. */
#include <string.h>

#include "sfdae_mex.h"

static void need_structs(int nrhs, const mxArray* prhs[], int count) {
  int i;
  if (nrhs != count) refuse("sfdae_mex: %d arguments are needed, not %d", count, nrhs);
  for (i = 0; i < count; ++i) {
    if (!mxIsStruct(prhs[i]) || mxGetNumberOfElements(prhs[i]) != 1)
      refuse("sfdae_mex: argument %d is no struct", i + 1);
  }
}

static void run_command(const char* name, int nlhs, mxArray* plhs[], int nrhs, const mxArray* prhs[]) {
  if (strcmp(name, "solve") == 0) {
    need_structs(nrhs, prhs, 3);
    plhs[0] = solve_command(prhs[0], prhs[1], prhs[2]);
  } else if (strcmp(name, "analyze") == 0) {
    need_structs(nrhs, prhs, 3);
    plhs[0] = analyze_command(prhs[0], prhs[1], prhs[2]);
  } else if (strcmp(name, "consistent") == 0) {
    need_structs(nrhs, prhs, 3);
    plhs[0] = consistent_command(prhs[0], prhs[1], prhs[2]);
  } else if (strcmp(name, "linearize") == 0) {
    need_structs(nrhs, prhs, 3);
    plhs[0] = linearize_command(prhs[0], prhs[1], prhs[2]);
  } else if (strcmp(name, "descriptor") == 0) {
    need_structs(nrhs, prhs, 2);
    plhs[0] = descriptor_command(prhs[0], prhs[1]);
  } else if (strcmp(name, "evaluate") == 0 && nrhs == 2) {
    plhs[0] = evaluate_command(prhs[0], prhs[1]);
  } else if (strcmp(name, "options") == 0) {
    plhs[0] = list_options();
  } else if (strcmp(name, "version") == 0) {
    plhs[0] = mxCreateString(sfdae_version());
  } else if (!tape_command(name, nlhs, plhs, nrhs, prhs)) {
    refuse("sfdae_mex has no command '%s' with %d arguments", name, nrhs);
  }
}

void mexFunction(int nlhs, mxArray* plhs[], int nrhs, const mxArray* prhs[]) {
  char name[40];
  if (nrhs < 1 || !mxIsChar(prhs[0]) || mxGetString(prhs[0], name, sizeof name) != 0) {
    refuse("sfdae_mex needs the name of a command; use sfdae_solve and the other functions of the package");
  }
  run_command(name, nlhs, plhs, nrhs - 1, prhs + 1);
}
