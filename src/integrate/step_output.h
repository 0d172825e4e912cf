// x and x' at points within the last step, as returned to the user.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "integrate/integrator.h"

namespace sfdae::core {

// Accuracy of x'. rough: an estimate without expensive parts, possibly zero; consistent: from the derivative array if
// possible, at any cost.
enum class Slopes { none, rough, wanted, consistent };

struct PointRequest {
  double t;
  bool may_refine;  // an inaccurate polynomial of the integrator is improved
  Slopes slopes;
  bool may_interpolate = false;  // an accurate polynomial may be used without constraints
  double distance = 0.0;         // x is extrapolated to t + distance, a rounding error of t away, by its slope at t
};

class StepOutput {
 public:
  // Call before the integrator restarts, or when it is restored. Never shrinks: the old history may remain in use.
  void resize(const DaeSystem& system);

  // x, consistent unless it may be interpolated, and x', zero if not requested. Throws Failure.
  void evaluate(Integrator& integrator, const PointRequest& request, const IntegrationOptions& options, double* x,
                double* xdot);
  // Same results, but exceptions leave x and xdot, which may be null, unchanged.
  void evaluate_aside(Integrator& integrator, const PointRequest& request, const IntegrationOptions& options,
                      double* x, double* xdot);
  // Destination of slopes that are not requested: n values.
  double* unused_slopes() {
    slopes_.resize(x_free_.size());
    return slopes_.data();
  }
  // Evaluate the polynomials of the last step as they are, or improve them first if they are inaccurate; the latter
  // throws Failure if that is impossible.
  void interpolate(Stepper& stepper, double t, double* x, double* xdot);
  void refine(Integrator& integrator, double t, double* x, double* xdot);

  // The last point as in the error test; make_consistent(): with its constraints fulfilled to machine precision, or
  // unchanged if that fails.
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
  std::vector<double> x_, slopes_;  // work arrays, allocated when needed first
};

}  // namespace sfdae::core
