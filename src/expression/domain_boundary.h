// Operations at the boundary of their domain: sqrt and powers below 1 at 0, asin and acos at 1 and -1.
//
// The value exists there, its derivative is infinite. An iteration matrix only has to be good enough for the iterations
// to converge, as F itself is evaluated before a point is accepted (docs/design/steps.md, section 5). So it gets the
// slope of a nearby point inside of the domain, as a finite-difference Jacobian does: all unknowns are moved by about
// their tolerances, and the distance by which the operand moves is that of the point from the boundary. The slope is
// finite, so that products with a factor 0 have their limit: |v| v as sqrt(v^2) v has the derivative 0 at v = 0.
//
// Taylor coefficients along a solution are not replaced. They are 0 if the operand is a constant, as that of
// sqrt(max(h, 0)) is for h < 0. Else they do not exist (NaN), and neither do those of the slope.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "expression/tape.h"

namespace sfdae::core {

// By how much unknowns may move: the tolerances of one unknown, or one for all.
struct Movement {
  std::vector<double> rtol{1e-6}, atol{1e-6};
  // The movement of unknown j, or of its derivative, from a value; it is not 0.
  double of(int j, double value) const;
};

// Executes instructions once more, for slots whose values an ordinary execution has left behind, at the point and at
// the moved one.
class BoundarySweep {
 public:
  // stride: of slots.
  BoundarySweep(const Tape& tape, const Movement& movement, std::vector<double>& slots, int stride);
  void execute(const InstructionList& list, int order, bool with_slopes);
  // An operation is at the boundary of its domain.
  bool has_found_boundary() const { return has_found_boundary_; }

 private:
  void execute_other(const Instruction& instruction, int order, bool with_slopes);
  void move(const Instruction& instruction);
  void correct(const Instruction& instruction, int order, bool with_slopes);

  double* slots_;
  std::vector<double> moved_;  // coefficients of order 0 are those of the moved point
  bool has_found_boundary_ = false;
};

}  // namespace sfdae::core
