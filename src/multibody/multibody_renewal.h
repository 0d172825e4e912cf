// Decision whether a new linearization pays for the next step of a mechanical system.
//
// The last steps tell how many iterations a new one needs, and how many more the one of the step before; now and then a
// linearization is reused as a test.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linalg/archive.h"

namespace sfdae::core {

class MultibodyRenewal {
 public:
  void begin() { is_fresh_ = true; }
  // Call after a step of s stages has converged. cost: of a linearization in evaluations of one stage.
  bool pays(int s, int iterations, double cost);

  // No step has been solved with the linearization.
  bool is_fresh() const { return is_fresh_; }
  void set_fresh(bool is_fresh) { is_fresh_ = is_fresh; }
  void archive(Archive& archive) { archive.small(is_fresh_, fresh_iterations_, kept_iterations_, fresh_in_a_row_); }

 private:
  bool is_fresh_ = false;
  // Iterations of the last steps: with new linearizations, and with older ones.
  int fresh_iterations_ = 0, kept_iterations_ = 0;
  int fresh_in_a_row_ = 0;
};

}  // namespace sfdae::core
