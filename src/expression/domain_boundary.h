// Operations at the boundary of their domain: sqrt, log and powers below 1 at 0, asin and acos at 1 and -1.
//
// The value exists there (but for log), its derivative is infinite. An iteration matrix only has to be good enough for
// the iterations to converge, as F itself is evaluated before a point is accepted (docs/design/steps.md, section 5). So
// it gets the slope of a nearby point inside of the domain, as a finite-difference Jacobian does: all unknowns move by
// about their tolerances, and the distance by which the operand moves is that of the point from the boundary. The slope
// is finite, so that products with a factor 0 have their limit: |v| v as sqrt(v^2) v has the derivative 0 at v = 0. An
// operand that is outside of the domain by less than this distance counts as at the boundary: x is not known better.
//
// Taylor coefficients along a solution: those of a constant operand are 0, as that of sqrt(max(h, 0)) for h < 0. Let
// the operand be O(s^r). A power e of it is O(s^(r e)), so coefficients k < r e are 0. The others have different values
// on both sides of the point if r e is an integer, as those of sqrt(u^2 + v^2) at rest, and are infinite else. In the
// first case they count as unknown, as the value of log(0) does: residuals must not depend on them, which is tested by
// two executions with different numbers in their place. In u sqrt(u^2 + v^2) the factor 0 makes it so.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "expression/tape.h"

namespace sfdae::core {

// Distances by which unknowns may move: tolerances of each unknown, or one for all.
struct Movement {
  std::vector<double> rtol{1e-6}, atol{1e-6};
  // The movement of unknown j, or of its derivative, from a value; it is not 0.
  double of(int j, double value) const;
};

// Executes instructions again, at the point and at the moved one, on slots with the values of an ordinary execution.
class BoundarySweep {
 public:
  // Values in place of unknown ones: those of a nearby point, or 0; other numbers, far above these; or none, so that a
  // diagnosis finds them.
  enum class Unknowns { near, other, none };
  // stride: of slots.
  BoundarySweep(const Tape& tape, const Movement& movement, std::vector<double>& slots, int stride,
                Unknowns unknowns);
  // of_state: they depend on unknowns.
  void execute(const InstructionList& list, int order, bool with_slopes, bool of_state);
  // An operation is at the boundary of its domain.
  bool has_found_boundary() const { return has_found_boundary_; }
  bool has_unknowns() const { return has_unknowns_; }

 private:
  void execute_other(const Instruction& instruction, int order, bool with_slopes);
  void move(const Instruction& instruction);
  void correct(const Instruction& instruction, int order, bool with_slopes);
  void set_slopes(const Instruction& instruction, int order, double distance, bool exist);
  bool set_coefficients(const Instruction& instruction, int order);
  double in_place(double near) const;

  double* slots_;
  std::vector<double> moved_;  // coefficients of order 0 are those of the moved point
  Unknowns unknowns_;
  bool is_of_state_ = false;
  bool has_found_boundary_ = false, has_unknowns_ = false;
};

}  // namespace sfdae::core
