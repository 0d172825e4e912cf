// The equations of the motion along a surface that two modes lead to.
//
// [Fil88] A. F. Filippov: Differential Equations with Discontinuous Righthand Sides. Kluwer, 1988. Paragraph 4: the
// sets of fields that the motion along a surface may follow.
//
// With F_b = 0 below the surface g(t, x) = 0 and F_a = 0 above it: (1 - s) F_b + s F_a = 0, g = 0 for x and the part
// s of the mode above, 0 ... 1. Equations that both modes have are taken once. x' is in the others with the same
// factors, so that fields are combined as in [Fil88] where these equations contain nothing else that differs.
//
// What the modes have in common is judged with the numbers that parameters have. Those by which derivatives are
// wanted stay parameters: a value p of a mode becomes the number p + (parameter - its value). Where modes have the
// same number by different parameters, derivatives by these are added to the equation, each times a factor that is
// zero: it has the form that numbers give it, and the derivatives by parameters of (1 - s) F_b + s F_a; where its
// x'_j has other factors e_b and e_a as soon as parameters move, of fields, e (1 - s) f_b / e_b + e s f_a / e_a with
// F = e x'_j + f.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "expression/recorder.h"
#include "expression/taylor_evaluator.h"
#include "linalg/index.h"

namespace sfdae::core {

// g(t, x) with the values that its parameters have in the modes, where these have them.
TaylorEvaluator surface_in_modes(std::shared_ptr<const Record> surface, const TaylorEvaluator& below,
                                 const TaylorEvaluator& above);

// Parameters that stay, each with the value that the mode below has for it, or the mode above, or the surface. Those
// that do not have numbers as well, so that a number means one parameter whatever stays.
class KeptParameters {
 public:
  // Of these names those that there are.
  KeptParameters(const std::vector<std::string>& names, const TaylorEvaluator& below, const TaylorEvaluator& above,
                 const TaylorEvaluator& surface);
  const std::vector<Parameter>& all() const { return all_; }
  bool stays(int parameter) const { return stays_[index(parameter)]; }
  bool is_empty() const;
  // The node for a parameter of this name that has this value: a number, unless it is one of these.
  int node(Recorder& recorder, const std::string& name, double value) const;

 private:
  int number_of(const std::string& name) const;  // -1: there is none

  std::vector<Parameter> all_;
  std::vector<bool> stays_;
};

// g(t, x) with numbers in place of parameters that do not stay. Throws Failure: x' in it, no x.
std::shared_ptr<const Record> surface_of_modes(const TaylorEvaluator& surface, const KeptParameters& kept);

// m + 1 equations for n + 1 unknowns, the last one g of surface_of_modes. The parameters are all, with the numbers
// that they have in the list. Throws Failure for equations that cannot be combined.
std::shared_ptr<const Record> sliding_equations(const TaylorEvaluator& below, const TaylorEvaluator& above,
                                                const Record& surface, const KeptParameters& kept);

}  // namespace sfdae::core
