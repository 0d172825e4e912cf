// SPDX-License-Identifier: BSD-3-Clause
// The problems of tests/data/problems.json: equations given as formulas.
#ifndef SFDAE_TESTS_FORMULA_PROBLEMS_H
#define SFDAE_TESTS_FORMULA_PROBLEMS_H

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formula.h"
#include "test_problem.h"

namespace sfdae_test {

// How the solution is known.
enum class ExactSolution {
  none,
  formulas,   // of t
  recursion,  // x_n = sin t, x_i = x_{i+1}' + sin t
  crane,      // the last mass follows the path, the rest by differentiation
  robot_arm   // the tip follows the path, the rest by differentiation
};

struct FormulaProblem {
  TestProblem data;  // x0 is the exact solution at t0 where the file has no other start
  std::vector<std::pair<std::string, double>> parameters;
  std::vector<std::pair<std::string, Formula>> abbreviations;  // each may use those before it
  std::vector<Formula> F;
  ExactSolution solution = ExactSolution::none;
  std::vector<Formula> exact_formulas;

  // F(t, x, xdot) with m entries.
  template <class V>
  void residual(const V& t, const V* x, const V* xdot, V* out) const {
    FormulaScope<V> scope = scope_at(t);
    scope.x = x;
    scope.xdot = xdot;
    abbreviate(scope);
    for (std::size_t i = 0; i < F.size(); ++i) out[i] = F[i].evaluate(scope);
  }

  // Taylor coefficients of x at t up to x^(order)/order!; throws std::logic_error without an exact solution.
  std::vector<Jet> exact(double t, int order) const;

 private:
  template <class V>
  FormulaScope<V> scope_at(const V& t) const {
    FormulaScope<V> scope{.t = t};
    for (const auto& [name, value] : parameters) scope.names.emplace(name, V(value));
    return scope;
  }
  template <class V>
  void abbreviate(FormulaScope<V>& scope) const {
    for (const auto& [name, formula] : abbreviations) scope.names.insert_or_assign(name, formula.evaluate(scope));
  }
  double parameter(const std::string& name) const;
  std::vector<Jet> exact_formulas_at(const Jet& t) const;
  std::vector<Jet> exact_recursion(const Jet& t) const;
  std::vector<Jet> exact_crane(const Jet& t) const;
  std::vector<Jet> exact_robot_arm(const Jet& t) const;
};

// All problems of a file; throws std::runtime_error.
std::vector<FormulaProblem> read_formula_problems(const std::string& path);
// Those of tests/data/problems.json.
const std::vector<FormulaProblem>& formula_problems();
const FormulaProblem& formula_problem(std::string_view name);

}  // namespace sfdae_test

#endif
