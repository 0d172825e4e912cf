// x and x' at points within the last step, in the form in which they are returned.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "integrate/integrator.h"

namespace sfdae::core {

// What x' is needed for. Rough: an estimate, for which what costs much is left out, and zero will do. Consistent:
// from the derivative array where that is possible, whatever it costs.
enum class Slopes { none, rough, wanted, consistent };

struct PointRequest {
  double t;
  bool may_refine;  // where the integrator's polynomial is not accurate it is made so
  Slopes slopes;
  bool may_interpolate = false;  // the polynomial alone will do where it is accurate, without constraints
  double distance = 0.0;         // x is to be that of t + distance, a rounding error of t away, by its slope at t
};

class StepOutput {
 public:
  // Before the integrator starts anew or when it is restored. Never shrinks: the history may still be the old one.
  void resize(const DaeSystem& system);

  // x, consistent unless it may be interpolated, and x', zero if nobody looks at it. Throws Failure.
  void evaluate(Integrator& integrator, const PointRequest& request, const IntegrationOptions& options, double* x,
                double* xdot);
  // x and xdot, which may be null, stay as they were where that throws.
  void evaluate_aside(Integrator& integrator, const PointRequest& request, const IntegrationOptions& options,
                      double* x, double* xdot);
  // Where slopes go that nobody looks at: n values.
  double* unused_slopes() {
    slopes_.resize(x_free_.size());
    return slopes_.data();
  }
  // The polynomials of the last step as they are, or made accurate first where they are not; that throws Failure where
  // it cannot be done.
  void interpolate(Stepper& stepper, double t, double* x, double* xdot);
  void refine(Integrator& integrator, double t, double* x, double* xdot);

  // The last point as the error test saw it; with its constraints fulfilled to rounding, or as it is where that
  // fails.
  void last_point(Stepper& stepper, double& t, double* x, double* xdot);
  void make_consistent(Integrator& integrator, Slopes slopes, double* x, double* xdot);

 private:
  void find_values(Integrator& integrator, const PointRequest& request, const IntegrationOptions& options, double* x,
                   double* xdot);
  bool has_interpolated(Integrator& integrator, const PointRequest& request, const IntegrationOptions& options,
                        double* x, double* xdot);
  void test_polynomial(Integrator& integrator, const IntegrationOptions& options, double* x, double* xdot);
  void move_to(Integrator& integrator, const PointRequest& request, const PointValues& point);
  void restore(Integrator& integrator, double t, double* x);

  std::vector<double> w_, x_free_;  // by the polynomials
  std::vector<double> x_, slopes_;  // what is not handed out, or not yet; there when they are wanted first
};

}  // namespace sfdae::core
