// Values of constants and parameters, and of expressions of them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "model/flat_model.h"

namespace sfdae::cli {

// Bindings are evaluated in the order of their dependence. Throws ModelError for cyclic, missing or undefined values
// and for values that cannot be set.
class Parameters {
 public:
  // given: values by name that replace those of the model, for parameters, inputs and start values.
  Parameters(const FlatModel& model, const std::map<std::string, double>& given, std::vector<std::string>& warnings);

  bool is_known(int variable) const { return states_[index(variable)] == State::known; }
  // Free: determined by the initial equations. Derived: given by a binding with free parameters.
  bool is_free(int variable) const { return states_[index(variable)] == State::free; }
  bool is_derived(int variable) const { return states_[index(variable)] == State::derived; }

  // The value if known; the initial guess if free or derived.
  double value(int variable) const { return values_[index(variable)]; }

  // The value of an expression of constants and parameters; free ones have their initial guesses.
  double value(const Expression& expression);

  // The start value of any variable, if it has one; only an initial guess if it depends on free parameters.
  std::optional<double> start(int variable);

  // Start values that replace those of the model.
  const std::map<int, double>& given_starts() const { return given_starts_; }

 private:
  enum class State { other, unvisited, visiting, known, free, derived };

  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
  void classify(const std::map<std::string, double>& given);
  void set_given(const std::string& name, int variable, double value);
  void find(int variable);
  double evaluate(const Node& node);
  double guess(int variable);
  double evaluate_operation(const Node& node);
  [[noreturn]] void fail(const Variable& variable, const std::string& text) const;

  const FlatModel& model_;
  std::vector<std::string>& warnings_;
  std::vector<State> states_;
  std::vector<double> values_;
  std::map<int, double> given_starts_;
  std::unordered_map<const Node*, double> evaluated_;
  bool depends_on_free_ = false;  // for the current evaluation
  Location at_;                   // position of the current evaluation
};

}  // namespace sfdae::cli
