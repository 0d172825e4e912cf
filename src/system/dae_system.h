// What the driver of an integration sees of a system: beyond what integrators need, how it came about and how it is
// doing.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "linalg/archive.h"
#include "problem/failure.h"
#include "problem/problem.h"
#include "reduction/index_analysis.h"
#include "reduction/null_space_form.h"
#include "system/jet.h"
#include "system/singular_part.h"
#include "system/strangeness_free_system.h"
#include "system/value_change.h"

namespace sfdae::core {

// How far the decisions at a point are from others.
struct PointQuality {
  double inconsistency = 0.0;  // contradiction of redundant equations, relative
  // Smallest values kept in the decisions on A^ and E T2, relative; they dip where characteristic values change.
  double kept_constraints = 1.0, kept_differential = 1.0;
  double smallest_pivot = 1.0;
};

struct SystemCounts {
  long reductions = 0, factorizations = 0;
};

// What a system is made of: a derivative array that is reduced, or is minimal by structure.
enum class SystemForm { reduced, extension };

class DaeSystem : public StrangenessFreeSystem {
 public:
  virtual SystemForm form() const { return SystemForm::reduced; }
  int equations() const { return equations_; }  // m
  bool stop_is_requested() const { return problem_base_.stop_is_requested(); }
  void take_stop_request() { problem_base_.take_stop_request(); }
  void set_limits(double lowest, double highest) { problem_base_.set_limits(lowest, highest); }
  void set_distance(double distance) { analysis_.distance = distance; }
  long failed_evaluations() const { return problem_base_.failed_evaluations(); }
  const IndexAnalysis& analysis() const { return analysis_; }
  LeadingTerm leading_term() const { return leading_; }
  const CallbackError& callback_error() const { return callback_error_; }  // the last one
  const SystemCounts& counts() const { return counts_; }

  // The jet accepted last, of order 1 at least; null where equations are linearized without one.
  virtual const Jet* point_of_equations() const { return nullptr; }

  // Whether there are derivatives of equations in the system, so that both ends of a step may be consistent though x
  // has to jump between them.
  virtual bool differentiates() const { return analysis_.values.mu > 0; }

  // The current point.
  virtual double t() const = 0;
  virtual PointQuality quality() const = 0;
  virtual std::string inconsistency_message() const;
  // What there is to say about a change of the characteristic values that was met last; empty: nothing.
  virtual std::string about_change() const { return {}; }
  // Asked where steps have failed, before an integration ends for that: whether the characteristic values change near
  // the point accepted last, and when, as far as that point tells.
  virtual std::optional<double> change_nearby() { return std::nullopt; }
  // What vanishes at changes that no watch has found.
  virtual SingularPart vanishing_part() const { return SingularPart::unknown; }
  // The characteristic values that hold at t, or, where x is needed and not known there, at the point where a change
  // was met last.
  virtual CharacteristicValues values_at(double t) = 0;

  // rank E has turned out not to be constant: another leading term from now on.
  virtual void give_up_projector() {}
  // x' of the solution through the consistent x at the current point, free directions held; true if it comes from the
  // derivative array, false if it had to be computed otherwise, looking in the given direction (+1 or -1). The
  // current point is still the same afterwards.
  virtual bool consistent_derivative(const double* x, double direction, double* xdot) = 0;
  // x' from the derivative array only; false, and xdot as it was, if that is not possible.
  virtual bool exact_derivative(const double* x, double* xdot) = 0;
  // (W x)' given x and x' at the current point.
  virtual void leading_derivative(const double* x, const double* xdot, double* wdot) = 0;

  // Errors of the components of x that rounding in the equations causes near the point; null: negligible.
  virtual const double* rounding_errors() const { return nullptr; }

  // Whether derivatives by differences enter the equations at the current point, and the errors of x (n values) that
  // theirs cause there, x consistent: an estimate (docs/design/finite_differences.md).
  virtual bool has_difference_errors() const { return false; }
  virtual void difference_errors(const double* /*x*/, double* /*errors*/) {}

  // Whether the characteristic values hold at the current point, where that has not been checked. What later steps
  // depend on stays as it is.
  virtual PointStatus check_ranks() { return PointStatus::ok; }

  // Sets the flags of unknowns (n, all 0 before) with derivatives in the equations near the point accepted last; false:
  // not known.
  virtual bool find_differentiated(char* flags) = 0;
  // How far a change dx of x, from the point accepted last to the current one, changes what is differentiated: the
  // largest change over its tolerance; infinite where that is not known.
  virtual double change_of_differentiated(const double* dx, const double* tolerances) const = 0;

  virtual void archive(Archive& archive) = 0;

 protected:
  DaeSystem(Problem& problem, int equations, IndexAnalysis analysis, LeadingTerm leading)
      : analysis_(std::move(analysis)), leading_(leading), problem_base_(problem), equations_(equations) {}

  // No other guess or linearization will help.
  bool is_hopeless(PointStatus status) const {
    return status == PointStatus::changed ||
           (status == PointStatus::callback_error && !callback_error_.is_recoverable());
  }

  // Whose limits, names and requests to stop count.
  Problem& problem_base() const { return problem_base_; }

  IndexAnalysis analysis_;
  LeadingTerm leading_;
  CallbackError callback_error_;
  SystemCounts counts_;

 private:
  Problem& problem_base_;
  int equations_;
};

inline std::string DaeSystem::inconsistency_message() const {
  return format(
      "redundant equations contradict each other at t = %.15g: relative residual %.3g of Z3^T g = 0. There is "
      "no solution; correct the equations, or set ignore_inconsistency.",
      t(), quality().inconsistency);
}

}  // namespace sfdae::core
