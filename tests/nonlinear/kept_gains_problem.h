// A problem that the reference and the library are given in different forms: the reference its states only, the
// library equations with further unknowns.
// SPDX-License-Identifier: BSD-3-Clause
#ifndef SFDAE_TESTS_NONLINEAR_KEPT_GAINS_PROBLEM_H
#define SFDAE_TESTS_NONLINEAR_KEPT_GAINS_PROBLEM_H

#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "families.h"

namespace sfdae_test::kept_gains {

using campaign::Formula, campaign::Formulas, campaign::Law, campaign::LawOfCase, campaign::RandomNumbers;
using campaign::SmallProblem;

struct Problem {
  campaign::Case data;
  std::string text;
  bool is_multibody = false, has_sum = false;
  // The library knows nothing of callbacks between the points where they are called, and so of peaks of inputs there.
  double max_step_of_callbacks = 0.0;
  double reference_tolerance = 1e-10;  // of a step
};

// Writes unknowns and equations of one copy: first the states of the reference, then unknowns with known values.
class Writer {
 public:
  Writer() { problem_.formulas = std::make_shared<Formulas>(); }
  Formula time() { return problem_.formulas->time(); }
  Formula number(double value) { return problem_.formulas->number(value); }
  Formula state(const std::string& name, double start, bool is_differential = true) {
    problem_.differential.push_back(is_differential);
    problem_.start.push_back(start);
    return unknown(name);
  }
  void start_at(int state, double start) { problem_.start[static_cast<std::size_t>(state)] = start; }
  Formula value(const std::string& name, Formula value) {
    problem_.values.push_back(value);
    return unknown(name);
  }
  Formula slope(Formula unknown) { return problem_.formulas->slope(problem_.formulas->node(unknown.node).index); }
  // The next equation that the reference solves, one for each state: x' = f, or 0 = f.
  void reference(Formula f) { problem_.f.push_back(f); }
  // 0 = residual, as the library has it.
  void equation(Formula residual) { problem_.residuals.push_back(residual); }
  SmallProblem finish(double feature) {
    problem_.feature = feature;
    return problem_;
  }

 private:
  Formula unknown(const std::string& name) {
    problem_.names.push_back(name);
    return problem_.formulas->unknown(problem_.num_unknowns() - 1);
  }

  SmallProblem problem_;
};

// The law of u as a callback of the user's.
inline LawOfCase opaque(Law hidden) {
  LawOfCase law{Law::opaque, hidden, {}};
  return law;
}
inline std::string text(double number) {
  std::array<char, 32> digits{};
  std::snprintf(digits.data(), digits.size(), "%.6g", number);
  return digits.data();
}
inline std::string name_of(const LawOfCase& law) {
  const auto name = [](Law one) { return std::string(campaign::law_names[static_cast<std::size_t>(one)]); };
  return name(law.law) + (law.law == Law::opaque ? " of " + name(law.hidden) : "");
}
inline int random_copies(RandomNumbers& random) { return random.chance(0.3) ? 5 : 1; }

}  // namespace sfdae_test::kept_gains

#endif
