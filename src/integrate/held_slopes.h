// Slopes of w at other times than the present one with w held: the effect of inputs alone.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "integrate/integrator.h"

namespace sfdae::core {

class HeldSlopes {
 public:
  void resize(const DaeSystem& system);
  // (W x)' at t with w as at the last point. False: it does not exist, or was not found. Throws Failure if the user
  // stops the integration.
  bool find(Integrator& integrator, double t, std::vector<double>& wdot);
  // Change of x due to a slope over a step of size h, in tolerances.
  double size_of_change(Integrator& integrator, double h, const std::vector<double>& slope);

 private:
  bool follow(Integrator& integrator, double t);
  bool restore(Integrator& integrator, double t);

  std::vector<double> w_, x_, from_, xdot_, taylor_, taylor_before_;
};

}  // namespace sfdae::core
