/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Structs of results. Indices that Octave sees count from 1; texts of the library count from 0. */
#include <ctype.h>
#include <string.h>

#include "sfdae_mex.h"

mxArray* new_struct(void) { return mxCreateStructMatrix(1, 1, 0, NULL); }

void set_field(mxArray* result, const char* name, mxArray* value) {
  if (mxGetFieldNumber(result, name) < 0) mxAddField(result, name);
  mxSetField(result, 0, name, value);
}

void set_number(mxArray* result, const char* name, double value) {
  set_field(result, name, mxCreateDoubleScalar(value));
}

mxArray* matrix_of(const double* numbers, size_t rows, size_t columns) {
  mxArray* result = mxCreateDoubleMatrix((mwSize)rows, (mwSize)columns, mxREAL);
  if (numbers != NULL && rows * columns > 0) memcpy(mxGetPr(result), numbers, rows * columns * sizeof(double));
  return result;
}

void set_status(mxArray* result, const problem* p, const sfdae_solver* solver, int status, const char* message) {
  const int is_left = p->calls != NULL && p->calls->is_calling;
  if (is_left && was_interrupted()) {
    status = SFDAE_STOPPED;
    message = "interrupted by the user";
  }
  if (p->calls != NULL && p->calls->message[0] != 0 && status < 0) message = p->calls->message;
  if (message == NULL) message = sfdae_message(solver);
  set_number(result, "status", status);
  set_field(result, "status_name", mxCreateString(sfdae_status_name(status)));
  set_field(result, "message", mxCreateString(message));
  set_number(result, "has_exception", p->calls != NULL && (p->calls->has_exception || is_left));
  set_number(result, "was_interrupted", is_left || was_interrupted());
}

mxArray* characteristics_of(const sfdae_solver* solver) {
  sfdae_characteristics c;
  mxArray* result = new_struct();
  sfdae_characteristics_init(&c, sizeof c);
  if (sfdae_get_characteristics(solver, &c) < 0) return result;
  set_number(result, "t", c.t);
  set_number(result, "strangeness_index", c.strangeness_index);
  set_number(result, "d", c.differential);
  set_number(result, "a", c.algebraic);
  set_number(result, "u", c.undetermined);
  set_number(result, "v", c.redundant);
  set_number(result, "rank_E", c.rank_E);
  set_number(result, "time_scale", c.time_scale);
  set_number(result, "smallest_gap", c.smallest_gap);
  return result;
}

mxArray* statistics_of(const sfdae_solver* solver) {
  sfdae_statistics s;
  mxArray* result = new_struct();
  sfdae_statistics_init(&s, sizeof s);
  if (sfdae_get_statistics(solver, &s) < 0) return result;
  set_number(result, "steps", (double)s.steps);
  set_number(result, "error_failures", (double)s.error_failures);
  set_number(result, "other_failures", (double)s.other_failures);
  set_number(result, "reductions", (double)s.reductions);
  set_number(result, "factorizations", (double)s.factorizations);
  set_number(result, "evaluations_E", (double)s.evaluations_E);
  set_number(result, "evaluations_A", (double)s.evaluations_A);
  set_number(result, "evaluations_f", (double)s.evaluations_f);
  set_number(result, "evaluations_F", (double)s.evaluations_F);
  set_number(result, "linearizations", (double)s.linearizations);
  set_number(result, "last_order", s.last_order);
  set_number(result, "first_step", s.first_step);
  set_number(result, "last_step", s.last_step);
  set_number(result, "next_step", s.next_step);
  set_number(result, "smallest_kept", s.smallest_kept);
  set_number(result, "consistency", s.consistency);
  set_number(result, "rounding", s.rounding);
  set_number(result, "switches", (double)s.switches);
  set_number(result, "jumps", (double)s.jumps);
  return result;
}

mxArray* decisions_of(const sfdae_solver* solver) {
  static const char* fields[] = {"t",    "level", "stage",   "rows", "columns",
                                 "rank", "kept",  "dropped", "gap",  "verdict"};
  static const char* const verdicts[] = {"clear", "confirmed", "unclear", "user"};
  mxArray* result;
  int count = 0, i;
  if (sfdae_get_num_decisions(solver, &count) < 0) count = 0;
  result = mxCreateStructMatrix((mwSize)count, 1, 10, fields);
  for (i = 0; i < count; ++i) {
    sfdae_decision d;
    sfdae_decision_init(&d, sizeof d);
    if (sfdae_get_decision(solver, i, &d) < 0) continue;
    mxSetField(result, i, "t", mxCreateDoubleScalar(d.t));
    mxSetField(result, i, "level", mxCreateDoubleScalar(d.level));
    mxSetField(result, i, "stage", mxCreateDoubleScalar(d.stage));
    mxSetField(result, i, "rows", mxCreateDoubleScalar(d.rows));
    mxSetField(result, i, "columns", mxCreateDoubleScalar(d.columns));
    mxSetField(result, i, "rank", mxCreateDoubleScalar(d.rank));
    mxSetField(result, i, "kept", mxCreateDoubleScalar(d.kept));
    mxSetField(result, i, "dropped", mxCreateDoubleScalar(d.dropped));
    mxSetField(result, i, "gap", mxCreateDoubleScalar(d.gap));
    mxSetField(result, i, "verdict",
               mxCreateString(d.verdict >= 0 && d.verdict < 4 ? verdicts[d.verdict] : "unknown"));
  }
  return result;
}

/* A row of whole numbers, `offset` added to each. */
static mxArray* row_of(const int* numbers, int count, int offset) {
  mxArray* result = mxCreateDoubleMatrix(1, (mwSize)count, mxREAL);
  int i;
  for (i = 0; i < count; ++i) mxGetPr(result)[i] = numbers[i] + offset;
  return result;
}

mxArray* structure_of(sfdae_solver* solver, int n) {
  static const char* const verdicts[] = {"unchecked", "certified", "misleads", "unclear"};
  int* numbers = (int*)mxCalloc(4 * (size_t)n + 4, sizeof(int));
  mxArray* result = new_struct();
  sfdae_structure s;
  sfdae_structure_init(&s, sizeof s);
  if (sfdae_get_structure(solver, &s, numbers, numbers + n, numbers + 2 * n, numbers + 3 * n) >= 0) {
    set_number(result, "has_assignment", s.has_assignment);
    set_number(result, "freedom", s.freedom);
    set_number(result, "index_bound", s.index_bound);
    set_number(result, "num_blocks", s.num_blocks);
    set_number(result, "largest_block", s.largest_block);
    set_number(result, "is_followed", s.is_followed);
    set_number(result, "num_replaced", s.num_replaced);
    set_field(result, "verdict", mxCreateString(s.verdict >= 0 && s.verdict < 4 ? verdicts[s.verdict] : "unknown"));
    set_field(result, "differentiations", row_of(numbers, n, 0));
    set_field(result, "orders", row_of(numbers + n, n, 0));
    set_field(result, "assigned", row_of(numbers + 2 * n, n, 1));
    set_field(result, "block", row_of(numbers + 3 * n, n, 1));
  }
  mxFree(numbers);
  return result;
}

mxArray* initial_report_of(const sfdae_solver* solver) {
  mxArray* result = new_struct();
  sfdae_initial_report r;
  sfdae_initial_report_init(&r, sizeof r);
  if (sfdae_get_initial_report(solver, &r) < 0) return result;
  set_number(result, "t", r.t);
  set_number(result, "residual_before", r.residual_before);
  set_number(result, "residual_after", r.residual_after);
  set_number(result, "largest_change", r.largest_change);
  set_number(result, "component", r.component + 1);
  return result;
}

mxArray* report_of(const sfdae_solver* solver) {
  size_t needed = 0;
  char* text;
  mxArray* result;
  if (sfdae_report(solver, NULL, 0, &needed) < 0 || needed == 0) return mxCreateString("");
  text = (char*)mxCalloc(needed + 1, 1);
  sfdae_report(solver, text, needed, NULL);
  result = mxCreateString(text);
  mxFree(text);
  return result;
}

static mxArray* text_of_condition(const sfdae_solver* solver, long index) {
  size_t needed = 0;
  sfdae_switch s;
  char* text;
  mxArray* result;
  sfdae_switch_init(&s, sizeof s);
  if (sfdae_get_switch(solver, index, &s, NULL, 0, &needed) < 0 || needed == 0) return mxCreateString("");
  text = (char*)mxCalloc(needed + 1, 1);
  sfdae_get_switch(solver, index, &s, text, needed, NULL);
  result = mxCreateString(text);
  mxFree(text);
  return result;
}

mxArray* switches_of(const sfdae_solver* solver, mxArray* earlier) {
  static const char* fields[] = {"t", "before", "after", "jumps", "condition", "text"};
  const mwSize before = earlier == NULL ? 0 : mxGetNumberOfElements(earlier);
  long count = 0, i;
  int k;
  mxArray *result, **texts; /* of conditions: at most as many as switches */
  if (sfdae_get_num_switches(solver, &count) < 0) count = 0;
  texts = (mxArray**)mxCalloc((size_t)count + 1, sizeof(mxArray*));
  result = mxCreateStructMatrix(before + (mwSize)count, 1, 6, fields);
  for (i = 0; i < (long)before; ++i) {
    for (k = 0; k < 6; ++k) {
      mxSetField(result, i, fields[k], mxGetField(earlier, i, fields[k]));
      mxSetField(earlier, i, fields[k], NULL);
    }
  }
  if (earlier != NULL) mxDestroyArray(earlier);
  for (i = 0; i < count; ++i) {
    const mwIndex place = before + (mwIndex)i;
    sfdae_switch s;
    sfdae_switch_init(&s, sizeof s);
    if (sfdae_get_switch(solver, i, &s, NULL, 0, NULL) < 0) continue;
    mxSetField(result, place, "t", mxCreateDoubleScalar(s.t));
    mxSetField(result, place, "before", mxCreateDoubleScalar(s.before));
    mxSetField(result, place, "after", mxCreateDoubleScalar(s.after));
    mxSetField(result, place, "jumps", mxCreateDoubleScalar(s.jumps));
    mxSetField(result, place, "condition", mxCreateDoubleScalar(s.condition + 1));
    if (s.condition < 0 || s.condition >= count) continue;
    if (texts[s.condition] == NULL) texts[s.condition] = text_of_condition(solver, i);
    mxSetField(result, place, "text", mxDuplicateArray(texts[s.condition]));
  }
  for (i = 0; i < count; ++i) {
    if (texts[i] != NULL) mxDestroyArray(texts[i]);
  }
  mxFree(texts);
  return result;
}
