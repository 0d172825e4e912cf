// A test of whether E x has moved in a step as its slopes say. With derivatives of equations in the system both ends of
// a step may be consistent though E x has to jump between them: no error test shows it.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "integrate/integrator.h"

namespace sfdae::core {

class MovementTest {
 public:
  void resize(std::size_t n);
  // A step has been tried with success: how much less of what E x does its slopes at both ends explain, by the
  // trapezoidal rule, than those of the polynomial of the step do, in tolerances. The error of the rule counts for
  // both; half of a jump remains. Infinite: slopes are not known.
  double unexplained(const Integrator& integrator);
  // Estimates the same by the slope at the start alone, as if x had jumped before the end. This is cheap.
  double unexplained_at_start(const Integrator& integrator);

 private:
  void set_slopes(const Integrator& integrator, double t);
  void add(double factor);
  void add_change_at_start(const Integrator& integrator);
  double size(const Integrator& integrator);

  std::vector<double> change_, x_, slopes_, tolerances_;
};

}  // namespace sfdae::core
