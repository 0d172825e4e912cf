/* SPDX-License-Identifier: BSD-3-Clause
 *
 * Declarations shared by the sources of sfdae_mex, the function that the package for Octave and MATLAB calls.
 *
 * Two rules keep errors from leaking solvers: (1) arguments are read completely before a solver is created, so refuse()
 * may be called there; (2) afterward nothing raises an error: results have a status and a message. */
#ifndef SFDAE_MEX_H
#define SFDAE_MEX_H

#include <mex.h>

#include <sfdae/modes.h>

/* ---- arguments.c: checked conversion of arguments --------------------------------------------- */

/** Raises an error with the identifier sfdae:illegal_argument. */
void refuse(const char* format, ...);

/** A field of a struct, NULL if it is missing or empty. */
const mxArray* field_of(const mxArray* from, const char* name);

/** A finite or infinite number in the field, or `missing`. */
double number_in(const mxArray* from, const char* name, double missing);

/** A whole number in the field, or `missing`. */
long integer_in(const mxArray* from, const char* name, long missing);

/** A copy of `count` real numbers in the field; NULL if it is missing or empty. */
double* numbers_in(const mxArray* from, const char* name, size_t count);

/** A copy of whole numbers in the field, `offset` subtracted from each; NULL if it is missing or empty. */
int* integers_in(const mxArray* from, const char* name, size_t count, int offset);

/** Number of elements of the field, 0 if it is missing. */
size_t length_of(const mxArray* from, const char* name);

/** The function handle in the field, or NULL. */
const mxArray* handle_in(const mxArray* from, const char* name);

/** A copy of the text in the field, "" if it is missing. */
char* text_in(const mxArray* from, const char* name);

/** Copies of the texts of a cell array in the field; *count: their number. NULL if it is missing or empty. */
const char** texts_in(const mxArray* from, const char* name, int* count);

/* ---- tape.c: recorded formulas ---------------------------------------------------------------- */

/** Handles the command `name` of a recording; returns 0 if there is no such command. */
int tape_command(const char* name, int nlhs, mxArray* plhs[], int nrhs, const mxArray* prhs[]);

/** Formulas, read from the struct that the end of a recording returned. */
typedef struct tape {
  int count;
  const int *op, *a, *b, *c; /**< operation and operands of each node */
  const double* value;
  const char** names; /**< of parameters */
  int num_names;
  struct tape_table {
    int degree, count;
    const double *x, *y;
  } * tables;
  int num_tables;
} tape;

/** Variables of formulas; x and xdot are q and v in mechanical systems. */
typedef struct tape_inputs {
  sfdae_record* record;
  sfdae_expression t;
  const sfdae_expression *x, *xdot;
} tape_inputs;

/** Reads and checks formulas with num_x and num_xdot variables. */
tape read_tape(const mxArray* from, int num_x, int num_xdot);

/** Reads `count` numbers of nodes, from 0, in the field; -1 for "not written"; NULL if the field is missing. */
const int* read_nodes(const mxArray* from, const char* name, const tape* formulas, size_t count);

/** Computes all nodes, tape.count expressions. The caller frees them with free(). NULL: out of memory. */
sfdae_expression* replay(const tape* formulas, const tape_inputs* inputs);

/* ---- callbacks.c: calls of the user's functions ----------------------------------------------- */

/** The calls of one solver. */
typedef struct calls {
  int is_calling;    /**< 1 while a function runs, and if it was left without returning */
  int has_exception; /**< the function raised an error, which sfdae_callback_error_ stores */
  char message[600]; /**< a result that cannot be used; "" if there is none */
} calls;

/** Calls a function with `nin` arguments, which are destroyed, for `nout` results. Returns 0, 1 (it asks for a smaller
 * step) or -1; the results exist only after 0. */
int call_function(calls* state, const mxArray* function, int nout, mxArray** out, int nin, mxArray** in);

/** Copies a result of size rows x columns, or a vector of that many numbers, and destroys it. Returns 0 or -1. */
int take_numbers(calls* state, mxArray* result, size_t rows, size_t columns, const char* name, double* numbers);

/** A column of numbers, to be passed to a function. */
mxArray* column_of(const double* numbers, size_t count);

/* ---- problem.c: problems ---------------------------------------------------------------------- */

/** A problem as the library receives it, with what its callbacks read. */
typedef struct problem {
  int num_unknowns, num_equations;
  enum { LINEAR, NONLINEAR, MULTIBODY } kind;
  union {
    sfdae_linear_problem linear;
    sfdae_nonlinear_problem nonlinear;
    sfdae_multibody_problem multibody;
  } as;
  calls* calls; /**< set by open_solver */
  tape formulas;
  const int* outputs[6]; /**< nodes of F; of E, A, f; or of M, f, g, S, H, h */
  const mxArray* functions[10];
  const mxArray *prescribed_values, *events, *monitor;
  int event_outputs; /**< 1, or 3: value, isterminal, direction */
  int num_prescribed, num_events, num_positions, num_velocities, num_constraints, num_nonholonomic;
} problem;

/** Reads a problem into memory that lives as long as the call of sfdae_mex. */
problem* read_problem(const mxArray* from);

/** Creates its solver. */
int create_solver(const problem* p, const sfdae_options* options, sfdae_solver** solver);

/** Functions that the library calls; user: a problem. */
int call_equations(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                   sfdae_expression* residual, void* user);
int call_linear_equations(sfdae_record* record, sfdae_expression t, sfdae_expression* E, sfdae_expression* A,
                          sfdae_expression* f, void* user);
int call_multibody_equations(sfdae_record* record, sfdae_expression t, const sfdae_expression* q,
                             const sfdae_expression* v, const sfdae_multibody_formulas* formulas, void* user);
int call_events(double t, const double* x, const double* xdot, double* g, void* user);
int call_monitor(const sfdae_progress* progress, void* user);

/* ---- options.c -------------------------------------------------------------------------------- */

/** Reads the options of a problem of n unknowns into memory that lives as long as the call of sfdae_mex. */
sfdae_options* read_options(const mxArray* from, int n);

/** Names, kinds and choices of all options: {name, kind, {choice, ...}; ...}. */
mxArray* list_options(void);

/* ---- interrupt.c: Ctrl-C ----------------------------------------------------------------------- */

/** From now on Ctrl-C stops the solver; a second Ctrl-C interrupts the function that it calls. */
void begin_interruptible(sfdae_solver* solver);

/** Ends what begin_interruptible began. Returns 1 if Ctrl-C was pressed. */
int end_interruptible(void);

/** 1 if Ctrl-C was pressed since begin_interruptible. */
int was_interrupted(void);

/* ---- solvers.c: solvers that exist ------------------------------------------------------------- */

/** Creates the solver of a problem. It is destroyed by close_solver, or by the next call of sfdae_mex if an error has
 * ended this one. */
int open_solver(problem* p, const sfdae_options* options, sfdae_solver** solver);
void close_solver(sfdae_solver** solver);
void close_abandoned_solvers(void);

/* ---- results.c: structs of results ------------------------------------------------------------- */

/** Sets a field, which is added if it is missing. */
void set_field(mxArray* result, const char* name, mxArray* value);
void set_number(mxArray* result, const char* name, double value);
/** A row x column matrix with a copy of the numbers (NULL: zeros). */
mxArray* matrix_of(const double* numbers, size_t rows, size_t columns);
mxArray* new_struct(void);

/** Status, its name, the message (NULL: that of the solver or of the creation) and how callbacks ended. */
void set_status(mxArray* result, const problem* p, const sfdae_solver* solver, int status, const char* message);
mxArray* characteristics_of(const sfdae_solver* solver);
mxArray* statistics_of(const sfdae_solver* solver);
mxArray* decisions_of(const sfdae_solver* solver);
mxArray* structure_of(sfdae_solver* solver, int n);
mxArray* initial_report_of(const sfdae_solver* solver);
mxArray* report_of(const sfdae_solver* solver);

/** The switches of the integration under way, added to those in `earlier` (NULL: none), which is destroyed. */
mxArray* switches_of(const sfdae_solver* solver, mxArray* earlier);

/* ---- Commands ------------------------------------------------------------------------------------ */

mxArray* solve_command(const mxArray* p, const mxArray* options, const mxArray* run);  /* run.c */
mxArray* analyze_command(const mxArray* p, const mxArray* options, const mxArray* at); /* points.c */
mxArray* consistent_command(const mxArray* p, const mxArray* options, const mxArray* at);
mxArray* linearize_command(const mxArray* p, const mxArray* options, const mxArray* at); /* linearize.c */
mxArray* descriptor_command(const mxArray* matrices, const mxArray* request);
mxArray* evaluate_command(const mxArray* solution, const mxArray* times); /* dense.c */

#endif
