// Sensitivities of consistent initial values: their derivatives by parameters, nearest to directions in the measure of
// changes of x of a request. At a consistent point, which is its own nearest one, this is the linear least-change
// problem (docs/design/sensitivities.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "extension/least_change_step.h"
#include "extension/minimal_extension.h"
#include "starts/consistent_values.h"
#include "system/jet.h"

namespace sfdae::core {

class ConsistentDirections {
 public:
  // values: derivatives of the rows at the jet, which is consistent. request: with tolerances. Throws Failure if there
  // are no such directions.
  ConsistentDirections(MinimalExtension& extension, const ConsistencyRequest& request, const Jet& jet,
                       const std::vector<double>& values);

  // right: by rows; directions and S: of all x_j. Throws Failure SFDAE_FIXED_VALUES if fixed directions are impossible.
  void find(const double* right, const double* directions, double* S);
  // True if S, which satisfies the equations, leaves all directions unchanged that are to stay.
  bool stay(const double* directions, const double* S) const;

 private:
  [[noreturn]] void fail() const;
  template <class Value>
  bool is_fulfilled(const double* right, Value value) const;

  MinimalExtension& extension_;
  const ConsistencyRequest& request_;
  std::vector<double> W_, unit_, values_, factors_, dx_, r_;
  std::vector<char> drawn_, held_, stays_;  // by columns, the last one by unknowns
  LeastChangeStep::Equations equations_;
  LeastChangeStep step_;
};

}  // namespace sfdae::core
