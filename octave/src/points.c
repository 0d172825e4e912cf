/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Index analysis and consistent values at a point. */
#include <string.h>

#include "sfdae_mex.h"

/* The structural analysis. Linear problems need a start for it: their analysis leaves no values of x. */
static mxArray* structure_at(sfdae_solver* solver, double t, double toward, const double* x, size_t n) {
  mxArray* result = structure_of(solver, (int)n);
  double* start;
  if (mxGetNumberOfFields(result) > 0) return result;
  start = (double*)mxCalloc(n + 1, sizeof(double));
  if (x != NULL) memcpy(start, x, n * sizeof(double));
  if (sfdae_start(solver, t, toward, start, NULL) >= 0) {
    mxDestroyArray(result);
    result = structure_of(solver, (int)n);
  }
  mxFree(start);
  return result;
}

mxArray* analyze_command(const mxArray* from, const mxArray* options, const mxArray* at) {
  problem* p = read_problem(from);
  const sfdae_options* o = read_options(options, p->num_unknowns);
  const double t = number_in(at, "t", 0.0), toward = number_in(at, "toward", t + 1.0);
  const double* x = numbers_in(at, "x", (size_t)p->num_unknowns);
  mxArray* result = new_struct();
  sfdae_solver* solver;
  int status = open_solver(p, o, &solver);
  if (status >= 0 && x == NULL) status = sfdae_analyze(solver, t, toward, NULL);
  else if (status >= 0) status = sfdae_analyze_at(solver, t, toward, x, NULL);
  set_status(result, p, solver, status, NULL);
  if (solver != NULL) {
    set_field(result, "characteristics", characteristics_of(solver));
    set_field(result, "decisions", decisions_of(solver));
    set_field(result, "report", report_of(solver));
    set_field(result, "structure",
              status < 0 ? new_struct() : structure_at(solver, t, toward, x, (size_t)p->num_unknowns));
  }
  close_solver(&solver);
  return result;
}

mxArray* consistent_command(const mxArray* from, const mxArray* options, const mxArray* at) {
  problem* p = read_problem(from);
  const size_t n = (size_t)p->num_unknowns;
  const sfdae_options* o = read_options(options, p->num_unknowns);
  const double t = number_in(at, "t", 0.0);
  double *x = numbers_in(at, "x", n), *xdot = numbers_in(at, "xdot", n);
  mxArray* result = new_struct();
  sfdae_solver* solver;
  int status;
  if (x == NULL) refuse("x0 is missing");
  if (xdot == NULL) xdot = (double*)mxCalloc(n + 1, sizeof(double));
  status = open_solver(p, o, &solver);
  if (status >= 0) status = sfdae_make_consistent(solver, t, x, xdot);
  set_status(result, p, solver, status, NULL);
  set_field(result, "x", matrix_of(x, n, 1));
  set_field(result, "xdot", matrix_of(xdot, n, 1));
  if (solver != NULL) {
    set_field(result, "characteristics", characteristics_of(solver));
    set_field(result, "initial", initial_report_of(solver));
    set_field(result, "report", report_of(solver));
  }
  close_solver(&solver);
  return result;
}
