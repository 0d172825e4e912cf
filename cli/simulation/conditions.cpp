// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/conditions.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "simulation/linear_form.h"
#include "simulation/text.h"

namespace sfdae::cli {

namespace {

// Finite-difference rows have a relative accuracy of about 1e-6.
constexpr double dependent = 1e-5, zero_row = 1e-10;

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

std::vector<int> numbers_of(const System& system, const std::vector<int>& unknowns) {
  std::vector<int> result(system.model.variables.size(), -1);
  for (int j = 0; j < static_cast<int>(unknowns.size()); ++j)
    if (unknowns[at(j)] >= 0) result[at(unknowns[at(j)])] = j;
  return result;
}

// Replaces left = right by unknown = number if it is linear in one unknown alone, whose start value can then be fixed.
void simplify(const Formulas& formulas, const std::vector<int>& number_of, Condition& condition) {
  std::map<int, double> coefficients;
  double constant = 0.0;
  for (const auto& [side, sign] : {std::make_pair(condition.left, 1.0), std::make_pair(condition.right, -1.0)}) {
    const LinearForm form = linear_form(formulas, side);
    if (!form.is_whole) return;
    constant += sign * form.constant;
    for (const auto& [variable, coefficient] : form.coefficients) coefficients[variable] += sign * coefficient;
    for (const auto& [factor, other] : form.others) {
      if (formulas[other].operation != Operation::variable) return;  // else a free parameter
      coefficients[formulas[other].index] += sign * factor;
    }
  }
  std::erase_if(coefficients, [](const auto& entry) { return entry.second == 0.0; });
  if (coefficients.size() != 1) return;
  const auto [variable, coefficient] = *coefficients.begin();
  const double value = 0.0 - constant / coefficient;  // avoids -0
  if (at(variable) >= number_of.size() || number_of[at(variable)] < 0 || !std::isfinite(value)) return;
  condition.unknown = number_of[at(variable)];
  condition.value = value;
  condition.factor = coefficient;
}

std::string text_of_start(const System& system, int v, Formula start) {
  const Variable& variable = system.model.variables[at(v)];
  if (system.formulas.is_number(start)) return variable.name + " = " + to_text(system.formulas[start].value);
  const Expression& formula = variable.start ? variable.start : variable.binding;
  return variable.name + " = " + (formula ? to_text(formula, system.model) : "its start value");
}

}  // namespace

double norm(const std::vector<double>& x) {
  double result = 0.0;
  for (double entry : x) result = std::hypot(result, entry);
  return result;
}

std::vector<Condition> given_conditions(const System& system, const std::vector<int>& unknowns) {
  const std::vector<int> number_of = numbers_of(system, unknowns);
  std::vector<Condition> result;
  for (int v = 0; v < static_cast<int>(system.model.variables.size()); ++v) {
    const Variable& variable = system.model.variables[at(v)];
    if (!variable.is_fixed || variable.variability != Variability::continuous || variable.type != Type::real)
      continue;
    if (!system.formulas.depends(system.values[at(v)], on_continuous) &&
        !system.formulas.is_number(system.values[at(v)]))
      continue;
    if (variable.is_input) continue;
    Condition condition;
    condition.text = text_of_start(system, v, system.starts.own[at(v)]) + " (start value)";
    condition.at = variable.at;
    condition.left = system.values[at(v)];
    condition.right = system.starts.own[at(v)];
    simplify(system.formulas, number_of, condition);
    result.push_back(condition);
  }
  for (const InitialCondition& initial : system.initial_conditions) {
    Condition condition{-1, 0.0, 1.0, initial.left, initial.right, initial.text, initial.at};
    simplify(system.formulas, number_of, condition);
    result.push_back(condition);
  }
  return result;
}

std::vector<Condition> possible_conditions(const System& system, const std::vector<int>& unknowns) {
  std::vector<int> order;
  for (int j = 0; j < static_cast<int>(unknowns.size()); ++j)
    if (unknowns[at(j)] >= 0) order.push_back(j);
  const auto wish = [&](int j) {
    const int v = unknowns[at(j)];
    const bool is_parameter = system.model.variables[at(v)].variability == Variability::parameter;
    return std::make_tuple(is_parameter || system.is_state[at(v)] != 0 ? 1 : 0,
                           static_cast<int>(system.model.variables[at(v)].state_select),
                           system.starts.are_given[at(v)], is_parameter ? 0 : 1);
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return wish(a) > wish(b); });
  std::vector<Condition> result;
  for (int j : order) {
    const int v = unknowns[at(j)];
    const Formula start = system.starts.formulas[at(v)];
    const int unknown = system.formulas.is_number(start) ? j : -1;  // else it depends on free parameters
    result.push_back({unknown, system.starts.numbers[at(v)], 1.0, system.values[at(v)], start,
                      text_of_start(system, v, start), system.model.variables[at(v)].at});
  }
  return result;
}

bool IndependentRows::add(const std::vector<double>& row, double scale) {
  const double size = norm(row);
  if (!(size > zero_row * scale) || Q_.size() == row.size()) return false;
  std::vector<double> rest = row, l(Q_.size() + 1, 0.0);
  for (int pass = 0; pass < 2; ++pass)  // twice is enough for orthogonality to machine precision
    for (std::size_t i = 0; i < Q_.size(); ++i) {
      const double factor = dot(rest, Q_[i]);
      l[i] += factor;
      for (std::size_t k = 0; k < rest.size(); ++k) rest[k] -= factor * Q_[i][k];
    }
  const double remaining = norm(rest);
  if (remaining <= dependent * size) return false;
  for (double& value : rest) value /= remaining;
  l.back() = remaining;
  Q_.push_back(std::move(rest));
  L_.push_back(std::move(l));
  return true;
}

std::vector<double> IndependentRows::solve(const std::vector<double>& b) const {
  std::vector<double> y, z(Q_.empty() ? 0 : Q_.front().size(), 0.0);
  for (std::size_t i = 0; i < Q_.size(); ++i) {
    double value = b[i];
    for (std::size_t k = 0; k < i; ++k) value -= L_[i][k] * y[k];
    y.push_back(value / L_[i][i]);
    for (std::size_t k = 0; k < z.size(); ++k) z[k] += y[i] * Q_[i][k];
  }
  return z;
}

}  // namespace sfdae::cli
