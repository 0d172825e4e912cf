// Conditions that a user declares for functions.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/callback_conditions.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "expression/condition_functions.h"
#include "expression/opaque_record.h"
#include "linalg/index.h"
#include "linalg/matrix.h"

namespace sfdae::core {

namespace {

JacobianPatterns patterns_of(int count, int n) {
  const ColumnPattern all = full_pattern(count, n).pattern;
  return {all, all};
}

std::shared_ptr<const Record> record_of(int count, int n) {
  std::vector<std::string> names;
  for (int k = 0; k < count; ++k) names.push_back("condition " + std::to_string(k) + " of the callbacks");
  return std::make_shared<const Record>(opaque_conditions(count, patterns_of(count, n), names));
}

}  // namespace

ConditionEquations::ConditionEquations(const DeclaredConditions& declared, const Problem& problem, int num_unknowns)
    : PatternedEquations(problem, declared.count, num_unknowns),
      declared_(declared),
      pattern_(full_pattern(declared.count, num_unknowns)) {
  allow_differences_in_time(true);
}

CallbackError ConditionEquations::call(double t, const double* x, const double* xdot, double* g) {
  std::fill_n(g, declared_.count, 0.0);
  CallbackError error;
  error.function = "conditions";
  error.t = t;
  error.code = declared_.function(t, x, xdot, g, declared_.user);
  if (error.code != 0) error.status = error.code < 0 ? SFDAE_CALLBACK_STOPPED : SFDAE_CALLBACK_FAILED;
  else if (!all_finite(g, index(declared_.count))) error.status = SFDAE_NOT_FINITE;
  return error;
}

CallbackError ConditionEquations::coefficient(double t, const double* jet, int k, double* g) {
  if (k == 0) return call(t, jet, jet + n(), g);
  CallbackError error;
  error.status = SFDAE_ORDER_MISSING;
  return error;
}

CallbackError ConditionEquations::coefficient_of_entries(double t, const double* jet, int k, double* g_x,
                                                         double* g_xdot) {
  std::vector<double> g(index(m()));
  CallbackError error = coefficient(t, jet, k, g.data());
  if (error.status != SFDAE_OK) return error;
  std::vector<double> point(jet, jet + 2 * n());
  of_x_.note(jet, n());
  of_xdot_.note(jet + n(), n());
  const FunctionOfJet evaluate = [&](const double* moved, double* g_moved) {
    return call(t, moved, moved + n(), g_moved);
  };
  std::vector<double> terms(g);
  for (double& term : terms) term = std::fabs(term);
  const ChangingJet by_x{point, n(), 0}, by_xdot{point, n(), 1};
  error = ColoredDifferences(evaluate, by_x, of_x_, g).find(pattern_, terms, g_x);
  if (error.status != SFDAE_OK) return error;
  return ColoredDifferences(evaluate, by_xdot, of_xdot_, g).find(pattern_, terms, g_xdot);
}

CallbackConditions::CallbackConditions(const DeclaredConditions& declared, const Problem& problem, int num_unknowns)
    : declared_(declared),
      n_(index(num_unknowns)),
      equations_(std::make_shared<ConditionEquations>(declared, problem, num_unknowns)),
      evaluator_(record_of(declared.count, num_unknowns), equations_),
      g_(index(declared.count)) {
  equations_->set_targets(evaluator_.tape(), patterns_of(declared.count, num_unknowns));
}

CallbackError CallbackConditions::choose(double t, const double* point) {
  if (kept_ > 0) return {};
  const bool are_held = evaluator_.parameter(0) != 0.0;
  if (!are_held) {
    CallbackError error = equations_->call(t, point, point + n_, g_.data());
    if (error.status != SFDAE_OK) return error;
  }
  for (int k = 0; k < declared_.count; ++k)
    declared_.branches[k] = is_met(are_held ? evaluator_.parameter(k) : g_[index(k)]) ? 1 : 0;
  return {};
}

}  // namespace sfdae::core
