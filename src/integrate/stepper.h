// What the driver sees of an integrator: one step at a time.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "integrate/error_weights.h"
#include "linalg/archive.h"
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
  leading_changed  // as PointStatus
};

// nullopt for PointStatus::ok.
std::optional<StepOutcome> failed_outcome(PointStatus status);

// What the user may choose about steps.
struct StepOptions {
  int max_order = 5;  // BDF
  // Radau IIA: numbers of stages, odd.
  int min_stages = 1, max_stages = 7;
  bool classical_control = false;  // else predictive
  double safety = 0.9;
  double fastest_fall = 5.0, fastest_rise = 0.125;  // h_old / h_new stays in [fastest_rise, fastest_fall]
  // Whether points within steps are asked for.
  bool interpolates = true;
  // Constant matrices: h is kept, and its factorization, if the step wanted is in [keep_from, keep_to] h.
  double keep_from = 1.0, keep_to = 1.2;
};

// A consistent point with slopes xdot = x' and wdot = (W x)'; w = W x.
struct StartingPoint {
  double t;
  const std::vector<double>& x;
  const std::vector<double>& xdot;
  const std::vector<double>& w;
  const std::vector<double>& wdot;
};

class Stepper {
 public:
  virtual ~Stepper() = default;

  virtual void set_options(const StepOptions& options) = 0;
  // Size of a first attempt. span: length of the interval of interest.
  virtual double first_step(const ErrorWeights& weights, const double* x, const double* xdot, double span) = 0;
  // What is to be done with the tolerances before errors are tested against them.
  virtual Tightening tightening() const = 0;

  // The first step will have size h.
  virtual void start(StrangenessFreeSystem& system, const StartingPoint& point, double h) = 0;
  // Tries one step from the last point to t; commit() makes an accepted one the last point. next_step() tells
  // the size to try next, accepted or not.
  virtual StepOutcome attempt(StrangenessFreeSystem& system, double t, ErrorWeights& weights) = 0;
  virtual void commit() = 0;
  // Gives up an attempt for reasons of the caller's (a smaller step is wanted).
  virtual void withdraw() = 0;
  // After a failure: next_step() becomes smaller.
  virtual void reduce_after_failure(double h) = 0;

  virtual double t() const = 0;
  virtual const std::vector<double>& x() const = 0;
  virtual double tried_t() const = 0;
  virtual double next_step() const = 0;
  virtual void set_next_step(double h) = 0;
  virtual double last_step() const = 0;
  virtual int order() const = 0;  // of the last step, 0 before the first
  virtual int next_order() const = 0;
  virtual int failures_in_a_row() const = 0;
  // Of the last step: D_h w = c w + ...; infinite before the first.
  virtual double leading_coefficient() const = 0;
  virtual const std::vector<double>& error() const = 0;  // of the last attempt, mapped to x

  // w, x (inaccurate in its constraints) and x' at t, within the last step.
  virtual void interpolate(double t, double* w, double* x, double* xdot) = 0;

  // Whether interpolate() will be accurate enough within the next step.
  virtual bool interpolates_well() const { return true; }
  // Moves the system to t and makes up for interpolate() where that is not accurate enough there.
  virtual PointStatus refine(StrangenessFreeSystem& system, ErrorWeights&, double t, double*, double*, double*) {
    return system.move_to(t);
  }
  // Points within the last step where that was necessary.
  virtual int refined_points() const { return 0; }

  // All that the next step depends on.
  virtual void archive(Archive& archive, const StrangenessFreeSystem& system) = 0;
};

}  // namespace sfdae::core
