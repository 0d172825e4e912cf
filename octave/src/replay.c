/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Formulas that a recording has returned, checked and replayed with expressions of the library. */
#include <stdlib.h>
#include <string.h>

#include "operations.h"
#include "sfdae_mex.h"

static const int* int32_field(const mxArray* from, const char* name, size_t count) {
  const mxArray* value = field_of(from, name);
  if (value == NULL && count == 0) return NULL;
  if (value == NULL || mxGetClassID(value) != mxINT32_CLASS || (size_t)mxGetNumberOfElements(value) != count) {
    refuse("formulas are damaged: %s", name);
  }
  return (const int*)mxGetData(value);
}

/* Names of parameters and tables: items[k] is a name or a struct with degree, x, y. */
static void read_items(tape* formulas, const mxArray* items) {
  int i;
  formulas->num_names = formulas->num_tables = items == NULL ? 0 : (int)mxGetNumberOfElements(items);
  if (items != NULL && !mxIsCell(items)) refuse("formulas are damaged: items");
  formulas->names = (const char**)mxCalloc((size_t)formulas->num_names + 1, sizeof(char*));
  formulas->tables = (struct tape_table*)mxCalloc((size_t)formulas->num_tables + 1, sizeof *formulas->tables);
  for (i = 0; i < formulas->num_names; ++i) {
    const mxArray* item = mxGetCell(items, i);
    struct tape_table* table = formulas->tables + i;
    if (item != NULL && mxIsChar(item)) {
      formulas->names[i] = mxArrayToString(item);
    } else {
      table->degree = (int)integer_in(item, "degree", 1);
      table->count = (int)length_of(item, "x");
      table->x = numbers_in(item, "x", (size_t)table->count);
      table->y = numbers_in(item, "y", (size_t)table->count);
      if (table->x == NULL || table->y == NULL) refuse("a table needs points x and values y");
    }
  }
}

static void check_node(const tape* f, int i, int num_x, int num_xdot) {
  const int op = f->op[i], a = f->a[i], b = f->b[i], c = f->c[i];
  const int sizes[3] = {1, num_x, num_xdot};
  int is_right = op >= 0 && op < sfdae_num_operations;
  if (is_right) {
    const int count = sfdae_operations[op].num_operands;
    if (count > 0) is_right = a >= 0 && a < i;
    if (count > 1) is_right = is_right && b >= 0 && b < i;
    if (count > 2) is_right = is_right && c >= 0 && c < i;
    if (op == OP_VARIABLE) is_right = a >= 0 && a < 3 && b >= 0 && b < sizes[a];
    if (op == OP_PARAMETER) is_right = b >= 0 && b < f->num_names && f->names[b] != NULL;
    if (op == OP_TABLE) is_right = is_right && b >= 0 && b < f->num_tables && f->tables[b].x != NULL;
  }
  if (!is_right) refuse("formulas are damaged: operation %d", i);
}

tape read_tape(const mxArray* from, int num_x, int num_xdot) {
  tape result;
  size_t count;
  int i;
  memset(&result, 0, sizeof result);
  if (from == NULL) refuse("formulas are missing");
  count = length_of(from, "op");
  result.count = (int)count;
  result.op = int32_field(from, "op", count);
  result.a = int32_field(from, "a", count);
  result.b = int32_field(from, "b", count);
  result.c = int32_field(from, "c", count);
  result.value = numbers_in(from, "value", count);
  read_items(&result, field_of(from, "items"));
  for (i = 0; i < result.count; ++i) check_node(&result, i, num_x, num_xdot);
  return result;
}

const int* read_nodes(const mxArray* from, const char* name, const tape* formulas, size_t count) {
  const int* places;
  size_t i;
  if (field_of(from, name) == NULL) return NULL;
  places = int32_field(from, name, count);
  for (i = 0; i < count; ++i) {
    if (places[i] < -1 || places[i] >= formulas->count)
      refuse("formulas are damaged: entry %lu of %s", (unsigned long)i, name);
  }
  return places;
}

static sfdae_expression node_of(const tape* f, int i, const tape_inputs* in, const sfdae_expression* v) {
  const sfdae_operation* operation = sfdae_operations + f->op[i];
  const int a = f->a[i], b = f->b[i];
  switch (f->op[i]) {
    case OP_DEAD: return sfdae_number(0.0);
    case OP_VARIABLE: return a == 0 ? in->t : a == 1 ? in->x[b] : in->xdot[b];
    case OP_NUMBER: return sfdae_number(f->value[i]);
    case OP_PARAMETER: return sfdae_parameter(in->record, f->names[b], f->value[i]);
    case OP_TABLE: return sfdae_table(v[a], f->tables[b].degree, f->tables[b].count, f->tables[b].x, f->tables[b].y);
    default: break;
  }
  if (operation->num_operands == 1) return operation->unary(v[a]);
  if (operation->num_operands == 2) return operation->binary(v[a], v[b]);
  return operation->ternary(v[a], v[b], v[f->c[i]]);
}

sfdae_expression* replay(const tape* formulas, const tape_inputs* inputs) {
  sfdae_expression* values = (sfdae_expression*)malloc(((size_t)formulas->count + 1) * sizeof(sfdae_expression));
  int i;
  if (values == NULL) return NULL;
  for (i = 0; i < formulas->count; ++i) values[i] = node_of(formulas, i, inputs, values);
  return values;
}
