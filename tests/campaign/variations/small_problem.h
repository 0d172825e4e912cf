// One copy of a problem: a few states with their equations, and further unknowns that follow from them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "formula.h"

namespace campaign {

// Steps of the reference are at most that long between begin and end.
struct Window {
  double begin, end, step;
};

using StateFormulas = std::function<std::vector<Formula>(const std::vector<Formula>& states)>;

// States x: x_i' = f_i(t, x), or 0 = f_i(t, x) where x_i is not differential.
struct Model {
  std::shared_ptr<Formulas> formulas = std::make_shared<Formulas>();
  std::vector<std::string> names;
  std::vector<char> differential;
  std::vector<double> start;
  StateFormulas f;
  // Unknowns that stand in the equations as y = value(t, x).
  std::vector<std::string> value_names;
  StateFormulas values;
  double feature = 1.0;  // the shortest time in which an input does something
  std::vector<Window> windows;
};

enum class Addition { none, copy, slope, second_slope, path };
inline constexpr int num_additions = 5;

struct SmallProblem {
  std::shared_ptr<Formulas> formulas;
  std::vector<std::string> names;  // of all unknowns, the states of the reference first
  std::vector<char> differential;  // of the states
  std::vector<double> start;       // of the states, t = 0
  std::vector<Formula> f;          // of the states
  std::vector<Formula> values;     // of the further unknowns, in terms of t and the states
  std::vector<Formula> residuals;  // as many as unknowns
  double feature = 1.0;
  std::vector<Window> windows;

  int num_states() const { return static_cast<int>(start.size()); }
  int num_unknowns() const { return static_cast<int>(names.size()); }
};

// Further equations whose consequences are known. copy: y = x_0, and y = x_0, z = y', and w = z' in addition, are of
// index 1, 2 and 3. path: a force u lets the first state, or the first two, follow p(t): x_0 = p, u = p' - f(t, p).
// second_order: x_0' = x_1.
SmallProblem with_addition(const Model& model, Addition addition, bool second_order);

}  // namespace campaign
