// SPDX-License-Identifier: BSD-3-Clause
// A recorded problem and its twin: a function with sparsity patterns that writes what the record says.
#ifndef SFDAE_TESTS_PATTERNED_TWIN_H
#define SFDAE_TESTS_PATTERNED_TWIN_H

#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "expression/taylor_evaluator.h"
#include "linalg/index.h"
#include "nonlinear_run.h"
#include "recorded.h"

namespace sfdae_test {

using sfdae::core::index;

// By compressed columns.
struct Pattern {
  std::vector<int> col_start{0}, row_index;
  int entries() const { return static_cast<int>(row_index.size()); }
};

inline Pattern pattern_of(const Record& record, bool of_derivatives) {
  std::vector<std::vector<int>> rows(index(record.n()));
  for (int i = 0; i < record.m(); ++i)
    for (const sfdae::core::Entry& entry : record.entries(i))
      if (entry.derivative == of_derivatives) rows[index(entry.unknown)].push_back(i);
  Pattern pattern;
  for (const std::vector<int>& column : rows) {
    pattern.row_index.insert(pattern.row_index.end(), column.begin(), column.end());
    pattern.col_start.push_back(pattern.entries());
  }
  return pattern;
}

// residual(t, x, xdot, F) of any scalar type.
template <class Residual>
std::shared_ptr<const Record> recording_of(int n, Residual residual) {
  Recording recording(n);
  std::vector<Term> F(index(n));
  residual(recording.t, recording.x.data(), recording.xdot.data(), F.data());
  return recording.finish(F);
}

// The user's function and its patterns; matrices: SFDAE_MATRICES_... A pattern may be changed before the solver is
// created.
class PatternedTwin {
 public:
  PatternedTwin(std::shared_ptr<const Record> record, int matrices)
      : F_x(pattern_of(*record, false)),
        F_xdot(pattern_of(*record, true)),
        n_(record->n()),
        matrices_(matrices),
        evaluator_(std::move(record)) {}
  ~PatternedTwin() { sfdae_destroy(&solver_); }
  PatternedTwin(const PatternedTwin&) = delete;
  PatternedTwin& operator=(const PatternedTwin&) = delete;

  int create(const sfdae_options& options) {
    sfdae_nonlinear_problem problem;
    sfdae_nonlinear_problem_init(&problem, sizeof problem);
    problem.num_equations = problem.num_unknowns = n_;
    problem.total_derivative = &PatternedTwin::evaluate;
    problem.user = this;
    problem.matrices = matrices_;
    problem.F_x_entries = F_x.entries(), problem.F_xdot_entries = F_xdot.entries();
    problem.F_x_col_start = F_x.col_start.data(), problem.F_x_row_index = F_x.row_index.data();
    problem.F_xdot_col_start = F_xdot.col_start.data(), problem.F_xdot_row_index = F_xdot.row_index.data();
    const int status = sfdae_create_nonlinear(&solver_, &problem, &options);
    // What it points to has been copied.
    kept_x_ = std::exchange(F_x, {}), kept_xdot_ = std::exchange(F_xdot, {});
    return status;
  }
  int integrate(double t0, double tf, const std::vector<double>& guess) {
    t = t0, x = guess, xdot.resize(index(n_));
    const int status = sfdae_start(solver_, t, tf, x.data(), xdot.data());
    return status < 0 ? status : sfdae_advance(solver_, tf, &t, x.data(), xdot.data());
  }
  std::string message() const { return sfdae_message(solver_); }
  sfdae_solver* solver() { return solver_; }
  CharacteristicValues values() const {
    sfdae_characteristics c;
    sfdae_characteristics_init(&c, sizeof c);
    if (sfdae_get_characteristics(solver_, &c) < 0) return {-1, -1, -1, -1, -1};
    return {c.strangeness_index, c.differential, c.algebraic, c.undetermined, c.redundant};
  }

  Pattern F_x, F_xdot;
  double t = 0.0;
  std::vector<double> x, xdot;
  long calls = 0;          // of order 0
  int highest_order = 62;  // available
  bool gave_jacobians = false;

 private:
  static int evaluate(double t, int order, const double* derivatives, double* F, double* F_x, double* F_xdot,
                      void* user) {
    return static_cast<PatternedTwin*>(user)->write(t, order, derivatives, F, F_x, F_xdot);
  }

  int write(double at, int order, const double* derivatives, double* F, double* to_x, double* to_xdot) {
    if (order > highest_order) return SFDAE_ORDER_NOT_AVAILABLE;
    if (order == 0) ++calls;
    const std::size_t n = index(n_), orders = index(order + 1);
    const bool asks = to_x != nullptr || to_xdot != nullptr;
    std::vector<double> jet(derivatives, derivatives + n * (orders + 1)), values(n * orders), of_x, of_xdot;
    if (asks) of_x.resize(n * n * orders), of_xdot.resize(n * n * orders);
    double factorial = 1.0;
    for (std::size_t k = 1; k <= orders; ++k) {
      factorial *= static_cast<double>(k);
      for (std::size_t j = 0; j < n; ++j) jet[k * n + j] /= factorial;
    }
    factorial /= static_cast<double>(orders);
    gave_jacobians = gave_jacobians || asks;
    const sfdae::core::SeriesOrders wanted{order, asks ? order : -1, asks ? order : -1};
    if (!evaluator_.gradients(at, jet.data(), wanted, values.data(), of_xdot.data(), of_x.data())) return 1;
    for (std::size_t i = 0; i < n; ++i) F[i] = factorial * values[n * index(order) + i];
    if (to_x != nullptr) write_matrix(of_x.data() + n * n * index(order), factorial, kept_x_, to_x);
    if (to_xdot != nullptr) write_matrix(of_xdot.data() + n * n * index(order), factorial, kept_xdot_, to_xdot);
    return 0;
  }

  void write_matrix(const double* from, double factor, const Pattern& pattern, double* to) const {
    const std::size_t n = index(n_);
    if (matrices_ == SFDAE_MATRICES_DENSE) {
      for (std::size_t i = 0; i < n * n; ++i) to[i] = factor * from[i];
      return;
    }
    for (std::size_t j = 0; j < n; ++j)
      for (int e = pattern.col_start[j]; e < pattern.col_start[j + 1]; ++e)
        to[e] = factor * from[index(pattern.row_index[index(e)]) + n * j];
  }

  int n_, matrices_;
  sfdae::core::TaylorEvaluator evaluator_;
  Pattern kept_x_, kept_xdot_;
  sfdae_solver* solver_ = nullptr;
};

// Without its entry number `at`.
inline Pattern without(Pattern pattern, int at) {
  pattern.row_index.erase(pattern.row_index.begin() + at);
  for (int& start : pattern.col_start)
    if (start > at) --start;
  return pattern;
}

}  // namespace sfdae_test

#endif
