// Formulas evaluated in numbers.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulation/system.h"

namespace sfdae::cli {

// What formulas are evaluated with.
struct Values {
  explicit Values(const System& system);

  double t = 0.0;
  // Of the variables of the model, then of the conditions of when clauses; of what was eliminated only where a tape has
  // stored it.
  std::vector<double> variable, previous;
  std::vector<double> derivative;
  std::vector<double> switches, samples;
  bool is_initial = false, is_terminal = false;
};

// NaN is the same as NaN.
bool are_same(double a, double b);
bool are_same(const std::vector<double>& a, const std::vector<double>& b);

// Formulas as a list of instructions; what they share is evaluated once.
class Tape {
 public:
  explicit Tape(const Formulas& formulas) : formulas_(formulas) {}

  int add(Formula formula);  // its number, for operator[]

  // Evaluates what is added later with the new value of the variable.
  void add_assignment(int variable, Formula value);

  void run(Values& values) { execute(values, &values); }
  // The same without assignments.
  void evaluate(const Values& values) { execute(values, nullptr); }

  // Derivatives of what run or evaluate has computed last, in a direction: entries for the variables of the model.
  // Derivatives der() and what is discrete stay.
  void differentiate(const std::vector<double>& direction);
  double tangent(int number) const { return tangents_[at(outputs_[at(number)])]; }

  double operator[](int number) const { return registers_[at(outputs_[at(number)])]; }
  int size() const { return static_cast<int>(outputs_.size()); }

 private:
  struct Instruction {
    Operation operation;
    int index;  // what is read; of an assignment what is written
    int a, b, c;
    double value;
    bool is_frozen, is_assignment;
  };

  int compiled(Formula formula);
  void compile(Formula formula);
  void execute(const Values& values, Values* assigned);
  static double read(const Instruction& instruction, const Values& values);

  const Formulas& formulas_;
  std::vector<int> register_of_;  // of each formula
  std::vector<Instruction> instructions_;
  std::vector<double> registers_, tangents_;
  std::vector<int> outputs_;
};

}  // namespace sfdae::cli
