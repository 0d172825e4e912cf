// SPDX-License-Identifier: BSD-3-Clause
#include "linear_problem.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "extent.h"

namespace campaign {

LinearCallbacks::LinearCallbacks(const LinearProblem& problem) : problem_(problem) {}

sfdae_linear_problem LinearCallbacks::c_problem() {
  sfdae_linear_problem result;
  sfdae_linear_problem_init(&result, sizeof result);
  result.num_equations = problem_.m;
  result.num_unknowns = problem_.n;
  result.E = write_E;
  result.A = write_A;
  if (problem_.inhomogeneity) result.f = write_f;
  result.constant_E = problem_.constant ? 1 : 0;
  result.constant_A = problem_.constant ? 1 : 0;
  result.user = this;
  return result;
}

int LinearCallbacks::write_E(double t, int order, double* matrix, void* user) {
  return static_cast<LinearCallbacks*>(user)->write_matrix(t, order, true, matrix);
}

int LinearCallbacks::write_A(double t, int order, double* matrix, void* user) {
  return static_cast<LinearCallbacks*>(user)->write_matrix(t, order, false, matrix);
}

int LinearCallbacks::write_f(double t, int order, double* vector, void* user) {
  return static_cast<LinearCallbacks*>(user)->write_vector(t, order, vector);
}

void LinearCallbacks::evaluate_matrices(double t, int order) {
  if (evaluated_order_ >= order && t == t_) return;
  E_ = TaylorMatrix(problem_.m, problem_.n);
  A_ = TaylorMatrix(problem_.m, problem_.n);
  // What an analysis asks for, at once.
  evaluated_order_ = problem_.constant ? 0 : std::min(std::max(order, 5), problem_.available_order);
  problem_.coefficients(t / problem_.units.time, evaluated_order_, E_, A_);
  t_ = t;
}

namespace {

// What a Taylor coefficient of that order becomes as a derivative with respect to t = T s.
double derivative_factor(int order, double T) {
  double factor = 1.0;
  for (int k = 1; k <= order; ++k) factor *= k / T;
  return factor;
}

}  // namespace

// E dx/ds = A x + f(s) is T E dx/dt = A x + f(t / T).
int LinearCallbacks::write_matrix(double t, int order, bool is_E, double* matrix) {
  if (order > problem_.available_order) return SFDAE_ORDER_NOT_AVAILABLE;
  evaluate_matrices(t, order);
  const Units& units = problem_.units;
  const double factor = derivative_factor(order, units.time) * (is_E ? units.time : 1.0);
  const TaylorMatrix& source = is_E ? E_ : A_;
  for (int j = 0; j < problem_.n; ++j) {
    for (int i = 0; i < problem_.m; ++i) {
      const double entry = coefficient(source(i, j), order);
      if (entry == 0.0) continue;
      const double scale = units.rows[static_cast<std::size_t>(i)] * units.unknowns[static_cast<std::size_t>(j)];
      matrix[i + j * problem_.m] = entry * scale * factor;
    }
  }
  return 0;
}

int LinearCallbacks::write_vector(double t, int order, double* vector) {
  if (order > problem_.available_order) return SFDAE_ORDER_NOT_AVAILABLE;
  if (!f_evaluated_ || t != t_of_f_) {
    f_.assign(static_cast<std::size_t>(problem_.m), TaylorSeries{});
    problem_.inhomogeneity(t / problem_.units.time, problem_.available_order, f_);
    t_of_f_ = t;
    f_evaluated_ = true;
  }
  const double factor = derivative_factor(order, problem_.units.time);
  for (int i = 0; i < problem_.m; ++i) {
    const auto row = static_cast<std::size_t>(i);
    vector[i] = coefficient(f_[row], order) * problem_.units.rows[row] * factor;
  }
  return 0;
}

Solver::Solver(LinearCallbacks& callbacks, const sfdae_options& options) {
  const sfdae_linear_problem problem = callbacks.c_problem();
  if (sfdae_create_linear(&handle_, &problem, &options) == SFDAE_OK) return;
  char text[400];
  sfdae_check_linear(&problem, &options, text, sizeof text);
  std::fprintf(stderr, "a generator made a problem that is refused: %s\n", text);
  std::abort();
}

sfdae_options default_options() {
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  return options;
}

Answer answer_of(sfdae_solver* solver, int status) {
  Answer answer;
  answer.status = status;
  if (status < 0) {
    answer.message = sfdae_message(solver);
    return answer;
  }
  sfdae_characteristics found;
  sfdae_characteristics_init(&found, sizeof found);
  sfdae_get_characteristics(solver, &found);
  answer.values = {found.strangeness_index, found.differential, found.algebraic, found.undetermined, found.redundant};
  return answer;
}

Answer analyze(const LinearProblem& problem, const sfdae_options& options) {
  LinearCallbacks callbacks(problem);
  Solver solver(callbacks, options);
  const double T = problem.units.time;
  const int status = sfdae_analyze(solver.get(), problem.begin * T, problem.end * T, nullptr);
  if (single_problem()) print(problem, solver.get());
  return answer_of(solver.get(), status);
}

namespace {

void print_matrix(const char* name, int m, int n, const std::vector<double>& entries) {
  for (int i = 0; i < m; ++i) {
    std::printf("%s(%d, :) =", name, i);
    for (int j = 0; j < n; ++j) std::printf(" %.17g", entries[static_cast<std::size_t>(i + j * m)]);
    std::printf("\n");
  }
}

}  // namespace

void print(const LinearProblem& problem, sfdae_solver* solver) {
  LinearCallbacks callbacks(problem);
  sfdae_linear_problem c = callbacks.c_problem();
  const double t = problem.begin * problem.units.time;
  const auto size = static_cast<std::size_t>(problem.m) * static_cast<std::size_t>(problem.n);
  for (int order = 0; order <= (problem.constant ? 0 : 1); ++order) {
    std::vector<double> E(size), A(size);
    c.E(t, order, E.data(), c.user);
    c.A(t, order, A.data(), c.user);
    std::printf("t = %.17g, derivatives of order %d\n", t, order);
    print_matrix("E", problem.m, problem.n, E);
    print_matrix("A", problem.m, problem.n, A);
  }
  std::size_t length = 0;
  sfdae_report(solver, nullptr, 0, &length);
  std::string text(length, '\0');
  sfdae_report(solver, text.data(), length, nullptr);
  std::printf("%s\n%s\n", sfdae_message(solver), text.c_str());
}

}  // namespace campaign
