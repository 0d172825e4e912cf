// Numerical evaluation of formulas.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulation/system.h"

namespace sfdae::cli {

// Arguments of formulas.
struct Values {
  explicit Values(const System& system);

  double t = 0.0;
  // Variables of the model, then conditions of when clauses; eliminated variables only if a tape has stored them.
  std::vector<double> variable, previous;
  std::vector<double> derivative;
  std::vector<double> switches, samples;
  bool is_initial = false, is_terminal = false;
};

// Equality that treats NaN as equal to NaN.
bool are_same(double a, double b);
bool are_same(const std::vector<double>& a, const std::vector<double>& b);

// Formulas as a list of instructions; shared parts are evaluated once.
class Tape {
 public:
  explicit Tape(const Formulas& formulas) : formulas_(formulas) {}

  int add(Formula formula);  // its number, for operator[]

  // Later additions are evaluated with the new value of the variable.
  void add_assignment(int variable, Formula value);

  void run(Values& values) { execute(values, &values); }
  // The same without assignments.
  void evaluate(const Values& values) { execute(values, nullptr); }

  // Directional derivative of the last run or evaluate; direction has entries for the variables of the model.
  // Derivatives der() and discrete quantities are constant.
  void differentiate(const std::vector<double>& direction);
  double tangent(int number) const { return tangents_[at(outputs_[at(number)])]; }

  double operator[](int number) const { return registers_[at(outputs_[at(number)])]; }
  int size() const { return static_cast<int>(outputs_.size()); }

 private:
  struct Instruction {
    Operation operation;
    int index;  // of the quantity read; for an assignment, the one written
    int a, b, c;
    double value;
    bool is_frozen, is_assignment;
  };

  int compiled(Formula formula);
  void compile(Formula formula);
  void execute(const Values& values, Values* assigned);
  static double read(const Instruction& instruction, const Values& values);

  const Formulas& formulas_;
  std::vector<int> register_of_;  // by formula
  std::vector<Instruction> instructions_;
  std::vector<double> registers_, tangents_;
  std::vector<int> outputs_;
};

}  // namespace sfdae::cli
