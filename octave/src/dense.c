/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Dense output of a recorded solution. */
#include <stdio.h>

#include "sfdae_mex.h"

mxArray* evaluate_command(const mxArray* solution, const mxArray* times) {
  const size_t count = (size_t)mxGetNumberOfElements(times);
  mxArray *result = new_struct(), *x, *xdot;
  sfdae_solution* s = NULL;
  double first = 0.0, last = 0.0;
  int n = 0, status;
  size_t k;
  char message[300] = "";
  if (!mxIsDouble(solution) || mxIsComplex(solution) || mxIsSparse(solution)) refuse("sol.dense is damaged");
  if (!mxIsDouble(times) || mxIsComplex(times) || mxIsSparse(times)) refuse("times have to be real numbers");
  status = sfdae_create_solution(&s);
  if (status >= 0) status = sfdae_load_solution(s, mxGetPr(solution), (size_t)mxGetNumberOfElements(solution));
  if (status >= 0) status = sfdae_get_solution_range(s, &n, &first, &last);
  else snprintf(message, sizeof message, "sol.dense is damaged, or was written by another version");
  x = mxCreateDoubleMatrix((mwSize)n, (mwSize)count, mxREAL);
  xdot = mxCreateDoubleMatrix((mwSize)n, (mwSize)count, mxREAL);
  for (k = 0; k < count && status >= 0; ++k) {
    const double t = mxGetPr(times)[k];
    status = sfdae_evaluate_solution(s, t, mxGetPr(x) + k * (size_t)n, mxGetPr(xdot) + k * (size_t)n);
    if (status < 0)
      snprintf(message, sizeof message, "t = %.9g lies outside of the solution, %.9g ... %.9g", t, first, last);
  }
  sfdae_destroy_solution(&s);
  set_number(result, "status", status);
  set_field(result, "message", mxCreateString(message));
  set_field(result, "x", x);
  set_field(result, "xdot", xdot);
  return result;
}
