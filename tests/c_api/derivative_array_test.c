/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The derivative array as one function: the same solution as with total derivatives order by order, in the same number
 * of points; which orders are requested; errors in the Jacobian, in the arguments and of the function.
 */
#include "nonlinear_pendulum.h"

#define TOL 1e-6
enum { MOST = 4 }; /* highest order of an array here */

typedef struct {
  long calls, with_jacobian;
  int highest, available; /* order: requested; the highest that is available */
  int row, column;        /* of an entry that is changed, if the array has it; row < 0: none */
  double change;
  int code;
} array_data;

static array_data good(void) {
  array_data data = {0, 0, 0, MOST, -1, -1, 0, 0};
  return data;
}

static double binomial(int k, int j) {
  double product = 1;
  int r;
  if (j < 0 || j > k) return 0;
  for (r = 0; r < j; r++) product = product * (k - r) / (r + 1);
  return product;
}

/* The array of m = M equations in n = N unknowns from the derivatives order by order. */
static int pendulum_array(double t, int order, const double* jet, double* F, double* jacobian, void* user) {
  static double F_x[MOST + 1][M * N], F_xdot[MOST + 1][M * N];
  array_data* data = (array_data*)user;
  const int rows = (order + 1) * M;
  int k, j, i, c;
  data->calls++;
  if (jacobian) data->with_jacobian++;
  if (order > data->highest) data->highest = order;
  for (i = 0; i < rows; i++) CHECK(F[i] == 0);
  for (i = 0; jacobian && i < rows * (order + 2) * N; i++) CHECK(jacobian[i] == 0);
  if (order > data->available) return SFDAE_ORDER_NOT_AVAILABLE;
  if (data->code) return data->code;
  memset(F_x, 0, sizeof F_x);
  memset(F_xdot, 0, sizeof F_xdot);
  for (k = 0; k <= order; k++)
    pendulum_derivative(t, k, jet, F + k * M, jacobian ? F_x[k] : NULL, jacobian ? F_xdot[k] : NULL, NULL);
  for (k = 0; jacobian && k <= order; k++)
    for (j = 0; j <= k + 1; j++)
      for (c = 0; c < N; c++)
        for (i = 0; i < M; i++)
          jacobian[k * M + i + rows * (j * N + c)] = (j <= k ? binomial(k, j) * F_x[k - j][i + M * c] : 0) +
                                                     (j > 0 ? binomial(k, j - 1) * F_xdot[k - j + 1][i + M * c] : 0);
  if (jacobian && data->row >= 0 && data->row < rows && data->column < (order + 2) * N)
    jacobian[data->row + rows * data->column] += data->change;
  return 0;
}

static sfdae_nonlinear_problem array_pendulum(array_data* data) {
  sfdae_nonlinear_problem problem = pendulum_problem();
  problem.derivative_array = pendulum_array;
  problem.user = data;
  return problem;
}

static sfdae_options options_for(int method) {
  sfdae_options options = default_options();
  options.method = method;
  options.rtol = options.atol = TOL;
  return options;
}

/* x, x' and the number of steps; the problem has no function but this. */
static long run(const sfdae_nonlinear_problem* problem, int method, double* x, double* xdot) {
  const sfdae_options options = options_for(method);
  sfdae_solver* solver = CREATE(problem, &options);
  sfdae_statistics statistics;
  double t = 0;
  int k;
  exact(0, x);
  x[4] = 0; /* a guess */
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, xdot), SFDAE_OK);
  for (k = 1; k <= 3; k++) CHECK_STATUS(sfdae_advance(solver, 0.4 * k, &t, x, xdot), SFDAE_OK);
  sfdae_statistics_init(&statistics, sizeof statistics);
  CHECK_STATUS(sfdae_get_statistics(solver, &statistics), SFDAE_OK);
  sfdae_destroy(&solver);
  return statistics.steps;
}

/* F_x' is constant: all bits are the same. */
static void all_bits_are_those_of_total_derivatives(int method) {
  array_data data = good();
  const sfdae_nonlinear_problem by_array = array_pendulum(&data), by_order = differentiated_pendulum();
  double x[N], xdot[N], x_by_order[N], xdot_by_order[N];
  CHECK(run(&by_array, method, x, xdot) == run(&by_order, method, x_by_order, xdot_by_order));
  CHECK(memcmp(x, x_by_order, sizeof x) == 0);
  CHECK(memcmp(xdot, xdot_by_order, sizeof xdot) == 0);
  CHECK(accurate(1.2, x, TOL) && violation(x) < 1e-12);
  CHECK(data.highest == 3); /* mu + 1 */
  CHECK(data.with_jacobian > 0 && data.with_jacobian < data.calls);
}

static void the_order_above_mu_need_not_be_available(int method) {
  array_data data = good();
  const sfdae_nonlinear_problem problem = array_pendulum(&data);
  const sfdae_options options = options_for(method);
  double x[N], xdot[N];
  sfdae_solver* solver;
  data.available = 2;
  run(&problem, method, x, xdot);
  CHECK(accurate(1.2, x, TOL) && violation(x) < 1e-12);
  data.available = 1;
  solver = CREATE(&problem, &options);
  guard(x, sizeof x);
  exact(0, x);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_ORDER_MISSING);
  CHECK(strstr(sfdae_message(solver), "order 2") != NULL);
  sfdae_destroy(&solver);
}

/* Every entry of the blocks that follow from others; then the solver works with the right array. */
static void contradictions_are_named(int method) {
  static const struct {
    int row, column;
    const char* message;
  } entries[] = {
      {10, 15, "row 10, column 15 of the Jacobian of the derivative array of order"},
      {3, 14, "row 3, column 14"},
      {12, 16, "is 0.001, but the blocks for F_x and F_x' require 0"},
      {12, 16,
       "the derivative of order 2 of equation 2 (force) with respect to the derivative of order 2 of unknown 4"},
  };
  const char* const names[M] = {"", "", "force", "", ""};
  size_t i;
  for (i = 0; i < sizeof entries / sizeof *entries; i++) {
    array_data data = good();
    sfdae_nonlinear_problem problem = array_pendulum(&data);
    const sfdae_options options = options_for(method);
    sfdae_solver* solver;
    double x[N], x_before[N], xdot[N];
    problem.equation_names = names;
    solver = CREATE(&problem, &options);
    data.row = entries[i].row, data.column = entries[i].column, data.change = 1e-3;
    exact(0, x);
    if (i >= 2) x[0] = 0, x[1] = -1; /* the entry is x1 */
    memcpy(x_before, x, sizeof x);
    guard(xdot, sizeof xdot);
    CHECK_STATUS(sfdae_start(solver, 0, 1, x, xdot), SFDAE_WRONG_DERIVATIVES);
    if (strstr(sfdae_message(solver), entries[i].message) == NULL)
      failures++, fprintf(stderr, "%s: not in: %s\n", entries[i].message, sfdae_message(solver));
    CHECK(memcmp(x, x_before, sizeof x) == 0 && guarded(xdot, sizeof xdot));
    data.row = -1;
    CHECK(sfdae_start(solver, 0, 1, x, xdot) >= 0);
    sfdae_destroy(&solver);
  }
}

/* Within a step: the last point is returned, and the integration continues once the array is right. */
static void contradictions_end_an_integration(int method) {
  array_data data = good();
  const sfdae_nonlinear_problem problem = array_pendulum(&data);
  const sfdae_options options = options_for(method);
  sfdae_solver* solver = CREATE(&problem, &options);
  double x[N], t = 0;
  exact(0, x);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 0.3, &t, x, NULL), SFDAE_OK);
  data.row = 0, data.column = 13, data.change = 1e-2;
  CHECK_STATUS(sfdae_advance(solver, 2, &t, x, NULL), SFDAE_WRONG_DERIVATIVES);
  CHECK(t >= 0.3 && t < 2 && accurate(t, x, TOL));
  data.row = -1;
  CHECK_STATUS(sfdae_advance(solver, 2, &t, x, NULL), SFDAE_OK);
  CHECK(t == 2 && accurate(t, x, TOL));
  sfdae_destroy(&solver);
}

static void failures_of_the_function_are_those_of_other_callbacks(void) {
  static const int codes[] = {1, -7, SFDAE_ORDER_NOT_AVAILABLE};
  static const int statuses[] = {SFDAE_CALLBACK_FAILED, SFDAE_CALLBACK_STOPPED, SFDAE_ORDER_MISSING};
  int i;
  for (i = 0; i < 4; i++) {
    array_data data = good();
    const sfdae_nonlinear_problem problem = array_pendulum(&data);
    sfdae_solver* solver = CREATE(&problem, NULL);
    double x[N];
    exact(0, x);
    if (i < 3) data.code = codes[i];
    else data.row = 2, data.column = 3, data.change = HUGE_VAL;
    CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), i < 3 ? statuses[i] : SFDAE_NOT_FINITE);
    if (i == 3) CHECK(strstr(sfdae_message(solver), "row 2, column 3") != NULL);
    sfdae_destroy(&solver);
  }
}

/* Jacobians of finite differences, with values alone: x' + x^2 = 0, x = 1 / (1 + t). */
static int decay_values(double t, int order, const double* jet, double* F, double* jacobian, void* user) {
  (void)t, (void)user;
  CHECK(jacobian == NULL);
  if (order > 0) return SFDAE_ORDER_NOT_AVAILABLE;
  F[0] = jet[1] + jet[0] * jet[0];
  return 0;
}

static void values_alone_suffice_for_index_zero(void) {
  sfdae_nonlinear_problem problem;
  sfdae_options options = default_options();
  sfdae_solver* solver;
  double x = 1, t = 0;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  CHECK(problem.derivative_array == NULL);
  problem.num_equations = problem.num_unknowns = 1;
  problem.derivative_array = decay_values;
  problem.matrices = SFDAE_MATRICES_DIFFERENCES;
  options.check_derivatives = 0;
  solver = CREATE(&problem, &options);
  CHECK_STATUS(sfdae_start(solver, 0, 1, &x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, &x, NULL), SFDAE_OK);
  CHECK(fabs(x - 0.5) < 1e-5);
  sfdae_destroy(&solver);
}

/* A source v = 2 + sin t charges a capacitor with the charge q = v^2: q' = i, q = v^2, v = 2 + sin t; mu = 1. */
static int charging(double t, int order, const double* x, double* F, double* jacobian, void* user) {
  const int rows = 3 * (order + 1);
  int k, l;
  (void)user;
  for (k = 0; k <= order; k++) {
    F[3 * k] = x[3 * k + 4] - x[3 * k + 2];
    F[3 * k + 1] = x[3 * k + 1];
    F[3 * k + 2] = x[3 * k] - (k == 0 ? 2 : 0) - sin(t + k * acos(0.0));
    for (l = 0; l <= k; l++) F[3 * k + 1] -= binomial(k, l) * x[3 * l] * x[3 * (k - l)];
    if (!jacobian) continue;
    jacobian[3 * k + rows * (3 * k + 4)] = jacobian[3 * k + 1 + rows * (3 * k + 1)] = 1;
    jacobian[3 * k + rows * (3 * k + 2)] = -1;
    jacobian[3 * k + 2 + rows * (3 * k)] = 1;
    for (l = 0; l <= k; l++) jacobian[3 * k + 1 + rows * (3 * l)] = -2 * binomial(k, l) * x[3 * (k - l)];
  }
  return 0;
}

static void patterns_give_the_structure(void) {
  static const int x_start[] = {0, 2, 3, 4}, x_rows[] = {1, 2, 1, 0}, xdot_start[] = {0, 0, 1, 1}, xdot_rows[] = {0};
  static const int too_few[] = {0, 1, 2, 3}, too_few_rows[] = {1, 1, 0};
  sfdae_nonlinear_problem problem;
  sfdae_options options = default_options();
  sfdae_structure structure;
  sfdae_solver* solver;
  double x[3] = {2, 4, 0}, t = 0;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 3;
  problem.derivative_array = charging;
  problem.F_x_entries = 4, problem.F_x_col_start = x_start, problem.F_x_row_index = x_rows;
  problem.F_xdot_entries = 1, problem.F_xdot_col_start = xdot_start, problem.F_xdot_row_index = xdot_rows;
  options.structure = SFDAE_STRUCTURE_REQUIRED;
  solver = CREATE(&problem, &options);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, x, NULL), SFDAE_OK);
  CHECK(fabs(x[2] - 2 * (2 + sin(1.0)) * cos(1.0)) < 1e-10);
  sfdae_structure_init(&structure, sizeof structure);
  CHECK_STATUS(sfdae_get_structure(solver, &structure, NULL, NULL, NULL, NULL), SFDAE_OK);
  CHECK(structure.is_followed == 1 && structure.index_bound == 1 && structure.freedom == 0);
  sfdae_destroy(&solver);

  problem.F_x_entries = 3, problem.F_x_col_start = too_few, problem.F_x_row_index = too_few_rows;
  solver = CREATE(&problem, NULL);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_WRONG_PATTERN);
  sfdae_destroy(&solver);
}

/* x' = 1 from t = 1/2 on, -1 before. */
static int branch;
static int turning(double t, int order, const double* x, double* F, double* jacobian, void* user) {
  int k;
  (void)t, (void)user;
  for (k = 0; k <= order; k++) {
    F[k] = x[k + 1] - (k == 0 ? (branch ? 1 : -1) : 0);
    if (jacobian) jacobian[k + (order + 1) * (k + 1)] = 1;
  }
  return 0;
}
static int after_half(double t, const double* x, const double* xdot, double* g, void* user) {
  (void)x, (void)xdot, (void)user;
  g[0] = t - 0.5;
  return 0;
}

static void conditions_select_branches(void) {
  sfdae_nonlinear_problem problem;
  sfdae_solver* solver;
  double x = 0, t = 0;
  long count = 0;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = problem.num_conditions = 1;
  problem.derivative_array = turning;
  problem.conditions = after_half;
  problem.branches = &branch;
  solver = CREATE(&problem, NULL);
  CHECK_STATUS(sfdae_start(solver, 0, 1, &x, NULL), SFDAE_OK);
  CHECK_STATUS(sfdae_advance(solver, 1, &t, &x, NULL), SFDAE_OK);
  CHECK(fabs(x) < 1e-9);
  CHECK_STATUS(sfdae_get_num_switches(solver, &count), SFDAE_OK);
  CHECK(count == 1);
  sfdae_destroy(&solver);
}

static void expect_refusal(const sfdae_nonlinear_problem* problem, const char* message) {
  char text[400];
  CHECK_STATUS(sfdae_check_nonlinear(problem, NULL, text, sizeof text), SFDAE_ILLEGAL_ARGUMENT);
  if (strstr(text, message) == NULL) failures++, fprintf(stderr, "%s: not in: %s\n", message, text);
}

static void arguments_are_checked(void) {
  static const int starts[N + 1] = {0, 1, 1, 1, 1, 1, 1}, rows[1] = {0};
  array_data data = good();
  sfdae_nonlinear_problem problem = array_pendulum(&data);
  problem.total_derivative = pendulum_derivative;
  expect_refusal(&problem, "2 of the functions equations, linear_equations, total_derivative and derivative_array");
  problem.total_derivative = NULL;
  problem.F_x_entries = problem.F_xdot_entries = 1;
  problem.F_x_col_start = problem.F_xdot_col_start = starts;
  problem.F_x_row_index = problem.F_xdot_row_index = rows;
  problem.matrices = SFDAE_MATRICES_COMPRESSED;
  expect_refusal(&problem, "derivative_array writes all entries of its Jacobian");
  problem.derivative_array = NULL;
  expect_refusal(&problem, "0 of the functions");
  CHECK(data.calls == 0);
}

/* The comparison with finite differences reads the blocks. */
static void derivatives_are_compared(void) {
  array_data data = good();
  const sfdae_nonlinear_problem problem = array_pendulum(&data);
  sfdae_solver* solver = CREATE(&problem, NULL);
  sfdae_derivative_check check;
  double jet[4 * N];
  int i;
  for (i = 0; i < 4 * N; i++) jet[i] = cos(1.0 + i);
  sfdae_derivative_check_init(&check, sizeof check);
  CHECK_STATUS(sfdae_check_total_derivatives(solver, 0.3, jet, 2, &check), SFDAE_OK);
  CHECK(check.suspicious == 0);
  /* An error that the blocks do not show: F_x of order 2 */
  data.row = 2 * M + 3, data.column = 1, data.change = 0.1;
  CHECK_STATUS(sfdae_check_total_derivatives(solver, 0.3, jet, 2, &check), SFDAE_OK);
  CHECK(check.suspicious == 1 && check.function == 'x' && check.order == 2 && check.row == 3 && check.column == 1);
  sfdae_destroy(&solver);
}

static void blocks_are_split(void) {
  enum { ORDER = 2, ROWS = (ORDER + 1) * M, COLUMNS = (ORDER + 2) * N, ENTRIES = M * N * (ORDER + 1) };
  static double jet[COLUMNS], F[ROWS], J[ROWS * COLUMNS], F_x[ENTRIES], F_xdot[ENTRIES];
  array_data data = good();
  char text[300];
  int i, k;
  for (i = 0; i < COLUMNS; i++) jet[i] = sin(1.0 + i);
  pendulum_array(0, ORDER, jet, F, J, &data);
  CHECK_STATUS(sfdae_split_derivative_array(M, N, ORDER, J, F_x, F_xdot, text, sizeof text), SFDAE_OK);
  CHECK(text[0] == '\0');
  for (k = 0; k <= ORDER; k++) {
    double values[M] = {0}, of_x[M * N] = {0}, of_xdot[M * N] = {0};
    pendulum_derivative(0, k, jet, values, of_x, of_xdot, NULL);
    CHECK(memcmp(of_x, F_x + k * M * N, sizeof of_x) == 0);
    for (i = 0; i < M * N; i++) CHECK(of_xdot[i] == F_xdot[i + k * M * N]);
  }
  guard(F_x, sizeof F_x), guard(F_xdot, sizeof F_xdot);
#define REFUSED(m, n, order, a, b, c, status) \
  CHECK_STATUS(sfdae_split_derivative_array(m, n, order, a, b, c, text, sizeof text), status)
  J[3 + ROWS * 14] = 1e-3;
  REFUSED(M, N, ORDER, J, F_x, F_xdot, SFDAE_WRONG_DERIVATIVES);
  CHECK(strstr(text, "row 3, column 14") == text && strstr(text, "require 0") != NULL);
  J[3 + ROWS * 14] = HUGE_VAL;
  REFUSED(M, N, ORDER, J, F_x, F_xdot, SFDAE_NOT_FINITE);
  REFUSED(0, N, ORDER, J, F_x, F_xdot, SFDAE_ILLEGAL_ARGUMENT);
  REFUSED(M, 5001, ORDER, J, F_x, F_xdot, SFDAE_ILLEGAL_ARGUMENT);
  REFUSED(M, N, -1, J, F_x, F_xdot, SFDAE_ILLEGAL_ARGUMENT);
  REFUSED(M, N, 14, J, F_x, F_xdot, SFDAE_ILLEGAL_ARGUMENT);
  CHECK(strstr(text, "order = 14") != NULL);
  REFUSED(M, N, ORDER, NULL, F_x, F_xdot, SFDAE_ILLEGAL_ARGUMENT);
  REFUSED(M, N, ORDER, J, NULL, F_xdot, SFDAE_ILLEGAL_ARGUMENT);
  REFUSED(M, N, ORDER, J, F_x, NULL, SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_split_derivative_array(M, N, ORDER, J, F_x, F_xdot, NULL, 1), SFDAE_ILLEGAL_ARGUMENT);
  CHECK_STATUS(sfdae_split_derivative_array(M, N, ORDER, J, F_x, F_xdot, NULL, 0), SFDAE_NOT_FINITE);
#undef REFUSED
  CHECK(guarded(F_x, sizeof F_x) && guarded(F_xdot, sizeof F_xdot));
}

/* Rounding errors of a sum are not taken for F_x', and are no contradiction: J_k1 = k F_x^(k-1) + F_x'^(k). */
static void rounding_errors_are_no_derivatives(void) {
  double J[2 * 3] = {0}, F_x[2], F_xdot[2];
  J[0] = 0.1 + 0.2;   /* F_x */
  J[1] = 5;           /* F_x^(1) */
  J[0 + 2 * 1] = 2;   /* F_x' */
  J[1 + 2 * 1] = 0.3; /* F_x + F_x'^(1) */
  J[1 + 2 * 2] = 2;   /* F_x' */
  CHECK(J[0] != J[3]);
  CHECK_STATUS(sfdae_split_derivative_array(1, 1, 1, J, F_x, F_xdot, NULL, 0), SFDAE_OK);
  CHECK(F_x[0] == 0.1 + 0.2 && F_x[1] == 5 && F_xdot[0] == 2 && F_xdot[1] == 0);
  J[1 + 2 * 1] = 1;
  CHECK_STATUS(sfdae_split_derivative_array(1, 1, 1, J, F_x, F_xdot, NULL, 0), SFDAE_OK);
  CHECK(F_xdot[1] == 1 - (0.1 + 0.2));
}

int main(void) {
  static const int methods[] = {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU};
  int i;
  for (i = 0; i < 2; i++) {
    all_bits_are_those_of_total_derivatives(methods[i]);
    the_order_above_mu_need_not_be_available(methods[i]);
    contradictions_are_named(methods[i]);
    contradictions_end_an_integration(methods[i]);
  }
  failures_of_the_function_are_those_of_other_callbacks();
  values_alone_suffice_for_index_zero();
  patterns_give_the_structure();
  conditions_select_branches();
  arguments_are_checked();
  derivatives_are_compared();
  blocks_are_split();
  rounding_errors_are_no_derivatives();
  return failures != 0;
}
