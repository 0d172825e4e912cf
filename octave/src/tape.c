/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Recorded formulas. While a function of the user writes equations, every operation on expressions adds nodes to the
 * tape; the end of the recording returns them as arrays, which are replayed when the library records. So functions of
 * the user run in Octave alone, never within a call of the library, when equations are recorded.
 *
 * Octave knows a node by a number of class int64, and numbers by class double. Numbers of nodes are never used again:
 * an expression that outlives its recording is recognized. */
#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "operations.h"
#include "sfdae_mex.h"

typedef struct node {
  int op, a, b, c;
  double value;
} node;

static node* nodes = NULL; /* of all recordings under way, one after the other */
static int num_nodes = 0, capacity = 0;
static mxArray* payload = NULL; /* cell array of names and tables of the recordings under way */
static int num_payload = 0;

#define MAX_RECORDINGS 32
static struct { int first_node, first_payload, num_x, num_xdot; } recordings[MAX_RECORDINGS];
static int num_recordings = 0;
static int64_t base = 0; /* number of the node nodes[0] */

static void free_tape(void) {
  free(nodes);
  nodes = NULL;
  num_nodes = capacity = num_payload = num_recordings = 0;
  if (payload != NULL) mxDestroyArray(payload);
  payload = NULL;
}

static int add_node(int op, int a, int b, int c, double value) {
  node* added;
  if (num_nodes == capacity) {
    const int larger = capacity < INT_MAX / 4 ? 2 * capacity + 1024 : 0;
    node* moved = larger > 0 ? (node*)realloc(nodes, (size_t)larger * sizeof(node)) : NULL;
    if (moved == NULL) mexErrMsgIdAndTxt("sfdae:out_of_memory", "no memory for %d operations of formulas", num_nodes);
    nodes = moved;
    capacity = larger;
  }
  added = nodes + num_nodes;
  added->op = op, added->a = a, added->b = b, added->c = c, added->value = value;
  return num_nodes++;
}

static int first_of_recording(void) {
  if (num_recordings == 0)
    refuse(
        "no equations are being recorded: expressions exist only within the function "
        "that writes equations");
  return recordings[num_recordings - 1].first_node;
}

/* ---- Operands ------------------------------------------------------------------------------- */

/* A matrix of nodes or of numbers. */
typedef struct operand {
  const int64_t* ids; /* NULL: numbers */
  const double* numbers;
  size_t rows, columns;
} operand;

static operand operand_of(const mxArray* from) {
  operand result = {NULL, NULL, 0, 0};
  if (mxGetNumberOfDimensions(from) != 2)
    refuse(
        "expressions are scalars, vectors or matrices; this array has %d "
        "dimensions",
        (int)mxGetNumberOfDimensions(from));
  result.rows = mxGetM(from);
  result.columns = mxGetN(from);
  if (mxGetClassID(from) == mxINT64_CLASS) {
    const int64_t first = base + first_of_recording(), end = base + num_nodes;
    const size_t count = result.rows * result.columns;
    size_t i;
    result.ids = (const int64_t*)mxGetData(from);
    for (i = 0; i < count; ++i) {
      if (result.ids[i] < first || result.ids[i] >= end || nodes[result.ids[i] - base].op == OP_DEAD) {
        refuse(
            "an expression of another recording is used: expressions are valid only within the call of the "
            "function that writes the equations, and cannot be stored for later");
      }
    }
  } else if (mxIsDouble(from) && !mxIsComplex(from) && !mxIsSparse(from)) {
    result.numbers = mxGetPr(from);
  } else {
    refuse("expressions and real numbers can be combined; this is an array of class %s%s", mxGetClassName(from),
           mxIsComplex(from) ? " with complex values" : "");
  }
  return result;
}

/* The node of an element; numbers get one. */
static int element(const operand* from, size_t index) {
  if (from->ids != NULL) return (int)(from->ids[index] - base);
  return add_node(OP_NUMBER, 0, 0, 0, from->numbers[index]);
}

/* Row and column of a matrix that is extended to more rows and columns if it has one. */
static int extended_element(const operand* from, size_t row, size_t column) {
  return element(from, (from->rows == 1 ? 0 : row) + from->rows * (from->columns == 1 ? 0 : column));
}

static mxArray* new_ids(size_t rows, size_t columns, int64_t** ids) {
  mxArray* result = mxCreateNumericMatrix(rows, columns, mxINT64_CLASS, mxREAL);
  *ids = (int64_t*)mxGetData(result);
  return result;
}

static size_t common_size(const operand* operands, int count, int is_rows, const char* name) {
  size_t size = 1;
  int i;
  for (i = 0; i < count; ++i) {
    const size_t own = is_rows ? operands[i].rows : operands[i].columns;
    if (own == 1) continue;
    if (size != 1 && own != size) {
      refuse("%s: sizes do not agree: %lu x %lu and %lu x %lu", name, (unsigned long)operands[0].rows,
             (unsigned long)operands[0].columns, (unsigned long)operands[i].rows, (unsigned long)operands[i].columns);
    }
    size = own;
  }
  return size;
}

/* ---- Commands ------------------------------------------------------------------------------- */

/* An operation, element by element: name, operands. */
static mxArray* apply(int op, int count, const mxArray* arguments[]) {
  operand operands[3];
  const char* name = sfdae_operations[op].name;
  size_t rows, columns, i, j;
  int64_t* ids;
  mxArray* result;
  int k;
  if (count != sfdae_operations[op].num_operands)
    refuse("%s needs %d operands", name, sfdae_operations[op].num_operands);
  for (k = 0; k < count; ++k) operands[k] = operand_of(arguments[k]);
  first_of_recording();
  rows = common_size(operands, count, 1, name);
  columns = common_size(operands, count, 0, name);
  result = new_ids(rows, columns, &ids);
  for (j = 0; j < columns; ++j) {
    for (i = 0; i < rows; ++i) {
      int places[3] = {0, 0, 0};
      for (k = 0; k < count; ++k) places[k] = extended_element(&operands[k], i, j);
      ids[i + rows * j] = base + add_node(op, places[0], places[1], places[2], 0.0);
    }
  }
  return result;
}

/* a * b + sum, without operations that do nothing; sum = -1: none yet. Zeros of numbers make no term. */
static int add_product(int sum, const operand* a, size_t i, const operand* b, size_t j) {
  const double* number = a->ids == NULL ? a->numbers + i : b->ids == NULL ? b->numbers + j : NULL;
  int term;
  if (number != NULL && *number == 0.0) return sum;
  if (number != NULL && (*number == 1.0 || *number == -1.0)) {
    term = a->ids == NULL ? element(b, j) : element(a, i);
    if (*number == -1.0 && sum >= 0) return add_node(OP_SUBTRACT, sum, term, 0, 0.0);
    if (*number == -1.0) term = add_node(OP_NEGATE, term, 0, 0, 0.0);
  } else {
    const int first = element(a, i), second = element(b, j);
    term = add_node(OP_MULTIPLY, first, second, 0, 0.0);
  }
  return sum < 0 ? term : add_node(OP_ADD, sum, term, 0, 0.0);
}

/* The product of matrices. */
static mxArray* multiply_matrices(const mxArray* arguments[]) {
  const operand a = operand_of(arguments[0]), b = operand_of(arguments[1]);
  size_t i, j, k;
  int64_t* ids;
  mxArray* result;
  if (a.columns != b.rows) {
    refuse("operator *: sizes do not agree: %lu x %lu and %lu x %lu", (unsigned long)a.rows, (unsigned long)a.columns,
           (unsigned long)b.rows, (unsigned long)b.columns);
  }
  result = new_ids(a.rows, b.columns, &ids);
  for (j = 0; j < b.columns; ++j) {
    for (i = 0; i < a.rows; ++i) {
      int sum = -1;
      for (k = 0; k < a.columns; ++k) sum = add_product(sum, &a, i + a.rows * k, &b, k + b.rows * j);
      ids[i + a.rows * j] = base + (sum < 0 ? add_node(OP_NUMBER, 0, 0, 0, 0.0) : sum);
    }
  }
  return result;
}

/* Numbers as nodes, nodes unchanged. */
static mxArray* as_nodes(const mxArray* argument) {
  const operand from = operand_of(argument);
  const size_t count = from.rows * from.columns;
  int64_t* ids;
  mxArray* result = new_ids(from.rows, from.columns, &ids);
  size_t i;
  first_of_recording();
  for (i = 0; i < count; ++i) ids[i] = base + element(&from, i);
  return result;
}

static int add_payload(const mxArray* item) {
  if (payload == NULL) {
    payload = mxCreateCellMatrix(1, 64);
    mexMakeArrayPersistent(payload);
  } else if ((size_t)num_payload == (size_t)mxGetNumberOfElements(payload)) {
    mxArray* larger = mxCreateCellMatrix(1, 2 * (mwSize)num_payload);
    int i;
    for (i = 0; i < num_payload; ++i) {
      mxSetCell(larger, i, mxGetCell(payload, i));
      mxSetCell(payload, i, NULL);
    }
    mxDestroyArray(payload);
    payload = larger;
    mexMakeArrayPersistent(payload);
  }
  mxSetCell(payload, num_payload, mxDuplicateArray(item));
  return num_payload++;
}

/* A node with a name (a parameter and its value) or a table; arguments: name, value or struct, nodes. */
static mxArray* add_with_payload(int op, const mxArray* item, double value, const operand* arguments) {
  const size_t rows = arguments == NULL ? 1 : arguments->rows, columns = arguments == NULL ? 1 : arguments->columns;
  const int place = add_payload(item) - recordings[num_recordings - 1].first_payload;
  int64_t* ids;
  mxArray* result = new_ids(rows, columns, &ids);
  size_t i;
  for (i = 0; i < rows * columns; ++i) {
    ids[i] = base + add_node(op, arguments == NULL ? 0 : element(arguments, i), place, 0, value);
  }
  return result;
}

static mxArray* add_parameter(const mxArray* arguments[]) {
  char* name = mxIsChar(arguments[0]) ? mxArrayToString(arguments[0]) : NULL;
  first_of_recording();
  if (name == NULL || name[0] == 0) refuse("a parameter needs a name");
  mxFree(name);
  if (!mxIsDouble(arguments[1]) || mxIsComplex(arguments[1]) || mxGetNumberOfElements(arguments[1]) != 1) {
    refuse("the value of a parameter has to be a real number");
  }
  return add_with_payload(OP_PARAMETER, arguments[0], mxGetScalar(arguments[1]), NULL);
}

static mxArray* add_table(const mxArray* arguments[]) {
  const operand at = operand_of(arguments[0]);
  first_of_recording();
  if (!mxIsStruct(arguments[1])) refuse("a table has to be a struct");
  return add_with_payload(OP_TABLE, arguments[1], 0.0, &at);
}

/* ---- Recordings ----------------------------------------------------------------------------- */

/* Begins a recording with num_x and num_xdot variables, and returns t, x and xdot. */
static void begin(int nlhs, mxArray* plhs[], const mxArray* arguments[]) {
  const int num_x = (int)mxGetScalar(arguments[0]), num_xdot = (int)mxGetScalar(arguments[1]);
  const int counts[3] = {1, num_x, num_xdot};
  int kind, i;
  if (num_recordings == MAX_RECORDINGS) refuse("%d recordings are within each other", num_recordings);
  if (base == 0) {
    base = (int64_t)time(NULL) << 20; /* other numbers than before sfdae_mex was cleared and loaded again */
    mexAtExit(free_tape);
  }
  recordings[num_recordings].first_node = num_nodes;
  recordings[num_recordings].first_payload = num_payload;
  recordings[num_recordings].num_x = num_x;
  recordings[num_recordings].num_xdot = num_xdot;
  ++num_recordings;
  for (kind = 0; kind < 3; ++kind) {
    int64_t* ids;
    mxArray* result = new_ids((size_t)counts[kind], 1, &ids);
    for (i = 0; i < counts[kind]; ++i) ids[i] = base + add_node(OP_VARIABLE, kind, i, 0, 0.0);
    if (kind < (nlhs > 1 ? nlhs : 1)) plhs[kind] = result;
  }
}

/* Forgets the nodes of the last recording. */
static void drop_recording(void) {
  const int first = recordings[--num_recordings].first_node;
  int i;
  for (i = recordings[num_recordings].first_payload; i < num_payload; ++i) {
    mxDestroyArray(mxGetCell(payload, i));
    mxSetCell(payload, i, NULL);
  }
  num_payload = recordings[num_recordings].first_payload;
  if (num_recordings > 0) { /* within another recording: the numbers of its nodes stay */
    for (i = first; i < num_nodes; ++i) nodes[i].op = OP_DEAD;
  } else {
    base += num_nodes;
    num_nodes = 0;
  }
}

static mxArray* integers(int count, int** numbers) {
  mxArray* result = mxCreateNumericMatrix((mwSize)count, 1, mxINT32_CLASS, mxREAL);
  *numbers = (int*)mxGetData(result);
  return result;
}

/* Ends a recording; returns its nodes. */
static mxArray* end_recording(void) {
  const int first = first_of_recording(), count = num_nodes - first;
  const int first_payload = recordings[num_recordings - 1].first_payload;
  mxArray *result = new_struct(), *value = mxCreateDoubleMatrix((mwSize)count, 1, mxREAL);
  mxArray* items = mxCreateCellMatrix(1, (mwSize)(num_payload - first_payload));
  int *op, *a, *b, *c, i;
  set_field(result, "op", integers(count, &op));
  set_field(result, "a", integers(count, &a));
  set_field(result, "b", integers(count, &b));
  set_field(result, "c", integers(count, &c));
  for (i = 0; i < count; ++i) {
    const node* from = nodes + first + i;
    const int num_operands = sfdae_operations[from->op].num_operands;
    op[i] = from->op;
    a[i] = num_operands > 0 ? from->a - first : from->a;
    b[i] = num_operands > 1 ? from->b - first : from->b;
    c[i] = num_operands > 2 ? from->c - first : from->c;
    mxGetPr(value)[i] = from->value;
  }
  for (i = first_payload; i < num_payload; ++i)
    mxSetCell(items, i - first_payload, mxDuplicateArray(mxGetCell(payload, i)));
  set_field(result, "value", value);
  set_field(result, "items", items);
  return result;
}

/* Numbers of nodes within their recording, from 0. */
static mxArray* places_of(const mxArray* argument) {
  const operand from = operand_of(argument);
  const int first = first_of_recording();
  const size_t count = from.rows * from.columns;
  mxArray* result = mxCreateNumericMatrix(from.rows, from.columns, mxINT32_CLASS, mxREAL);
  int* places = (int*)mxGetData(result);
  size_t i;
  for (i = 0; i < count; ++i) places[i] = element(&from, i) - first;
  return result;
}

int tape_command(const char* name, int nlhs, mxArray* plhs[], int nrhs, const mxArray* prhs[]) {
  int op;
  if (strcmp(name, "begin") == 0 && nrhs == 2) begin(nlhs, plhs, prhs);
  else if (strcmp(name, "depth") == 0 && nrhs == 0) plhs[0] = mxCreateDoubleScalar(num_recordings);
  else if (strcmp(name, "end") == 0 && nrhs == 0) plhs[0] = end_recording();
  else if (strcmp(name, "drop") == 0 && nrhs == 1) {
    while (num_recordings > (int)mxGetScalar(prhs[0]) && num_recordings > 0) drop_recording();
  } else if (strcmp(name, "places") == 0 && nrhs == 1) plhs[0] = places_of(prhs[0]);
  else if (strcmp(name, "nodes") == 0 && nrhs == 1) plhs[0] = as_nodes(prhs[0]);
  else if (strcmp(name, "mtimes") == 0 && nrhs == 2) plhs[0] = multiply_matrices(prhs);
  else if (strcmp(name, "parameter") == 0 && nrhs == 2) plhs[0] = add_parameter(prhs);
  else if (strcmp(name, "table") == 0 && nrhs == 2) plhs[0] = add_table(prhs);
  else {
    op = find_operation(name);
    if (op < 0) return 0;
    plhs[0] = apply(op, nrhs, prhs);
  }
  return 1;
}
