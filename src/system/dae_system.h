// What the driver of an integration sees of a system: beyond what integrators need, how it came about and how it is
// doing. SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "linalg/archive.h"
#include "problem/failure.h"
#include "problem/problem.h"
#include "reduction/index_analysis.h"
#include "reduction/null_space_form.h"
#include "system/strangeness_free_system.h"

namespace sfdae::core {

class DaeSystem : public StrangenessFreeSystem {
 public:
  virtual int equations() const = 0;  // m
  virtual Problem& problem() = 0;
  virtual const IndexAnalysis& analysis() const = 0;
  virtual LeadingTerm leading_term() const = 0;
  virtual const CallbackError& callback_error() const = 0;  // the last one
  // The point moved to last.
  virtual double t() const = 0;

  // Contradiction of redundant equations, relative.
  virtual double inconsistency() const = 0;
  virtual std::string inconsistency_message() const {
    return format(
        "redundant equations contradict each other at t = %.15g: relative residual %.3g of Z3^T g = 0. There is "
        "no solution; correct the equations, or set ignore_inconsistency.",
        t(), inconsistency());
  }
  // What there is to say about a change of the characteristic values that was met last; empty: nothing.
  virtual std::string about_change() const { return {}; }
  // Smallest values kept in the decisions on A^ and E T2, relative; they dip where characteristic values change.
  virtual double kept_constraints() const = 0;
  virtual double kept_differential() const = 0;
  virtual double smallest_pivot() const = 0;

  // rank E has turned out not to be constant: another leading term from now on.
  virtual void give_up_projector() {}
  // x' of the solution through the consistent x at the current point, free directions held; true if it comes from the
  // derivative array, false if it had to be computed otherwise, looking in the given direction (+1 or -1). The
  // current point is still the same afterwards.
  virtual bool consistent_derivative(const double* x, double direction, double* xdot) = 0;
  // The same from the derivative array only; false, and xdot as it was, if that is not possible.
  virtual bool exact_derivative(const double* x, double* xdot) = 0;
  // (W x)' given x and x' at the current point.
  virtual void leading_derivative(const double* x, const double* xdot, double* wdot) = 0;

  // Errors of the components of x that rounding in the equations causes near the point; null: negligible.
  virtual const double* rounding_errors() const { return nullptr; }

  // Whether the characteristic values hold at the current point, where that has not been looked at. What later steps
  // depend on stays as it is.
  virtual PointStatus check_ranks() { return PointStatus::ok; }

  virtual void archive(Archive& archive) = 0;
  virtual long reductions() const = 0;
  virtual long factorizations() const = 0;
};

}  // namespace sfdae::core
