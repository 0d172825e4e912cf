// Slopes of w at other times than the present one, w held: what inputs alone make of them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "integrate/integrator.h"

namespace sfdae::core {

class HeldSlopes {
 public:
  void resize(const DaeSystem& system);
  // (W x)' at t for w as it is at the last point. False: there is none, or none is found. Throws Failure where the
  // user stops all.
  bool find(Integrator& integrator, double t, std::vector<double>& wdot);
  // Of x, by a slope over a step of size h, in tolerances.
  double size_of_change(Integrator& integrator, double h, const std::vector<double>& slope);

 private:
  bool follow(Integrator& integrator, double t);
  bool restore(Integrator& integrator, double t);

  std::vector<double> w_, x_, from_, xdot_, taylor_, taylor_before_;
};

}  // namespace sfdae::core
