// Comparison of a function and its supplied derivative along a line through a point, from one side.
//
// By the mean value theorem a difference quotient equals the derivative somewhere between its points. If a derivative
// hardly changes between them, and functions appear smooth and free of noise, it has to equal the difference quotient,
// too.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "problem/difference_comparison.h"
#include "problem/failure.h"
#include "problem/problem.h"

namespace sfdae::core {

struct SuppliedLine {
  int count;      // of the entries compared
  int shift;      // values[e + shift] is supplied as the derivative of values[e]
  double origin;  // of the parameter, t for example: its rounding counts
  double reach;   // offset of the farthest point of interest, negative: backward
  // Writes all values at an offset from the origin. Values that are not finite are ignored.
  std::function<CallbackError(double offset, double* values)> evaluate;
  std::vector<double> base;  // at offset 0
  // Empty, or for each entry the size of its terms, if that may exceed the value, as for residuals.
  std::vector<double> terms = {};
};

// A supplied derivative, and the difference quotient that contradicts it.
struct LineContradiction {
  int entry;
  double supplied, difference;
  double strength;     // their difference over its uncertainty
  double uncertainty;  // of both
};

// The entries that neither one point nor two more confirm; takes few evaluations if all is right. Both functions throw
// Failure if the function is stopped; other failures leave out the point.
std::vector<int> unconfirmed_entries(const SuppliedLine& line);
// Those of the entries whose derivative contradicts the function beyond doubt: on two scales at least, in the same way,
// and on every scale from the whole reach down to roundoff. least_gap: relative difference that counts.
std::vector<LineContradiction> contradictions(const SuppliedLine& line, const std::vector<int>& entries,
                                              double least_gap);

// Smallest relative difference of a derivative that counts as wrong, so that finite differences as derivatives, or
// slopes of another interpolation, are accepted.
inline constexpr double least_wrong_part = 1e-2;

// SFDAE_WRONG_DERIVATIVES with its message.
class WrongDerivative : public Failure {
 public:
  // names: of the rows.
  WrongDerivative(const DerivativeMismatch& mismatch, double t, const EquationNames& names = {});
  const DerivativeMismatch& mismatch() const { return mismatch_; }

 private:
  DerivativeMismatch mismatch_;
};

}  // namespace sfdae::core
