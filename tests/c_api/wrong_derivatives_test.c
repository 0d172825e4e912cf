/* SPDX-License-Identifier: BSD-3-Clause
 *
 * The option check_derivatives: derivatives that contradict their functions are refused at the start, right ones are
 * not, and the check leaves no trace but the count of its calls.
 */
#include <math.h>
#include <string.h>

#include "nonlinear_pendulum.h"

/* ---- Linear problems --------------------------------------------------------------------------------------- */

/* x1' = x2, x2' = x3, 0 = x1 - sin t: mu = 2. */
enum { SIZE = 3 };

typedef struct {
  char function; /* whose derivatives are wrong; 0: none */
  int ignores_order, calls;
} linear_user;

static int E(double t, int order, double* matrix, void* user) {
  linear_user* u = (linear_user*)user;
  (void)t;
  u->calls++;
  if (order == 0 || (u->function == 'E' && u->ignores_order)) matrix[0] = matrix[1 + SIZE] = 1;
  return 0;
}
static int A(double t, int order, double* matrix, void* user) {
  linear_user* u = (linear_user*)user;
  (void)t;
  u->calls++;
  if (order == 0) matrix[SIZE] = matrix[1 + 2 * SIZE] = matrix[2] = 1;
  return 0;
}
static int f(double t, int order, double* vector, void* user) {
  linear_user* u = (linear_user*)user;
  u->calls++;
  vector[2] = -sin(t + order * acos(0.0));
  if (order == 1 && u->function == 'f') vector[2] = -vector[2]; /* a sign */
  return 0;
}

static sfdae_solver* linear(linear_user* user, const sfdae_options* options) {
  sfdae_solver* solver = NULL;
  sfdae_linear_problem problem;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = SIZE;
  problem.E = E;
  problem.A = A;
  problem.f = f;
  problem.user = user;
  CHECK_STATUS(sfdae_create_linear(&solver, &problem, options), SFDAE_OK);
  return solver;
}

static void linear_mistakes_are_named(void) {
  linear_user user = {'E', 1, 0};
  double x[SIZE] = {0, 1, 0};
  sfdae_solver* solver = linear(&user, NULL);
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_WRONG_DERIVATIVES);
  CHECK(strstr(sfdae_message(solver), "derivative 1 of E") && strstr(sfdae_message(solver), "1 supplied, 0 by") &&
        strstr(sfdae_message(solver), "check_derivatives"));
  CHECK(x[0] == 0 && x[1] == 1 && x[2] == 0);
  CHECK_STATUS(sfdae_analyze(solver, 0, 1, NULL), SFDAE_WRONG_DERIVATIVES);
  user.ignores_order = 0;
  CHECK_STATUS(sfdae_start(solver, 0, 1, x, NULL), SFDAE_OK);
  sfdae_destroy(&solver);

  user.function = 'f';
  solver = linear(&user, NULL);
  CHECK_STATUS(sfdae_start(solver, 0, -1, x, NULL), SFDAE_WRONG_DERIVATIVES);
  CHECK(strstr(sfdae_message(solver), "derivative 1 of f") &&
        strstr(sfdae_message(solver), "row 2, column 0 at t = 0") &&
        strstr(sfdae_message(solver), "1 supplied, -1 by"));
  CHECK_STATUS(sfdae_start(solver, 0, -1, x, NULL), SFDAE_WRONG_DERIVATIVES); /* there is no analysis to go on with */
  sfdae_destroy(&solver);
}

/* Everything but the calls is as without the check, in every bit. */
static void right_ones_leave_no_trace(void) {
  sfdae_options options;
  sfdae_statistics s[2];
  double x[2][SIZE], xdot[2][SIZE], t;
  int calls[2], k;
  sfdae_options_init(&options, sizeof options);
  CHECK(options.check_derivatives == 1);
  for (k = 0; k < 2; k++) {
    linear_user user = {0, 0, 0};
    sfdae_solver* solver;
    options.check_derivatives = k;
    solver = linear(&user, &options);
    x[k][0] = x[k][1] = x[k][2] = 0.5;
    CHECK_STATUS(sfdae_start(solver, 0, 1, x[k], xdot[k]), SFDAE_VALUES_CHANGED);
    CHECK_STATUS(sfdae_advance(solver, 1, &t, x[k], xdot[k]), SFDAE_OK);
    sfdae_statistics_init(&s[k], sizeof s[k]);
    CHECK_STATUS(sfdae_get_statistics(solver, &s[k]), SFDAE_OK);
    calls[k] = user.calls;
    CHECK(calls[k] == s[k].evaluations_E + s[k].evaluations_A + s[k].evaluations_f + s[k].check_calls);
    sfdae_destroy(&solver);
  }
  CHECK(memcmp(x[0], x[1], sizeof x[0]) == 0 && memcmp(xdot[0], xdot[1], sizeof xdot[0]) == 0);
  CHECK(s[0].check_calls == 0 && s[1].check_calls > 0);
  /* Three functions, orders 0 to mu + 1 = 3, beside t, and those that nobody has asked for at t: the last ones of E
   * and A, 1 to 3 of f. The start goes on with these. */
  CHECK(s[1].check_calls == 12 + 5);
  CHECK(calls[1] == calls[0] + 12);
  options.check_derivatives = 2;
  {
    linear_user user = {0, 0, 0};
    sfdae_solver* solver = NULL;
    sfdae_linear_problem problem;
    sfdae_linear_problem_init(&problem, sizeof problem);
    problem.num_equations = problem.num_unknowns = SIZE;
    problem.E = E, problem.A = A, problem.f = f, problem.user = &user;
    CHECK_STATUS(sfdae_create_linear(&solver, &problem, &options), SFDAE_ILLEGAL_ARGUMENT);
  }
}

/* ---- Total derivatives ------------------------------------------------------------------------------------- */

static struct {
  char function; /* 'F', 'x', 'd' or 0 */
  int order, row, column;
} total_mistake;

static int total(double t, int k, const double* jet, double* F, double* F_x, double* F_xdot, void* user) {
  pendulum_derivative(t, k, jet, F, F_x, F_xdot, user);
  if (k != total_mistake.order) return 0;
  if (total_mistake.function == 'F') F[total_mistake.row] += 0.5;
  if (total_mistake.function == 'x' && F_x) F_x[total_mistake.row + M * total_mistake.column] += 0.5;
  if (total_mistake.function == 'd' && F_xdot) F_xdot[total_mistake.row + M * total_mistake.column] += 0.5;
  return 0;
}

static int prescribed_force(double t, int order, double* values, void* user) {
  (void)order, (void)user;
  values[0] = force(t);
  return 0;
}

static int start_pendulum(char function, int order, int row, int column, char* message, size_t length) {
  sfdae_nonlinear_problem problem;
  sfdae_solver* solver = NULL;
  double x[N];
  int status;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = M;
  problem.num_unknowns = N;
  problem.total_derivative = total;
  problem.num_prescribed = 1;
  problem.prescribed = force_component;
  problem.prescribed_values = prescribed_force;
  total_mistake.function = function;
  total_mistake.order = order;
  total_mistake.row = row;
  total_mistake.column = column;
  CHECK_STATUS(sfdae_create_nonlinear(&solver, &problem, NULL), SFDAE_OK);
  exact(0.3, x);
  status = sfdae_start(solver, 0.3, 1, x, NULL);
  snprintf(message, length, "%s", sfdae_message(solver));
  sfdae_destroy(&solver);
  return status;
}

static void total_mistakes_are_named(void) {
  static const char* const names[] = {"derivative 1 of F contradicts differences in row 2, column 0",
                                      "derivative 0 of F_x contradicts differences in row 3, column 1",
                                      "derivative 0 of F_xdot contradicts differences in row 4, column 2"};
  char message[600];
  CHECK(start_pendulum(0, 0, 0, 0, message, sizeof message) >= 0);
  CHECK_STATUS(start_pendulum('F', 1, 2, 0, message, sizeof message), SFDAE_WRONG_DERIVATIVES);
  CHECK(strstr(message, names[0]));
  CHECK_STATUS(start_pendulum('x', 0, 3, 1, message, sizeof message), SFDAE_WRONG_DERIVATIVES);
  CHECK(strstr(message, names[1]));
}

/* ---- Multibody systems ------------------------------------------------------------------------------------- */

/* A chain of links from a point that moves by amplitude * sin(rate * t): positions of the ends, g_i of size weight. A
 * wheel condition on the first link: H v + h = 0. */
enum { LINKS = 3, NQ = 2 * LINKS };

typedef struct {
  double length[LINKS], weight[LINKS], amplitude, rate, mass;
  char function; /* 'G', 'T', 'C', 0: none */
  int row, column;
  double factor;
  int has_gamma;
} chain;

static double suspension(const chain* c, double t, int order) {
  return c->amplitude * pow(c->rate, order) * sin(c->rate * t + order * acos(0.0));
}

/* End of link i minus its beginning, and v alike. */
static void link_vector(const chain* c, double t, int order, const double* q, int i, double* d) {
  d[0] = q[2 * i] - (i > 0 ? q[2 * i - 2] : suspension(c, t, order));
  d[1] = q[2 * i + 1] - (i > 0 ? q[2 * i - 1] : 0);
}

static int chain_mass(double t, const double* q, double* result, void* user) {
  int i;
  (void)t, (void)q;
  for (i = 0; i < NQ; i++) result[i * (NQ + 1)] = ((const chain*)user)->mass;
  return 0;
}
static int chain_forces(double t, const double* q, const double* v, double* result, void* user) {
  const chain* c = (const chain*)user;
  int i;
  (void)t, (void)q, (void)v;
  for (i = 0; i < LINKS; i++) result[2 * i + 1] = -c->mass * c->length[0] * c->rate * c->rate;
  return 0;
}
static int chain_g(double t, const double* q, double* result, void* user) {
  const chain* c = (const chain*)user;
  double d[2];
  int i;
  for (i = 0; i < LINKS; i++) {
    link_vector(c, t, 0, q, i, d);
    result[i] = c->weight[i] * (d[0] * d[0] + d[1] * d[1] - c->length[i] * c->length[i]);
  }
  return 0;
}
static int chain_g_q(double t, const double* q, double* result, void* user) {
  const chain* c = (const chain*)user;
  double d[2];
  int i, k;
  for (i = 0; i < LINKS; i++) {
    link_vector(c, t, 0, q, i, d);
    for (k = 0; k < 2; k++) {
      result[i + LINKS * (2 * i + k)] = 2 * c->weight[i] * d[k];
      if (i > 0) result[i + LINKS * (2 * i - 2 + k)] = -2 * c->weight[i] * d[k];
    }
  }
  if (c->function == 'G') result[c->row + LINKS * c->column] *= c->factor;
  return 0;
}
static int chain_g_t(double t, const double* q, double* result, void* user) {
  const chain* c = (const chain*)user;
  double d[2];
  link_vector(c, t, 0, q, 0, d);
  result[0] = -2 * c->weight[0] * d[0] * suspension(c, t, 1);
  if (c->function == 'T') result[0] *= c->factor;
  return 0;
}
/* d^2/dt^2 |d|^2 without v' is 2 |d'|^2, and - 2 d_x u'' of the suspension. */
static int chain_gamma(double t, const double* q, const double* v, double* result, void* user) {
  const chain* c = (const chain*)user;
  double d[2], d1[2];
  int i;
  for (i = 0; i < LINKS; i++) {
    link_vector(c, t, 0, q, i, d);
    link_vector(c, t, 1, v, i, d1);
    result[i] = 2 * c->weight[i] * (d1[0] * d1[0] + d1[1] * d1[1]);
    if (i == 0) result[i] -= 2 * c->weight[i] * d[0] * suspension(c, t, 2);
    if (c->function == 'C' && i == c->row) result[i] *= c->factor;
  }
  return 0;
}

static double uniform(double low, double high) {
  static unsigned long state = 1;
  state = (state * 48271UL) % 2147483647UL;
  return low + (high - low) * ((double)state / 2147483647.0);
}

static chain random_chain(double* x, double* span, double* t) {
  chain c;
  const double unit = pow(10, uniform(-9, 9));
  int i;
  memset(&c, 0, sizeof c);
  *span = pow(10, uniform(-6, 6));
  *t = uniform(0, 1) < 0.3 ? 0 : *span * pow(10, uniform(-2, 3));
  c.rate = pow(10, uniform(-2, 2)) / *span;
  c.amplitude = uniform(0, 1) < 0.5 ? 0 : 0.3 * unit;
  c.mass = pow(10, uniform(-6, 6));
  c.has_gamma = uniform(0, 1) < 0.7;
  memset(x, 0, (2 * NQ + LINKS) * sizeof *x);
  for (i = 0; i < LINKS; i++) {
    const double angle = uniform(0, 6.283185307);
    c.length[i] = unit * uniform(0.2, 2);
    c.weight[i] = pow(10, uniform(-6, 6)) / (unit * unit);
    x[2 * i] = (i > 0 ? x[2 * i - 2] : suspension(&c, *t, 0)) + c.length[i] * cos(angle);
    x[2 * i + 1] = (i > 0 ? x[2 * i - 1] : 0) + c.length[i] * sin(angle);
  }
  return c;
}

static int start_chain(chain* c, double t, double span, const double* start, char* message, size_t length) {
  sfdae_multibody_problem problem;
  sfdae_solver* solver = NULL;
  sfdae_options options;
  double x[2 * NQ + LINKS];
  int status;
  sfdae_multibody_problem_init(&problem, sizeof problem);
  sfdae_options_init(&options, sizeof options);
  options.atol = 1e-6 * c->length[0];
  problem.num_positions = NQ;
  problem.num_constraints = LINKS;
  problem.mass = chain_mass;
  problem.forces = chain_forces;
  problem.constraints = chain_g;
  problem.constraint_jacobian = chain_g_q;
  if (c->amplitude != 0) problem.constraint_rate = chain_g_t;
  if (c->has_gamma) problem.constraint_curvature = chain_gamma;
  problem.user = c;
  CHECK_STATUS(sfdae_create_multibody(&solver, &problem, &options), SFDAE_OK);
  memcpy(x, start, sizeof x);
  status = sfdae_start(solver, t, t + span, x, NULL);
  snprintf(message, length, "%s", sfdae_message(solver));
  sfdae_destroy(&solver);
  return status;
}

static void right_chains_are_not_suspected(void) {
  int i;
  for (i = 0; i < 2000; i += stride(10)) {
    double x[2 * NQ + LINKS], span, t;
    char message[600];
    chain c = random_chain(x, &span, &t);
    const int status = start_chain(&c, t, span, x, message, sizeof message);
    CHECK(status != SFDAE_WRONG_DERIVATIVES);
    if (status == SFDAE_WRONG_DERIVATIVES) fprintf(stderr, "  chain %d: %s\n", i, message);
  }
}

/* A mistake of at least a tenth; one of an entry that vanishes is none. */
static void wrong_chains_are_found(void) {
  int i, tried = 0, found = 0, named = 0;
  for (i = 0; i < 1000; i += stride(10)) {
    static const double factors[] = {-1, 0, 2, 0.5, 1.1};
    double x[2 * NQ + LINKS], span, t;
    char message[600], name[80];
    chain c = random_chain(x, &span, &t);
    c.function = "GGGTC"[i % 5];
    c.factor = factors[(int)uniform(0, 4.999)];
    c.row = (int)uniform(0, LINKS - 0.001);
    c.column = 2 * c.row + (int)uniform(0, 1.999) - (c.row > 0 && uniform(0, 1) < 0.5 ? 2 : 0);
    if (c.function == 'T' && c.amplitude == 0) c.amplitude = 0.3 * c.length[0];
    if (c.function == 'T') x[0] += suspension(&c, t, 0), x[2] += suspension(&c, t, 0), x[4] += suspension(&c, t, 0);
    if (c.function == 'T') c.row = 0;
    if (c.function == 'C') c.has_gamma = 1;
    tried++;
    if (start_chain(&c, t, span, x, message, sizeof message) != SFDAE_WRONG_DERIVATIVES) continue;
    found++;
    snprintf(name, sizeof name, "%s contradicts differences in row %d, column %d",
             c.function == 'G'   ? "constraint_jacobian (g_q)"
             : c.function == 'T' ? "constraint_rate (g_t)"
                                 : "constraint_curvature (gamma)",
             c.row, c.function == 'G' ? c.column : 0);
    if (strstr(message, name)) named++;
    else fprintf(stderr, "  %s instead of: %s\n", message, name);
  }
  printf("%d of %d wrong derivatives of chains found, %d by name\n", found, tried, named);
  CHECK(found >= 0.95 * tried);
  CHECK(named >= 0.99 * found);
}

int main(void) {
  linear_mistakes_are_named();
  right_ones_leave_no_trace();
  total_mistakes_are_named();
  right_chains_are_not_suspected();
  wrong_chains_are_found();
  return failures != 0;
}
