// A flat model: scalar variables, equations and conditions; all names are resolved, arrays, records and functions are
// expanded. Readers of a language produce it, and the simulation solves it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "model/expression.h"

namespace sfdae::cli {

enum class Type { real, integer, boolean, enumeration };
enum class Variability { constant, parameter, discrete, continuous };
enum class StateSelect { never, avoid, standard, prefer, always };

struct Variable {
  std::string name;  // as the user wrote it, without quotes
  Type type = Type::real;
  // Declared or implied: Integers, Booleans, enumerations and variables assigned in a when clause are discrete.
  Variability variability = Variability::continuous;
  bool is_input = false, is_output = false;
  // The binding of a constant or parameter; none: `start` is its value, unless it is free. The reader turns bindings of
  // other variables into equations.
  Expression binding;
  Expression start, nominal, min, max;  // none: not given; formulas of constants and parameters
  bool is_fixed = false;       // start holds initially; a parameter: it is not computed from initial equations
  bool is_structural = false;  // a parameter whose value the reader has used: it can no longer be changed
  StateSelect state_select = StateSelect::standard;
  std::string unit, display_unit, description;
  std::vector<std::string> literals;  // for an enumeration
  Location at;
};

// 0 = left - right. A discrete equation determines the discrete variable on its left side.
struct Equation {
  Expression left, right;
  Location at;
};

struct Assertion {
  Expression condition;
  std::string message;
  bool is_error = true;  // else a warning
  Location at;
};

// An action of a when clause, executed when one of its conditions becomes true.
struct Action {
  enum class Kind { assign, reinit, assertion, terminate };
  Kind kind = Kind::assign;
  int variable = -1;  // for assign and reinit
  Expression value;   // for assign and reinit; the condition of an assertion
  std::string message;
  bool is_error = true;  // for an assertion
  Location at;
  Expression guard = nullptr;  // of reinit and terminate: the action is executed if it holds; null: always
};

struct WhenBranch {
  std::vector<Expression> conditions;  // one has to become true
  std::vector<Action> actions;
};

// The first branch whose condition becomes true is executed.
struct When {
  std::vector<WhenBranch> branches;
  Location at;
};

struct Experiment {
  std::optional<double> start, stop, tolerance, interval;
};

struct FlatModel {
  std::string file, name, description;
  std::vector<Variable> variables;
  std::vector<Equation> equations, initial_equations;
  std::vector<When> whens;
  std::vector<Assertion> assertions;
  Experiment experiment;
  std::vector<std::string> warnings;  // of the reader, each with file, line and column
};

// An error in a model or its file; what() gives file:line:column, the error and a remedy.
class ModelError : public std::runtime_error {
 public:
  ModelError(const std::string& file, Location at, const std::string& text);
  Location at() const { return at_; }

 private:
  Location at_;
};

}  // namespace sfdae::cli
