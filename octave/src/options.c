/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Options: one table for reading them and for the list that sfdae_options shows. */
#include <stddef.h>
#include <string.h>

#include "sfdae_mex.h"

typedef struct option {
  const char* name;
  char kind; /* d: number, i: whole number, l: whole number (long), c: choice, v: n numbers, f: n flags */
  size_t place;
  const char* choices[5]; /* names of 0, 1, ... */
} option;

#define PLACE(member) offsetof(sfdae_options, member)

static const option options[] = {
    {"rtol", 'd', PLACE(rtol), {NULL}},
    {"atol", 'd', PLACE(atol), {NULL}},
    {"rtol_vector", 'v', PLACE(rtol_vector), {NULL}},
    {"atol_vector", 'v', PLACE(atol_vector), {NULL}},
    {"method", 'c', PLACE(method), {"bdf", "radau", "automatic", NULL}},
    {"max_order", 'i', PLACE(max_order), {NULL}},
    {"min_stages", 'i', PLACE(min_stages), {NULL}},
    {"max_stages", 'i', PLACE(max_stages), {NULL}},
    {"initial_step", 'd', PLACE(initial_step), {NULL}},
    {"max_step", 'd', PLACE(max_step), {NULL}},
    {"max_steps", 'l', PLACE(max_steps), {NULL}},
    {"use_stop_time", 'i', PLACE(use_stop_time), {NULL}},
    {"stop_time", 'd', PLACE(stop_time), {NULL}},
    {"initial_values", 'c', PLACE(initial_values), {"nearest", "fixed", "accept", NULL}},
    {"fixed", 'f', PLACE(fixed), {NULL}},
    {"initial_weights", 'v', PLACE(initial_weights), {NULL}},
    {"xdot_is_guess", 'i', PLACE(xdot_is_guess), {NULL}},
    {"output", 'c', PLACE(output), {"consistent", "interpolated", NULL}},
    {"structure", 'c', PLACE(structure), {"off", "automatic", "required", NULL}},
    {"conditions", 'c', PLACE(conditions), {"smooth", "events", NULL}},
    {"check_derivatives", 'i', PLACE(check_derivatives), {NULL}},
    {"max_index", 'i', PLACE(max_index), {NULL}},
    {"reduction", 'c', PLACE(reduction), {"staged", "svd", NULL}},
    {"rank_tol", 'd', PLACE(rank_tol), {NULL}},
    {"time_scale", 'd', PLACE(time_scale), {NULL}},
    {"difference_derivatives", 'i', PLACE(difference_derivatives), {NULL}},
    {"difference_step", 'd', PLACE(difference_step), {NULL}},
    {"leading_term", 'c', PLACE(leading_term), {"automatic", "projector", "matrix", "identity", NULL}},
    {"ignore_inconsistency", 'i', PLACE(ignore_inconsistency), {NULL}},
    {"consistency_tol", 'd', PLACE(consistency_tol), {NULL}},
};
static const int num_options = (int)(sizeof options / sizeof options[0]);

static int choice_in(const mxArray* from, const option* of) {
  const char* name = text_in(from, of->name);
  int i;
  for (i = 0; of->choices[i] != NULL; ++i) {
    if (strcmp(of->choices[i], name) == 0) return i;
  }
  refuse("%s is '%s', which is none of its choices", of->name, name);
  return 0;
}

sfdae_options* read_options(const mxArray* from, int n) {
  sfdae_options* result = (sfdae_options*)mxMalloc(sizeof *result);
  int i;
  sfdae_options_init(result, sizeof *result);
  for (i = 0; i < num_options; ++i) {
    const option* o = options + i;
    void* place = (char*)result + o->place;
    if (field_of(from, o->name) == NULL) continue;
    switch (o->kind) {
      case 'd': *(double*)place = number_in(from, o->name, 0.0); break;
      case 'i': *(int*)place = (int)integer_in(from, o->name, 0); break;
      case 'l': *(long*)place = integer_in(from, o->name, 0); break;
      case 'c': *(int*)place = choice_in(from, o); break;
      case 'v': *(const double**)place = numbers_in(from, o->name, (size_t)n); break;
      default: *(const int**)place = integers_in(from, o->name, (size_t)n, 0); break;
    }
  }
  return result;
}

mxArray* list_options(void) {
  mxArray* result = mxCreateCellMatrix(num_options, 3);
  int i, k;
  for (i = 0; i < num_options; ++i) {
    const char kind[2] = {options[i].kind, 0};
    mxArray* choices;
    int count = 0;
    while (options[i].choices[count] != NULL) ++count;
    choices = mxCreateCellMatrix(1, count);
    for (k = 0; k < count; ++k) mxSetCell(choices, k, mxCreateString(options[i].choices[k]));
    mxSetCell(result, i, mxCreateString(options[i].name));
    mxSetCell(result, i + num_options, mxCreateString(kind));
    mxSetCell(result, i + 2 * num_options, choices);
  }
  return result;
}
