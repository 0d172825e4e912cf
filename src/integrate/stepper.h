// What the driver sees of an integrator: one step at a time.
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
  not_finite,     // overflow on the way
  callback_error,
  changed,
  leading_changed,  // as PointStatus
  not_searched      // points within could not be evaluated when changes of the characteristic values were looked for
};

// nullopt for PointStatus::ok.
std::optional<StepOutcome> failed_outcome(PointStatus status);

// What the user may choose about steps.
struct StepOptions {
  int max_order = 5;  // BDF
  // Radau IIA: numbers of stages, odd.
  int min_stages = 1, max_stages = 7;
  bool classical_control = false;  // else predictive
  // These defaults of the Radau methods are those of RADAU5 [HW96, IV.8], as are those of keep_from and keep_to.
  double safety = 0.9;
  double fastest_fall = 5.0, fastest_rise = 0.125;  // h_old / h_new stays in [fastest_rise, fastest_fall]
  // Whether points within steps are asked for.
  bool interpolates = true;
  // Constant matrices: h is kept, and its factorization, if the step wanted is in [keep_from, keep_to] h.
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

// Where w, x and x' at t are written; w and xdot: null if they are not wanted.
struct PointValues {
  double t;
  double* w;
  double* x;
  double* xdot;
};

// A step that was accepted.
struct LastStep {
  double h = 0.0;  // 0 before the first
  int order = 0;   // 0 before the first
  // D_h w = c w + ...; infinite before the first.
  double leading_coefficient = std::numeric_limits<double>::infinity();
};

// A step that was tried with success, with what says what D_h x is for W = I: c x + rest for BDF, where `method` is
// null; else the stages of x (n x s) and where it started.
struct TriedStep {
  double t = 0.0, h = 0.0;
  int order = 0;
  const double* x = nullptr;
  double c = 0.0;
  const double* rest = nullptr;
  const StageMethod* method = nullptr;
  const double* x_start = nullptr;
  bool forgets_past = false;  // of Radau: points before its start do not say how smooth the solution is
};

struct ErrorTerms;
struct LocalTerms;

// Where an integrator stands between attempts.
struct StepState {
  double t;        // the last point
  double tried_t;  // of the last attempt: its end, or where it failed
  LastStep last;
  double next_step;  // the size to try next, after a failure as well
  int next_order;
  int failures_in_a_row;
  // The next step may be so long, in size, and interpolate() will be accurate enough within it, as far as the last
  // step tells.
  double longest_interpolated;
  bool interpolates_well;  // within the last one, for w
  double tried_error;      // of the last attempt that has been judged, in tolerances as the weights have them
  // Points within the last step where refine() made up for interpolate(), as far as they are kept.
  int refined_points;
};

class Stepper {
 public:
  explicit Stepper(Tightening tightening) : tightening_(tightening) {}
  virtual ~Stepper() = default;

  // What is to be done with the tolerances before errors are tested against them.
  Tightening tightening() const { return tightening_; }
  virtual void set_options(const StepOptions& options) = 0;
  // Size of a first attempt. span: length of the interval of interest.
  virtual double first_step(const ErrorWeights& weights, const double* x, const double* xdot, double span) = 0;

  // The first step will have size h. Everything is as before where memory is missing.
  virtual void start(const StrangenessFreeSystem& system, const StartingPoint& point, double h) = 0;
  // Tries one step from the last point to t; commit() makes an accepted one the last point.
  virtual StepOutcome attempt(StrangenessFreeSystem& system, double t, ErrorWeights& weights) = 0;
  virtual void commit() = 0;
  // Gives up an attempt for reasons of the caller's (a smaller step is wanted).
  virtual void withdraw() = 0;
  // After a failure: the next step becomes smaller.
  virtual void reduce_after_failure(double h) = 0;
  // Of Radau, after an attempt that was accepted: that what goes along with x has these errors counts as well, for
  // this step and the next.
  virtual StepOutcome test_beside(const StrangenessFreeSystem&, const ErrorTerms&) { return StepOutcome::accepted; }
  // Likewise of BDF: the local terms, and the error of the formula. Whether those of the next higher order are asked
  // for.
  virtual StepOutcome test_beside(const LocalTerms&, double /*error*/) { return StepOutcome::accepted; }
  virtual bool judges_higher_order() const { return false; }
  virtual void set_next_step(double h) = 0;

  virtual StepState state() const = 0;
  virtual TriedStep tried() const = 0;                // after an attempt that was accepted, before commit()
  virtual PointsOfCurve points_of_tried() const = 0;  // likewise; the start and the end of the step are the first
  virtual const std::vector<double>& x() const = 0;   // at the last point
  // Returns x at the end of the last attempt, which was accepted or has an error that is too large.
  virtual const std::vector<double>& tried_x() const = 0;
  virtual const std::vector<double>& error() const = 0;  // of the last attempt, mapped to x

  // A point within the last step; its x is inaccurate in the constraints.
  virtual void interpolate(const PointValues& point) = 0;
  // Whether its x is as accurate as the tolerances ask for, constraints included.
  virtual bool interpolates_x(ErrorWeights& weights) = 0;
  // Where the next function should be called for, before the polynomial is trusted for interpolates_x().
  virtual std::optional<double> point_of_test() const { return std::nullopt; }
  // x is what has become of the values interpolated at a point within the last step, with all equations that hold
  // there: whether they contradict what is known of the polynomial, which is not used any more then.
  virtual bool gives_up_polynomial(ErrorWeights&, const double* /*interpolated*/, const double* /*x*/) {
    return false;
  }
  // What an iteration toward the point starts from, Taylor coefficients up to that order; empty: nothing is known.
  virtual Guess guess_within(double t, int order) = 0;
  // Moves the system to the point interpolated last, and makes up for its values where they are not accurate enough.
  virtual PointStatus refine(StrangenessFreeSystem& system, ErrorWeights& weights, const PointValues& point) = 0;

  // All that the next step depends on.
  virtual void archive(Archive& archive, const StrangenessFreeSystem& system) = 0;

 private:
  Tightening tightening_;
};

}  // namespace sfdae::core
