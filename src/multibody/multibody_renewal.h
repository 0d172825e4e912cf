// Whether a new linearization pays for the next step of a mechanical system.
//
// How many iterations a new one needs, and how many more the one of the step before, is known from the steps taken
// last; every so often a linearization is kept to see.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "linalg/archive.h"

namespace sfdae::core {

class MultibodyRenewal {
 public:
  void begin() { is_fresh_ = true; }
  // After a step of s stages has converged; cost of a linearization in evaluations of one stage.
  bool pays(int s, int iterations, double cost);

  // No step has been solved with the linearization.
  bool is_fresh() const { return is_fresh_; }
  void set_fresh(bool is_fresh) { is_fresh_ = is_fresh; }
  void archive(Archive& archive) { archive.small(is_fresh_, fresh_iterations_, kept_iterations_, fresh_in_a_row_); }

 private:
  bool is_fresh_ = false;
  // Of the last steps: with new linearizations, and with those of steps before.
  int fresh_iterations_ = 0, kept_iterations_ = 0;
  int fresh_in_a_row_ = 0;
};

}  // namespace sfdae::core
