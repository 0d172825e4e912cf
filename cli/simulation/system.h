// A flat model prepared for the solution: numbers in place of parameters, few unknowns, all expressions as formulas.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "model/flat_model.h"
#include "simulation/formulas.h"

namespace sfdae::cli {

// A value that is constant between events: that of a relation g op 0, or of floor(g) or trunc(g).
struct Switch {
  enum class Kind { relation, floor, truncate };
  Kind kind = Kind::relation;
  Operation operation = Operation::less;  // of a relation
  Formula g = -1;
  // g = slope t + offset with an offset that is constant between events: the time of the next event is known.
  bool is_by_time = false;
  double slope = 0.0;
  Formula offset = -1;
  bool has_root = false;  // else, unless is_by_time, g is constant between events
  double nominal = 1.0;   // magnitude of the compared quantities
  std::string text;
  Location at;
};

// 1 at the times start + i interval, i >= 0.
struct Sample {
  double start = 0.0, interval = 1.0;
  std::string text;
  Location at;
};

// variable := value at events.
struct DiscreteAssignment {
  int variable = -1;
  Formula value = -1;
  Location at;
};

// An action at an event while `active` is 1; reinit: variable := value.
struct Reaction {
  Action::Kind kind = Action::Kind::reinit;
  Formula active = -1, value = -1;
  int variable = -1;
  std::string message;
  bool is_error = true;
  Location at;
};

// 0 = residual.
struct Residual {
  Formula formula = -1;
  Location at;
};

// An initial condition left = right; the value of an unknown if variable >= 0.
struct InitialCondition {
  Formula left = -1, right = -1;
  Location at;
  std::string text;
};

// v = sign root + offset; a root is its own alias. Constants have the root -1.
struct Alias {
  int root = -1;
  double sign = 1.0, offset = 0.0;
};

// min <= variable <= max
struct CheckedVariable {
  int variable = -1;
  Formula min = -1, max = -1;
};

// Discrete equations, evaluated at events in addition to reactions.
struct DiscreteEquations {
  std::vector<DiscreteAssignment> discrete;  // in the order of their evaluation
  bool has_loop = false;                     // an algebraic loop, evaluated repeatedly
  std::vector<DiscreteAssignment> initial;   // initial values of pre(variable)
  std::vector<Formula> when_conditions;      // one for each virtual variable after those of the model
};

// Magnitudes by variable.
struct Sizes {
  std::vector<double> nominal;
  std::vector<double> scale;  // as nominal; without a nominal value of the model, start values below 1 also count
};

// Start values by variable.
struct Starts {
  std::vector<char> are_given;    // the model gives a start value
  std::vector<double> numbers;    // if none: 0, enumerations 1; roots use those of aliases
  std::vector<Formula> formulas;  // as formulas; numbers contain initial guesses of free parameters
  std::vector<Formula> own;       // without those of aliases
};

struct System {
  explicit System(const FlatModel& it, std::vector<unsigned> dependence)
      : model(it), formulas(std::move(dependence)) {}

  const FlatModel& model;
  Formulas formulas;
  std::vector<int> unknowns;         // variables of the model that the library solves for
  std::vector<Residual> residuals;   // in unknowns, discrete quantities and free parameters
  std::vector<Formula> values;       // by variable, in the same; -1: an unused free parameter of another type
  std::vector<Location> defined_at;  // by variable: the equation that gives it, if known
  std::vector<Alias> aliases;        // by variable of type Real
  std::vector<int> free_parameters;

  std::vector<Switch> switches;
  std::vector<Sample> samples;
  DiscreteEquations at_events;
  std::vector<Reaction> reactions;
  std::vector<InitialCondition> initial_conditions;
  int num_eliminated = 0;
  int num_replaced_states = 0;  // differentiated variables of the model that were replaced; this lowers the index
  Sizes sizes;
  Starts starts;
  std::vector<char> is_state;  // by variable: its derivative occurs
  // By variable: x' = f(states, t), so that x is continuous when forces and velocities jump.
  std::vector<char> is_continuous_at_impulses;
  std::vector<CheckedVariable> checked;

  bool is_unknown(int variable) const {
    const FormulaNode& node = formulas[values[at(variable)]];
    return node.operation == Operation::variable && node.index == variable;
  }
};

}  // namespace sfdae::cli
