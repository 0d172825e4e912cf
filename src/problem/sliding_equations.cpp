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

// Factors of x', or of the unknowns of equations without x', in one equation of both modes: nodes of one recorder.
struct Factors {
  std::vector<int> below, above;
  bool is_same(int j) const { return below[index(j)] == above[index(j)]; }
  bool are_same() const { return below == above; }
};

// Compares factors by numbers in place of parameters: those of x' must be equal; or, without x', at least one unknown
// must have the same factor.
void demand_equal_factors(const Recorder& recorder, const Factors& factors, const std::string& name,
                          bool has_derivatives) {
  bool shares_one = false;
  for (int j = 0; j < static_cast<int>(factors.below.size()); ++j) {
    if (has_derivatives && !factors.is_same(j))
      throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                    format("%s: the factors of x'[%d] in the modes differ.", name.c_str(), j) + advice);
    shares_one = shares_one || (factors.is_same(j) && recorder.number(factors.below[index(j)]) != 0.0);
  }
  if (!has_derivatives && !shares_one)
    throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                  name + ": no unknown has the same factor, other than 0, in both modes." + advice);
}

// Nodes of the modes in one recorder: all; or one of each.
struct Copies {
  std::vector<int> below, above;
};
struct Pair {
  int below, above;
  bool is_same() const { return below == above; }
};
Pair pair_of(const Copies& copies, int below, int above) {
  return {copies.below[index(below)], copies.above[index(above)]};
}

class Combination {
 public:
  Combination(const TaylorEvaluator& below, const TaylorEvaluator& above, const KeptParameters& kept)
      : below_(below), above_(above), kept_(kept), recorder_(below.record().n() + 1) {
    for (const Parameter& parameter : kept.all()) {
      const int leaf = recorder_.parameter(parameter.name, parameter.value);
      if (kept.stays(recorder_.num_parameters() - 1)) leaves_.push_back(leaf), values_now_.push_back(parameter.value);
    }
    numbers_ = copies(Derivatives::kept, false);
    numbers_at_rest_ = copies(Derivatives::zero, false);
    values_ = kept.is_empty() ? numbers_ : copies(Derivatives::kept, true);
    values_at_rest_ = kept.is_empty() ? numbers_at_rest_ : copies(Derivatives::zero, true);
    part_ = recorder_.unknown(below.record().n());
  }

  Recorder& recorder() { return recorder_; }
  bool is_different() const { return is_different_; }
  // (1 - s) F_below + s F_above, or the equation that both have in common.
  int residual(int equation) {
    const int a = below_.record().residual(equation), b = above_.record().residual(equation);
    const Pair numbers = pair_of(numbers_, a, b), values = pair_of(values_, a, b);
    const bool is_shared = numbers.is_same();
    if (is_shared && values.is_same()) return values.below;
    const std::string name = below_.record().name(equation);
    const bool has_derivatives = contains_derivatives(below_.record(), equation);
    if (has_derivatives != contains_derivatives(above_.record(), equation))
      throw Failure(SFDAE_ILLEGAL_ARGUMENT, name + " contains x' in one of the modes only: they cannot be combined.");
    if (!is_shared) {
      is_different_ = true;
      Recorder scratch(recorder_);
      demand_equal_factors(scratch, factors_in(scratch, numbers, has_derivatives), name, has_derivatives);
    }
    const int by_values = combined(values.below, pair_of(values_at_rest_, a, b));
    const Factors factors = factors_in(recorder_, values, has_derivatives);
    const bool are_same = has_derivatives ? factors.are_same() : shares_one(factors);
    if (are_same && !is_shared) return by_values;
    const int by_numbers = is_shared ? numbers.below : combined(numbers.below, pair_of(numbers_at_rest_, a, b));
    if (are_same) return with_derivatives(by_numbers, by_values, recorder_.constant(1.0));
    const int j = has_derivatives ? only_one(factors) : -1;
    if (j < 0)
      throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                    name +
                        ": its factors are the same in both modes by the values of parameters only, and there are "
                        "no sensitivities by these parameters. Give them one name in both modes.");
    const Pair field = fields(pair_of(values_at_rest_, a, b), {factors.below[index(j)], factors.above[index(j)]});
    return with_derivatives(by_numbers, combined(field.below, field), factors.below[index(j)]);
  }

 private:
  Copies copies(Derivatives derivatives, bool keeps_parameters) {
    const auto copy = [&](const TaylorEvaluator& mode) {
      if (!keeps_parameters) return copy_values(mode, derivatives, recorder_);
      const auto node_of = [&](int k) {
        return kept_.node(recorder_, mode.record().parameters()[index(k)].name, mode.parameter(k));
      };
      return copy_with(node_of, mode.record(), derivatives, recorder_);
    };
    Copies result;
    result.below = copy(below_);
    result.above = copy(above_);
    return result;
  }
  Factors factors_in(Recorder& recorder, const Pair& nodes, bool has_derivatives) const {
    std::vector<int> leaves;
    for (int j = 0; j < below_.record().n(); ++j)
      leaves.push_back(has_derivatives ? recorder.derivative(j) : recorder.unknown(j));
    return {symbolic_gradient(recorder, nodes.below, leaves), symbolic_gradient(recorder, nodes.above, leaves)};
  }
  bool shares_one(const Factors& factors) const {
    for (int j = 0; j < below_.record().n(); ++j)
      if (factors.is_same(j) && recorder_.number(factors.below[index(j)]) != 0.0) return true;
    return false;
  }
  // -1: there are several.
  int only_one(const Factors& factors) const {
    int found = -1;
    for (int j = 0; j < below_.record().n(); ++j) {
      if (factors.is_same(j) && recorder_.number(factors.below[index(j)]) == 0.0) continue;
      if (found >= 0) return -1;
      found = j;
    }
    return found;
  }
  // If x'_j is alone, the rest divided by its factors: the fields of the modes.
  Pair fields(const Pair& rest, const Pair& factors) {
    return {recorder_.apply(Operation::divide, rest.below, factors.below),
            recorder_.apply(Operation::divide, rest.above, factors.above)};
  }
  // first + s (above - below)
  int combined(int first, const Pair& pair) {
    const int difference = recorder_.apply(Operation::subtract, pair.above, pair.below);
    return recorder_.apply(Operation::add, first, recorder_.apply(Operation::multiply, part_, difference));
  }
  // The equation with numbers, plus a factor times the derivatives by parameters of another one.
  int with_derivatives(int by_numbers, int by_values, int factor) {
    const std::vector<int> gradient = symbolic_gradient(recorder_, by_values, leaves_);
    int sum = by_numbers;
    for (std::size_t j = 0; j < leaves_.size(); ++j) {
      const int zero = recorder_.apply(Operation::subtract, leaves_[j], recorder_.constant(values_now_[j]));
      const int derivative = recorder_.apply(Operation::multiply, factor, gradient[j]);
      sum = recorder_.apply(Operation::add, sum, recorder_.apply(Operation::multiply, zero, derivative));
    }
    return sum;
  }

  const TaylorEvaluator &below_, &above_;
  const KeptParameters& kept_;
  Recorder recorder_;
  std::vector<int> leaves_;                                     // the parameters that stay,
  std::vector<double> values_now_;                              // and their values
  Copies numbers_, numbers_at_rest_, values_, values_at_rest_;  // at rest: with x' = 0
  int part_ = -1;
  bool is_different_ = false;
};

EquationNames names_of(const Record& below) {
  std::vector<std::string> names;
  for (int i = 0; i < below.m(); ++i) names.push_back(below.equation_names()[i]);
  names.emplace_back("surface");
  return EquationNames(std::move(names));
}

}  // namespace

TaylorEvaluator surface_in_modes(std::shared_ptr<const Record> surface, const TaylorEvaluator& below,
                                 const TaylorEvaluator& above) {
  TaylorEvaluator given(std::move(surface));
  for (int i = 0; i < given.num_parameters(); ++i)
    for (const TaylorEvaluator* mode : {&above, &below})
      if (const auto k = mode->find_parameter(given.record().parameters()[index(i)].name))
        given.set_parameter(i, mode->parameter(*k));
  return given;
}

KeptParameters::KeptParameters(const std::vector<std::string>& names, const TaylorEvaluator& below,
                               const TaylorEvaluator& above, const TaylorEvaluator& surface) {
  for (const TaylorEvaluator* one : {&below, &above, &surface})
    for (int i = 0; i < one->num_parameters(); ++i) {
      const std::string& name = one->record().parameters()[index(i)].name;
      if (number_of(name) < 0) all_.push_back({name, one->parameter(i)});
    }
  for (const Parameter& parameter : all_)
    stays_.push_back(std::find(names.begin(), names.end(), parameter.name) != names.end());
}

bool KeptParameters::is_empty() const { return std::find(stays_.begin(), stays_.end(), true) == stays_.end(); }

int KeptParameters::number_of(const std::string& name) const {
  const auto is_it = [&](const Parameter& parameter) { return parameter.name == name; };
  const auto found = std::find_if(all_.begin(), all_.end(), is_it);
  return found != all_.end() ? static_cast<int>(found - all_.begin()) : -1;
}

int KeptParameters::node(Recorder& recorder, const std::string& name, double value) const {
  const int number = number_of(name);
  if (number < 0 || !stays(number)) return recorder.constant(value);
  const Parameter& parameter = all_[index(number)];
  const int node = recorder.parameter(name, parameter.value);
  if (parameter.value == value) return node;
  const int change = recorder.apply(Operation::subtract, node, recorder.constant(parameter.value));
  return recorder.apply(Operation::add, recorder.constant(value), change);
}

std::shared_ptr<const Record> surface_of_modes(const TaylorEvaluator& surface, const KeptParameters& kept) {
  const Record& record = surface.record();
  if (contains_derivatives(record, 0))
    throw Failure(SFDAE_ILLEGAL_ARGUMENT, "the surface depends on x': it may depend on t and x alone.");
  if (record.entries(0).empty())
    throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                  "the surface does not depend on x: a change at a time is SFDAE_TRANSITION_TIME.");
  Recorder recorder(record.n());
  const auto node_of = [&](int k) {
    return kept.node(recorder, record.parameters()[index(k)].name, surface.parameter(k));
  };
  const std::vector<int> copies = copy_with(node_of, record, Derivatives::kept, recorder);
  return recorder.finish({copies[index(record.residual(0))]});
}

std::shared_ptr<const Record> sliding_equations(const TaylorEvaluator& below, const TaylorEvaluator& above,
                                                const Record& surface, const KeptParameters& kept) {
  const int m = below.record().m();
  if (above.record().m() != m)
    throw Failure(SFDAE_ILLEGAL_ARGUMENT,
                  format("the modes have %d and %d equations: they cannot be combined.", m, above.record().m()));
  Combination combination(below, above, kept);
  std::vector<int> residuals;
  for (int i = 0; i < m; ++i) residuals.push_back(combination.residual(i));
  if (!combination.is_different())
    throw Failure(SFDAE_ILLEGAL_ARGUMENT, "both modes have the same equations, so that nothing switches.");
  Recorder& recorder = combination.recorder();
  const std::vector<int> copies = copy_nodes(surface, recorder);
  residuals.push_back(copies[index(surface.residual(0))]);
  return recorder.finish(std::move(residuals), names_of(below.record()));
}

}  // namespace sfdae::core
