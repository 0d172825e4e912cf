// Equations of the motion along a surface that two modes lead to.
//
// [Fil88] A. F. Filippov: Differential Equations with Discontinuous Righthand Sides. Kluwer, 1988. Paragraph 4: the
// sets of fields that the motion along a surface may follow.
//
// With F_b = 0 below the surface g(t, x) = 0 and F_a = 0 above it: (1 - s) F_b + s F_a = 0, g = 0 for x and the part s
// of the mode above, 0 ... 1. Equations that both modes share are used once. x' has the same factors in the other
// equations, so that fields are combined as in [Fil88] if these equations differ in nothing else.
//
// Equations are compared by the numbers that parameters have. Parameters of wanted derivatives remain parameters: a
// value p of a mode becomes the number p + (parameter - its value). If modes have the same number by different
// parameters, derivatives by these are added to the equation, each times a factor that is zero. The equation then has
// the form that numbers give it, and the derivatives by parameters of (1 - s) F_b + s F_a; or, if the factors e_b and
// e_a of its x'_j differ as soon as parameters move, those of fields, e (1 - s) f_b / e_b + e s f_a / e_a with F = e
// x'_j + f.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "expression/recorder.h"
#include "expression/taylor_evaluator.h"
#include "linalg/index.h"

namespace sfdae::core {

// g(t, x) with the values that its parameters have in the modes, if these have them.
TaylorEvaluator surface_in_modes(std::shared_ptr<const Record> surface, const TaylorEvaluator& below,
                                 const TaylorEvaluator& above);

// Parameters that remain, each with its value in the mode below, else in the mode above, else in the surface. The
// others are numbered as well, so that a number always means the same parameter.
class KeptParameters {
 public:
  // Keeps the existing ones of these names.
  KeptParameters(const std::vector<std::string>& names, const TaylorEvaluator& below, const TaylorEvaluator& above,
                 const TaylorEvaluator& surface);
  const std::vector<Parameter>& all() const { return all_; }
  bool stays(int parameter) const { return stays_[index(parameter)]; }
  bool is_empty() const;
  // The node for a parameter of this name and value: a number, unless the parameter is one that remains.
  int node(Recorder& recorder, const std::string& name, double value) const;

 private:
  int number_of(const std::string& name) const;  // -1: there is none

  std::vector<Parameter> all_;
  std::vector<bool> stays_;
};

// g(t, x) with numbers in place of parameters that do not remain. Throws Failure if g contains x', or no x.
std::shared_ptr<const Record> surface_of_modes(const TaylorEvaluator& surface, const KeptParameters& kept);

// m + 1 equations for n + 1 unknowns, the last one g of surface_of_modes. Has all parameters, numbered as in the list.
// Throws Failure for equations that cannot be combined.
std::shared_ptr<const Record> sliding_equations(const TaylorEvaluator& below, const TaylorEvaluator& above,
                                                const Record& surface, const KeptParameters& kept);

}  // namespace sfdae::core
