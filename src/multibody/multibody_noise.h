// Effect of rounding errors of the equations of a mechanical system on q and v: changes of an iteration do not become
// smaller than that.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "multibody/multibody_form.h"
#include "multibody/multibody_point.h"
#include "multibody/multibody_step_matrix.h"

namespace sfdae::core {

class MultibodyNoise {
 public:
  // Initially there is no noise.
  void resize(const MultibodySizes& sizes, int differential);
  // point: of a linearization, K factored there, a and mu known.
  void measure(const MultibodyPoint& point, const MultibodyForm& form, Arena& arena);
  // Noise of steps with this matrix, after measure.
  void measure_steps(const MultibodyForm& form, const MultibodyStepMatrix& matrix, Arena& arena);
  // Noise of the components of (q, v) in steps.
  const std::vector<double>& of_steps() const { return of_steps_; }
  // The sum of terms in changes of component k whose rounding errors are those of steps.
  double sums_of_steps(int k) const;

 private:
  void add_sizes(const MultibodyPoint& point, const Partition& partition, double* g, double* velocity,
                 double* forces) const;

  std::vector<double> at_rest_;   // of (q, v), accelerations aside
  std::vector<double> of_rates_;  // of accelerations, in local coordinates, sample by sample
  std::vector<double> of_steps_;
};

}  // namespace sfdae::core
