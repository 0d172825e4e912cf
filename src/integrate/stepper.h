// Interface of integrators for the driver: one step at a time.
//
// [HW96] E. Hairer, G. Wanner: Solving Ordinary Differential Equations II. Springer, 2nd ed. 1996.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "integrate/error_weights.h"
#include "linalg/archive.h"
#include "linalg/points_of_curve.h"
#include "system/strangeness_free_system.h"

namespace sfdae::core {

enum class StepOutcome {
  accepted,
  error_too_large,
  singular,       // the matrix of the step
  not_converged,  // nonlinear equations
  not_finite,     // overflow
  callback_error,
  changed,
  leading_changed,  // as PointStatus
  not_searched      // points within could not be evaluated in the search for changes of the characteristic values
};

// nullopt for PointStatus::ok.
std::optional<StepOutcome> failed_outcome(PointStatus status);

// Step options of the user.
struct StepOptions {
  int max_order = 5;  // BDF
  // Radau IIA: numbers of stages, odd.
  int min_stages = 1, max_stages = 7;
  bool classical_control = false;  // otherwise predictive
  // These defaults of the Radau methods are those of RADAU5 [HW96, IV.8], as are those of keep_from and keep_to.
  double safety = 0.9;
  double fastest_fall = 5.0, fastest_rise = 0.125;  // h_old / h_new stays in [fastest_rise, fastest_fall]
  // True if outputs within steps will be requested.
  bool interpolates = true;
  // Constant matrices: h and its factorization are reused if the step size wanted is in [keep_from, keep_to] h.
  double keep_from = 1.0, keep_to = 1.2;
  bool operator==(const StepOptions&) const = default;
};

// A consistent point with slopes xdot = x' and wdot = (W x)'; w = W x.
struct StartingPoint {
  double t;
  const std::vector<double>& x;
  const std::vector<double>& xdot;
  const std::vector<double>& w;
  const std::vector<double>& wdot;
};

// Destinations of w, x and x' at t; w and xdot may be null.
struct PointValues {
  double t;
  double* w;
  double* x;
  double* xdot;
};

// An accepted step.
struct LastStep {
  double h = 0.0;  // 0 before the first
  int order = 0;   // 0 before the first
  // D_h w = c w + ...; infinite before the first.
  double leading_coefficient = std::numeric_limits<double>::infinity();
};

// A successful attempt, with the formula of D_h x for W = I: c x + rest for BDF, with method = null; otherwise the
// stages of x (n x s) and the start of the step.
struct TriedStep {
  double t = 0.0, h = 0.0;
  int order = 0;
  const double* x = nullptr;
  double c = 0.0;
  const double* rest = nullptr;
  const StageMethod* method = nullptr;
  const double* x_start = nullptr;
  bool forgets_past = false;  // Radau: the solution is less smooth than points before the start suggest
};

struct ErrorTerms;
struct LocalTerms;

// State of an integrator between attempts.
struct StepState {
  double t;        // the last point
  double tried_t;  // end of the last attempt, or the time at which it failed
  LastStep last;
  double next_step;  // the size to try next, also after a failure
  int next_order;
  int failures_in_a_row;
  // Maximum size of the next step for which interpolate() is expected to be accurate, judged by the last step.
  double longest_interpolated;
  bool interpolates_well;  // within the last one, for w
  double tried_error;      // of the last attempt judged, in tolerances according to the weights
  // Number of points within the last step that refine() computed and that are still stored.
  int refined_points;
};

class Stepper {
 public:
  explicit Stepper(Tightening tightening) : tightening_(tightening) {}
  virtual ~Stepper() = default;

  // Adjustment of the tolerances before errors are compared with them.
  Tightening tightening() const { return tightening_; }
  virtual void set_options(const StepOptions& options) = 0;
  // Size of a first attempt. span: length of the interval of interest.
  virtual double first_step(const ErrorWeights& weights, const double* x, const double* xdot, double span) = 0;

  // The first step will have size h. Changes nothing if memory is missing.
  virtual void start(const StrangenessFreeSystem& system, const StartingPoint& point, double h) = 0;
  // Tries one step from the last point to t; commit() makes an accepted one the last point.
  virtual StepOutcome attempt(StrangenessFreeSystem& system, double t, ErrorWeights& weights) = 0;
  virtual void commit() = 0;
  // Undoes an attempt for the caller's reasons (for example, a smaller step is needed).
  virtual void withdraw() = 0;
  // Reduces the next step after a failure.
  virtual void reduce_after_failure(double h) = 0;
  // Radau, after an accepted attempt: includes these errors of companions in the decisions about this step and the
  // next.
  virtual StepOutcome test_beside(const StrangenessFreeSystem&, const ErrorTerms&) { return StepOutcome::accepted; }
  // The same for BDF, by local terms and the error of the formula. judges_higher_order(): true if terms of the next
  // higher order are required.
  virtual StepOutcome test_beside(const LocalTerms&, double /*error*/) { return StepOutcome::accepted; }
  virtual bool judges_higher_order() const { return false; }
  virtual void set_next_step(double h) = 0;

  virtual StepState state() const = 0;
  virtual TriedStep tried() const = 0;                // after an accepted attempt, before commit()
  virtual PointsOfCurve points_of_tried() const = 0;  // likewise; starting with both ends of the step
  virtual const std::vector<double>& x() const = 0;   // at the last point
  // x at the end of the last attempt, which was accepted or has an error that is too large.
  virtual const std::vector<double>& tried_x() const = 0;
  virtual const std::vector<double>& error() const = 0;  // of the last attempt, mapped to x

  // A point within the last step; its x may violate the constraints.
  virtual void interpolate(const PointValues& point) = 0;
  // True if its x is as accurate as the tolerances require, including the constraints.
  virtual bool interpolates_x(ErrorWeights& weights) = 0;
  // Time at which to call gives_up_polynomial() before interpolates_x() trusts the polynomial.
  virtual std::optional<double> point_of_test() const { return std::nullopt; }
  // x: the consistent values for those interpolated at a point within the last step. True if they contradict the error
  // estimate of the polynomial, which is then no longer used.
  virtual bool gives_up_polynomial(ErrorWeights&, const double* /*interpolated*/, const double* /*x*/) {
    return false;
  }
  // Initial guess for an iteration at the point, Taylor coefficients up to that order; empty: unknown.
  virtual Guess guess_within(double t, int order) = 0;
  // Moves the system to the point interpolated last, and improves its values if they are inaccurate.
  virtual PointStatus refine(StrangenessFreeSystem& system, ErrorWeights& weights, const PointValues& point) = 0;

  // Archives all data on which the next step depends.
  virtual void archive(Archive& archive, const StrangenessFreeSystem& system) = 0;

 private:
  Tightening tightening_;
};

}  // namespace sfdae::core
