// Whether derivatives by differences are accurate enough for the tolerances
// (docs/design/finite_differences.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "integrate/error_weights.h"
#include "integrate/integration_options.h"
#include "linalg/archive.h"
#include "system/dae_system.h"
#include "system/model.h"

namespace sfdae::core {

// Errors are compared with tolerances for the size that a component has nearby, as one that passes through zero has no
// digits to lose there. The start is the only point whose differences are one-sided, and has the largest errors: they
// are kept until components that start at zero have become what they are.
class DifferenceCheck {
 public:
  // The current point of the system is accepted, x consistent there; is_first: after this, steps begin anew. Nothing
  // has changed where it throws.
  void accept(DaeSystem& system, const ErrorWeights& weights, const double* x, bool is_first);
  // The point accepted last has errors beyond the tolerances; or so have several points in a row, or the start.
  std::optional<CallResult> excess(const ErrorWeights& weights) const;
  std::optional<CallResult> lasting_excess(const ErrorWeights& weights) const;
  // Errors of the point accepted last or of the start are beyond the tolerances, for now.
  bool is_in_doubt(const ErrorWeights& weights) const { return excess(weights) || excess_at_start(weights); }
  // At another current point, which is returned to the user, or at the start.
  std::optional<CallResult> excess_at(DaeSystem& system, const ErrorWeights& weights, const double* x) const;

  bool has_errors() const { return !errors_.empty() || !errors_at_start_.empty(); }
  void archive(Archive& archive, std::size_t n);

 private:
  void forget_points();
  void note_start(const ErrorWeights& weights, const double* x, bool is_first);
  std::optional<CallResult> excess_at_start(const ErrorWeights& weights) const;

  double t_ = 0.0;
  std::vector<double> errors_;  // of x at the point accepted last; empty: there are none
  std::vector<double> sizes_;   // of the components there and shortly before
  int points_in_excess_ = 0;
  double t_start_ = 0.0;
  std::vector<double> errors_at_start_;  // empty: they have been compared with the tolerances
  std::vector<double> sizes_since_;      // largest ones
  int points_since_ = 0;
};

// Of a point that no integration leads to: what its errors are is compared with the tolerances for x as it is.
std::optional<CallResult> excess_of_differences(const ConsistentPoint& point, const Tolerances& tolerances);

}  // namespace sfdae::core
