// SPDX-License-Identifier: BSD-3-Clause
#include "small_problem.h"

#include <cmath>

namespace campaign {

namespace {

std::vector<Formula> unknowns(Formulas& formulas, int count) {
  std::vector<Formula> result;
  for (int i = 0; i < count; ++i) result.push_back(formulas.unknown(i));
  return result;
}

// The derivative along the solution of a formula in t and the states; at most one state, the last but one or the
// second, is not differential: 0 = f_a gives a' = -(f_a,t + f_a,x x') / f_a,a.
Formula along_solution(const SmallProblem& problem, Formula formula) {
  Formulas& owner = *problem.formulas;
  std::vector<Formula> slopes = problem.f;
  for (int a = 0; a < problem.num_states(); ++a) {
    const auto place = static_cast<std::size_t>(a);
    if (problem.differential[place]) continue;
    Formula sum = derivative(problem.f[place], Operation::time);
    for (int j = 0; j < problem.num_states(); ++j) {
      if (j == a) continue;
      sum = sum + derivative(problem.f[place], Operation::unknown, j) * problem.f[static_cast<std::size_t>(j)];
    }
    slopes[place] = owner.number(0.0) - sum / derivative(problem.f[place], Operation::unknown, a);
  }
  Formula sum = derivative(formula, Operation::time);
  for (int j = 0; j < problem.num_states(); ++j)
    sum = sum + derivative(formula, Operation::unknown, j) * slopes[static_cast<std::size_t>(j)];
  return sum;
}

void add_slopes(SmallProblem& problem, Addition addition) {
  Formulas& owner = *problem.formulas;
  const int first = problem.num_unknowns();
  Formula value = owner.unknown(0);
  constexpr std::array<const char*, 3> names = {"y", "z", "w"};
  for (int k = 0; k < static_cast<int>(addition); ++k) {
    problem.names.push_back(names[static_cast<std::size_t>(k)]);
    if (k > 0) value = along_solution(problem, value);
    problem.values.push_back(value);
    problem.residuals.push_back(owner.unknown(first + k) - (k == 0 ? owner.unknown(0) : owner.slope(first + k - 1)));
  }
}

// All unknowns are functions of t.
SmallProblem on_path(const Model& model, bool second_order) {
  SmallProblem problem;
  problem.formulas = model.formulas;
  Formulas& owner = *model.formulas;
  const Formula t = owner.time();
  const double size = std::max(std::abs(model.start[0]), 0.5);
  std::vector<Formula> path = {size * (0.6 + 0.5 * sin(1.3 * t))};
  problem.names = {"x", "u"};
  if (second_order) {
    path.push_back(derivative(path[0], Operation::time));
    problem.names = {"q", "v", "u"};
  }
  const int order = second_order ? 2 : 1;
  const std::vector<Formula> states = unknowns(owner, order);
  const Formula force = owner.unknown(order);
  const auto last = static_cast<std::size_t>(order) - 1;
  problem.values = path;
  problem.values.push_back(derivative(path[last], Operation::time) - model.f(path)[last]);
  if (second_order) problem.residuals.push_back(owner.slope(0) - states[1]);
  problem.residuals.push_back(owner.slope(order - 1) - model.f(states)[last] - force);
  problem.residuals.push_back(states[0] - path[0]);
  problem.feature = model.feature;
  return problem;
}

}  // namespace

SmallProblem with_addition(const Model& model, Addition addition, bool second_order) {
  if (addition == Addition::path) return on_path(model, second_order);
  SmallProblem problem{model.formulas, model.names,  model.differential, model.start, {}, {}, {},
                       model.feature,  model.windows};
  Formulas& owner = *problem.formulas;
  const std::vector<Formula> states = unknowns(owner, problem.num_states());
  problem.f = model.f(states);
  for (int i = 0; i < problem.num_states(); ++i) {
    const auto place = static_cast<std::size_t>(i);
    problem.residuals.push_back(problem.differential[place] ? owner.slope(i) - problem.f[place] : problem.f[place]);
  }
  if (model.values) {
    problem.values = model.values(states);
    for (std::size_t k = 0; k < problem.values.size(); ++k) {
      problem.names.push_back(model.value_names[k]);
      problem.residuals.push_back(owner.unknown(problem.num_unknowns() - 1) - problem.values[k]);
    }
  }
  add_slopes(problem, addition);
  return problem;
}

}  // namespace campaign
