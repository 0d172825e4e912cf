// A flat model: scalar variables, equations and conditions, every name resolved, arrays, records and functions
// expanded. What a reader of a language makes, and what the simulation solves.
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
  // Declared or implied: Integer, Boolean, enumeration and what a when clause assigns are discrete.
  Variability variability = Variability::continuous;
  bool is_input = false, is_output = false;
  // Of a constant or parameter: its binding; none: `start` is its value, unless it is free. Of others the reader
  // makes an equation of it.
  Expression binding;
  Expression start, nominal, min, max;  // none: not given; formulas of constants and parameters
  bool is_fixed = false;       // start holds initially; a parameter: it is not computed from initial equations
  bool is_structural = false;  // a parameter whose value the reader has used: it cannot be changed any more
  StateSelect state_select = StateSelect::standard;
  std::string unit, display_unit, description;
  std::vector<std::string> literals;  // of an enumeration
  Location at;
};

// 0 = left - right. A discrete one determines the discrete variable that is its left side.
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

// What a when clause does when one of its conditions becomes true.
struct Action {
  enum class Kind { assign, reinit, assertion, terminate };
  Kind kind = Kind::assign;
  int variable = -1;  // of assign and reinit
  Expression value;   // of assign and reinit; the condition of an assertion
  std::string message;
  bool is_error = true;  // of an assertion
  Location at;
};

struct WhenBranch {
  std::vector<Expression> conditions;  // one has to become true
  std::vector<Action> actions;
};

// The first branch whose condition becomes true acts.
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

// What is wrong with a model or its file; what() says file:line:column, what it is and what to do.
class ModelError : public std::runtime_error {
 public:
  ModelError(const std::string& file, Location at, const std::string& text);
  Location at() const { return at_; }

 private:
  Location at_;
};

}  // namespace sfdae::cli
