// Test whether E x has moved in a step according to its slopes. With derivatives of equations in the system both ends
// of a step may be consistent although E x has to jump between them: no error test shows it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "integrate/integrator.h"

namespace sfdae::core {

class MovementTest {
 public:
  void resize(std::size_t n);
  // Unexplained movement of E x in a successful attempt, in tolerances: the difference between the trapezoidal rule
  // with slopes of the equations and with slopes of the step's polynomial at both ends. The error of the rule cancels;
  // half of a jump remains. Infinite: slopes are unknown.
  double unexplained(const Integrator& integrator);
  // Less expensive estimate by the slope at the start only, as if x had jumped before the end.
  double unexplained_at_start(const Integrator& integrator);

 private:
  void set_slopes(const Integrator& integrator, double t);
  void add(double factor);
  void add_change_at_start(const Integrator& integrator);
  double size(const Integrator& integrator);

  std::vector<double> change_, x_, slopes_, tolerances_;
};

}  // namespace sfdae::core
