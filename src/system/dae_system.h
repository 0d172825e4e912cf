// Interface of a system for the driver of an integration: beyond what integrators need, its analysis and its state.
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

// Distances of the decisions at a point from other decisions.
struct PointQuality {
  double inconsistency = 0.0;  // contradiction of redundant equations, relative
  // Smallest values kept in the decisions on A^ and E T2, relative; they dip where characteristic values change.
  double kept_constraints = 1.0, kept_differential = 1.0;
  double smallest_pivot = 1.0;
};

struct SystemCounts {
  long reductions = 0, factorizations = 0;
};

// Form of a system: a reduced derivative array, or a minimal extension by structural analysis.
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

  // The system contains derivatives of equations, so that both ends of a step may be consistent though x has to jump
  // between them.
  virtual bool differentiates() const { return analysis_.values.mu > 0; }

  // The current point.
  virtual double t() const = 0;
  virtual PointQuality quality() const = 0;
  virtual std::string inconsistency_message() const;
  // Message about the change of the characteristic values that was met last; empty: none.
  virtual std::string about_change() const { return {}; }
  // Called after failed steps before an integration ends because of them: tells if and when the characteristic values
  // change near the point accepted last, judged from that point alone.
  virtual std::optional<double> change_nearby() { return std::nullopt; }
  // The part that loses rank at changes that no watch has found.
  virtual SingularPart vanishing_part() const { return SingularPart::unknown; }
  // The characteristic values that hold at t, or, if x is needed and not known there, at the point where a change was
  // met last.
  virtual CharacteristicValues values_at(double t) = 0;

  // Called when rank E turns out not to be constant: another leading term from now on.
  virtual void give_up_projector() {}
  // x' of the solution through the consistent x at the current point, free directions held. True: from the derivative
  // array; false: computed otherwise, with points in the given direction (+1 or -1). The current point is unchanged
  // afterwards.
  virtual bool consistent_derivative(const double* x, double direction, double* xdot) = 0;
  // x' from the derivative array only; false, and xdot unchanged, if that is not possible.
  virtual bool exact_derivative(const double* x, double* xdot) = 0;
  // (W x)' given x and x' at the current point.
  virtual void leading_derivative(const double* x, const double* xdot, double* wdot) = 0;

  // Errors of the components of x due to roundoff in the equations near the point; null: negligible.
  virtual const double* rounding_errors() const { return nullptr; }

  // True if finite differences enter the equations at the current point. Their effect on x, consistent there: n
  // estimated errors (docs/design/finite_differences.md).
  virtual bool has_difference_errors() const { return false; }
  virtual void difference_errors(const double* /*x*/, double* /*errors*/) {}

  // Checks that the characteristic values hold at the current point, if that has not been checked. State that later
  // steps depend on is unchanged.
  virtual PointStatus check_ranks() { return PointStatus::ok; }

  // Sets the flags of unknowns (n, all 0 before) with derivatives in the equations near the point accepted last; false:
  // not known.
  virtual bool find_differentiated(char* flags) = 0;
  // The largest change over its tolerance that a change dx of x, from the point accepted last to the current one,
  // causes in the differential part; infinite if unknown.
  virtual double change_of_differentiated(const double* dx, const double* tolerances) const = 0;

  virtual void archive(Archive& archive) = 0;

 protected:
  DaeSystem(Problem& problem, int equations, IndexAnalysis analysis, LeadingTerm leading)
      : analysis_(std::move(analysis)), leading_(leading), problem_base_(problem), equations_(equations) {}

  // No other initial guess or linearization will help.
  bool is_hopeless(PointStatus status) const {
    return status == PointStatus::changed ||
           (status == PointStatus::callback_error && !callback_error_.is_recoverable());
  }

  // The problem whose limits, names and requests to stop apply.
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
