// SPDX-License-Identifier: BSD-3-Clause
// Nonlinear problems written with operators, solved through the C API.
#ifndef SFDAE_TESTS_NONLINEAR_RUN_H
#define SFDAE_TESTS_NONLINEAR_RUN_H

#include <algorithm>
#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "linear_family.h"
#include "sfdae/expression.hpp"
#include "sfdae/sfdae.h"

namespace sfdae_test {

using sfdae::Expression;
// (record, t, x, xdot, F); the record is for parameters.
using RecordedFunction =
    std::function<void(sfdae_record*, const Expression&, const Expression*, const Expression*, Expression*)>;

struct NonlinearEquations {
  int m, n;
  RecordedFunction write;
  std::vector<int> prescribed = {};
  sfdae_vector_function prescribed_values = nullptr;
  std::vector<int> differentiations = {};  // none: no limit
};

// F(t, x, xdot, F) for any scalar type.
template <class Residual>
NonlinearEquations equations_of(int m, int n, Residual residual) {
  return {m, n,
          [residual](sfdae_record*, const Expression& t, const Expression* x, const Expression* xdot, Expression* F) {
            residual(t, x, xdot, F);
          }};
}

inline sfdae_options default_options() {
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  return options;
}
inline sfdae_options options_with(double tolerance, int method = SFDAE_METHOD_BDF) {
  sfdae_options options = default_options();
  options.rtol = options.atol = tolerance;
  options.method = method;
  return options;
}

// A solver with the point that it has reached. What the calls return are statuses of the library.
class NonlinearRun {
 public:
  NonlinearRun(NonlinearEquations equations, const sfdae_options& options) : equations_(std::move(equations)) {
    sfdae_nonlinear_problem problem;
    sfdae_nonlinear_problem_init(&problem, sizeof problem);
    problem.num_equations = equations_.m;
    problem.num_unknowns = equations_.n;
    problem.equations = &NonlinearRun::record;
    problem.num_prescribed = static_cast<int>(equations_.prescribed.size());
    problem.prescribed = equations_.prescribed.data();
    problem.prescribed_values = equations_.prescribed_values;
    problem.user = this;
    if (!equations_.differentiations.empty()) problem.differentiations = equations_.differentiations.data();
    created = sfdae_create_nonlinear(&solver_, &problem, &options);
    xdot.resize(static_cast<std::size_t>(equations_.n));
  }
  ~NonlinearRun() { sfdae_destroy(&solver_); }
  NonlinearRun(const NonlinearRun&) = delete;
  NonlinearRun& operator=(const NonlinearRun&) = delete;

  int start(double t0, double toward, const std::vector<double>& guess) {
    t = t0;
    x = guess;
    return sfdae_start(solver_, t, toward, x.data(), xdot.data());
  }
  int advance(double tout) { return sfdae_advance(solver_, tout, &t, x.data(), xdot.data()); }
  // From guess at t0 to tf.
  int integrate(double t0, double tf, const std::vector<double>& guess) {
    const int status = start(t0, tf, guess);
    return status < 0 ? status : advance(tf);
  }
  int analyze(double t0, double toward, const std::vector<double>& guess) {
    return sfdae_analyze_at(solver_, t0, toward, guess.data(), nullptr);
  }
  CharacteristicValues values() const {
    sfdae_characteristics c;
    sfdae_characteristics_init(&c, sizeof c);
    if (sfdae_get_characteristics(solver_, &c) < 0) return {-1, -1, -1, -1, -1};
    return {c.strangeness_index, c.differential, c.algebraic, c.undetermined, c.redundant};
  }
  sfdae_initial_report initial_report() const {
    sfdae_initial_report report;
    sfdae_initial_report_init(&report, sizeof report);
    sfdae_get_initial_report(solver_, &report);
    return report;
  }
  sfdae_statistics statistics() const {
    sfdae_statistics statistics;
    sfdae_statistics_init(&statistics, sizeof statistics);
    sfdae_get_statistics(solver_, &statistics);
    return statistics;
  }
  std::string message() const { return sfdae_message(solver_); }
  sfdae_solver* solver() { return solver_; }

  int created = 0;
  double t = 0.0;
  std::vector<double> x, xdot;

 private:
  static int record(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                    sfdae_expression* residual, void* user) {
    const auto& equations = static_cast<const NonlinearRun*>(user)->equations_;
    const std::vector<Expression> unknowns(x, x + equations.n), slopes(xdot, xdot + equations.n);
    std::vector<Expression> F(static_cast<std::size_t>(equations.m));
    equations.write(record, Expression(t), unknowns.data(), slopes.data(), F.data());
    std::transform(F.begin(), F.end(), residual, [](const Expression& e) { return e.c(); });
    return 0;
  }

  NonlinearEquations equations_;
  sfdae_solver* solver_ = nullptr;
};

inline std::string status_text(const NonlinearRun& run, int status) {
  return std::string(sfdae_status_name(status)) + ": " + run.message();
}

}  // namespace sfdae_test

#endif
