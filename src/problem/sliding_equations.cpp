// SPDX-License-Identifier: BSD-3-Clause
#include "problem/sliding_equations.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "expression/node_copies.h"
#include "expression/symbolic_gradient.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

constexpr const char* advice = " Write it in both modes with the same factors.";

bool contains_derivatives(const Record& record, int equation) {
  const std::span<const Entry> entries = record.entries(equation);
  return std::any_of(entries.begin(), entries.end(), [](const Entry& entry) { return entry.derivative; });
}

// An equation of both modes.
struct Pair {
  int equation, below, above;  // nodes
};

// The factors of x' are the same; or, where there is no x', at least one unknown has the same factor.
void demand_equal_factors(Recorder recorder, const TaylorEvaluator& below, const TaylorEvaluator& above,
                          const Pair& pair) {
  const int n = below.record().n();
  const std::string name = below.record().name(pair.equation);
  const bool has_derivatives = contains_derivatives(below.record(), pair.equation);
  if (has_derivatives != contains_derivatives(above.record(), pair.equation))
    throw Failure(SFDAE_ILLEGAL_ARGUMENT, name + " contains x' in one of the modes only: they cannot be combined.");
  std::vector<int> leaves;
  for (int j = 0; j < n; ++j) leaves.push_back(has_derivatives ? recorder.derivative(j) : recorder.unknown(j));
  const std::vector<int> of_below = symbolic_gradient(recorder, pair.below, leaves);
  const std::vector<int> of_above = symbolic_gradient(recorder, pair.above, leaves);
  bool shares_one = false;
  for (int j = 0; j < n; ++j) {
    const bool is_same = of_below[index(j)] == of_above[index(j)];
    if (has_derivatives && !is_same)
      throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                    format("%s: the factors of x'[%d] in the modes differ.", name.c_str(), j) + advice);
    shares_one = shares_one || (is_same && recorder.number(of_below[index(j)]) != 0.0);
  }
  if (!has_derivatives && !shares_one)
    throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                  name + ": no unknown has the same factor, other than 0, in both modes." + advice);
}

EquationNames names_of(const Record& below) {
  std::vector<std::string> names;
  for (int i = 0; i < below.m(); ++i) names.push_back(below.equation_names()[i]);
  names.emplace_back("surface");
  return EquationNames(std::move(names));
}

}  // namespace

std::shared_ptr<const Record> surface_of_modes(const Record& surface, const TaylorEvaluator& below,
                                               const TaylorEvaluator& above) {
  TaylorEvaluator given(std::make_shared<const Record>(surface));
  for (int i = 0; i < given.num_parameters(); ++i)
    for (const TaylorEvaluator* mode : {&above, &below})
      if (const auto k = mode->find_parameter(surface.parameters()[index(i)].name))
        given.set_parameter(i, mode->parameter(*k));
  if (contains_derivatives(surface, 0))
    throw Failure(SFDAE_ILLEGAL_ARGUMENT, "the surface depends on x': it may depend on t and x alone.");
  if (surface.entries(0).empty())
    throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                  "the surface does not depend on x: a change at a time is SFDAE_TRANSITION_TIME.");
  Recorder recorder(surface.n());
  const std::vector<int> copies = copy_values(given, Derivatives::kept, recorder);
  return recorder.finish({copies[index(surface.residual(0))]});
}

std::shared_ptr<const Record> sliding_equations(const TaylorEvaluator& below, const TaylorEvaluator& above,
                                                const Record& surface) {
  const int m = below.record().m(), n = below.record().n();
  if (above.record().m() != m)
    throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                  format("the modes have %d and %d equations: they cannot be combined.", m, above.record().m()));
  Recorder recorder(n + 1);
  const std::vector<int> of_below = copy_values(below, Derivatives::kept, recorder);
  const std::vector<int> of_above = copy_values(above, Derivatives::kept, recorder);
  // What differs does not contain x'.
  const std::vector<int> rest_below = copy_values(below, Derivatives::zero, recorder);
  const std::vector<int> rest_above = copy_values(above, Derivatives::zero, recorder);
  const int part = recorder.unknown(n);
  std::vector<int> residuals;
  bool is_different = false;
  for (int i = 0; i < m; ++i) {
    const std::size_t a = index(below.record().residual(i)), b = index(above.record().residual(i));
    residuals.push_back(of_below[a]);
    if (of_below[a] == of_above[b]) continue;
    is_different = true;
    demand_equal_factors(recorder, below, above, {i, of_below[a], of_above[b]});
    const int difference = recorder.apply(Operation::subtract, rest_above[b], rest_below[a]);
    residuals.back() =
        recorder.apply(Operation::add, residuals.back(), recorder.apply(Operation::multiply, part, difference));
  }
  if (!is_different)
    throw Failure(SFDAE_ILLEGAL_ARGUMENT, "both modes have the same equations, so that nothing switches.");
  const TaylorEvaluator plain(std::make_shared<const Record>(surface));
  residuals.push_back(copy_values(plain, Derivatives::kept, recorder)[index(surface.residual(0))]);
  return recorder.finish(std::move(residuals), names_of(below.record()));
}

}  // namespace sfdae::core
