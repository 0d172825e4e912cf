/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Calls of functions of the user. sfdae_call_ calls the function, keeps its error, and makes results full matrices of
 * class double, so that no error passes through the library. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sfdae_mex.h"

#define MAX_ARGUMENTS 8

int call_function(calls* state, const mxArray* function, int nout, mxArray** out, int nin, mxArray** in) {
  mxArray *arguments[MAX_ARGUMENTS + 1], *results[MAX_ARGUMENTS + 1] = {NULL}, *trapped;
  int i, flag = -1;
  arguments[0] = (mxArray*)function;
  for (i = 0; i < nin; ++i) arguments[i + 1] = in[i];
  state->is_calling = 1;
  trapped = mexCallMATLABWithTrap(nout + 1, results, nin + 1, arguments, "sfdae_call_");
  state->is_calling = 0;
  for (i = 0; i < nin; ++i) mxDestroyArray(in[i]);
  if (trapped == NULL && results[0] != NULL) flag = (int)mxGetScalar(results[0]);
  if (flag != 0 && flag != 1) {
    state->has_exception = 1;
    flag = -1;
  }
  if (trapped != NULL) mxDestroyArray(trapped);
  if (results[0] != NULL) mxDestroyArray(results[0]);
  for (i = 0; i < nout; ++i) {
    out[i] = flag == 0 ? results[i + 1] : NULL;
    if (flag != 0 && results[i + 1] != NULL) mxDestroyArray(results[i + 1]);
  }
  return flag;
}

int take_numbers(calls* state, mxArray* result, size_t rows, size_t columns, const char* name, double* numbers) {
  const size_t count = rows * columns;
  size_t i;
  int is_right = result != NULL && mxIsDouble(result) && !mxIsComplex(result) && !mxIsSparse(result) &&
                 (size_t)mxGetNumberOfElements(result) == count;
  if (is_right && columns > 1) is_right = (size_t)mxGetM(result) == rows;
  if (is_right) {
    const double* from = mxGetPr(result);
    for (i = 0; i < count; ++i) numbers[i] = from[i];
  } else if (state->message[0] == 0) {
    snprintf(state->message, sizeof state->message,
             "%s returned an array of size %lu x %lu and class %s%s; it has to be "
             "%lu x %lu and real",
             name, result == NULL ? 0UL : (unsigned long)mxGetM(result),
             result == NULL ? 0UL : (unsigned long)mxGetN(result), result == NULL ? "none" : mxGetClassName(result),
             result != NULL && mxIsComplex(result) ? " with complex values" : "", (unsigned long)rows,
             (unsigned long)columns);
  }
  if (result != NULL) mxDestroyArray(result);
  return is_right ? 0 : -1;
}

mxArray* column_of(const double* numbers, size_t count) { return matrix_of(numbers, count, 1); }

/* ---- Recorded equations ----------------------------------------------------------------------- */

static void write_nodes(const int* places, size_t count, const sfdae_expression* values, sfdae_expression* result) {
  size_t i;
  if (places == NULL) return;
  for (i = 0; i < count; ++i) {
    if (places[i] >= 0) result[i] = values[places[i]];
  }
}

int call_equations(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                   sfdae_expression* residual, void* user) {
  const problem* p = (const problem*)user;
  const tape_inputs inputs = {record, t, x, xdot};
  sfdae_expression* values = replay(&p->formulas, &inputs);
  if (values == NULL) return -1;
  write_nodes(p->outputs[0], (size_t)p->num_equations, values, residual);
  free(values);
  return 0;
}

int call_linear_equations(sfdae_record* record, sfdae_expression t, sfdae_expression* E, sfdae_expression* A,
                          sfdae_expression* f, void* user) {
  const problem* p = (const problem*)user;
  const size_t m = (size_t)p->num_equations, n = (size_t)p->num_unknowns;
  const tape_inputs inputs = {record, t, NULL, NULL};
  sfdae_expression* values = replay(&p->formulas, &inputs);
  if (values == NULL) return -1;
  write_nodes(p->outputs[0], m * n, values, E);
  write_nodes(p->outputs[1], m * n, values, A);
  write_nodes(p->outputs[2], m, values, f);
  free(values);
  return 0;
}

int call_multibody_equations(sfdae_record* record, sfdae_expression t, const sfdae_expression* q,
                             const sfdae_expression* v, const sfdae_multibody_formulas* formulas, void* user) {
  const problem* p = (const problem*)user;
  const size_t nq = (size_t)p->num_positions, nv = (size_t)p->num_velocities;
  const size_t nl = (size_t)p->num_constraints, nk = (size_t)p->num_nonholonomic;
  const tape_inputs inputs = {record, t, q, v};
  sfdae_expression* values = replay(&p->formulas, &inputs);
  if (values == NULL) return -1;
  write_nodes(p->outputs[0], nv * nv, values, formulas->M);
  write_nodes(p->outputs[1], nv, values, formulas->f);
  write_nodes(p->outputs[2], nl, values, formulas->g);
  write_nodes(p->outputs[3], nq * nv, values, formulas->S);
  write_nodes(p->outputs[4], nk * nv, values, formulas->H);
  write_nodes(p->outputs[5], nk, values, formulas->h);
  free(values);
  return 0;
}

/* ---- Events and the monitor ------------------------------------------------------------------- */

int call_events(double t, const double* x, const double* xdot, double* g, void* user) {
  problem* p = (problem*)user;
  const size_t n = (size_t)p->num_unknowns;
  mxArray *in[3], *out[3];
  int status, i;
  in[0] = mxCreateDoubleScalar(t);
  in[1] = column_of(x, n);
  in[2] = column_of(xdot, n);
  status = call_function(p->calls, p->events, p->event_outputs, out, 3, in);
  if (status != 0) return status;
  for (i = 1; i < p->event_outputs; ++i) { /* isterminal and direction are those at the start */
    if (out[i] != NULL) mxDestroyArray(out[i]);
  }
  return take_numbers(p->calls, out[0], (size_t)p->num_events, 1, "the event function", g);
}

int call_monitor(const sfdae_progress* progress, void* user) {
  problem* p = (problem*)user;
  mxArray *in[5], *out;
  double stops = 0.0;
  if (p->monitor == NULL) return was_interrupted();
  in[0] = mxCreateDoubleScalar(progress->t);
  in[1] = column_of(progress->x, (size_t)progress->num_unknowns);
  in[2] = mxCreateDoubleScalar(progress->step);
  in[3] = mxCreateDoubleScalar(progress->order);
  in[4] = mxCreateDoubleScalar((double)progress->steps);
  if (call_function(p->calls, p->monitor, 1, &out, 5, in) != 0) return 1;
  if (take_numbers(p->calls, out, 1, 1, "the monitor", &stops) != 0) return 1;
  return stops != 0.0 || was_interrupted();
}
