// Test whether finite-difference derivatives are accurate enough for the tolerances
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

// Errors are compared with tolerances for the recent size of a component, because one that passes through zero loses no
// digits there. Only the start has one-sided differences, with the largest errors: they are stored until components
// that start at zero have reached their size.
class DifferenceCheck {
 public:
  // Accepts the current point of the system, with x consistent there; is_first: a new integration starts. An exception
  // changes nothing.
  void accept(DaeSystem& system, const ErrorWeights& weights, const double* x, bool is_first);
  // excess(): errors at the last point exceed the tolerances; lasting_excess(): so do those of several points, or the
  // start.
  std::optional<CallResult> excess(const ErrorWeights& weights) const;
  std::optional<CallResult> lasting_excess(const ErrorWeights& weights) const;
  // True if errors at the last point or at the start exceed the tolerances so far.
  bool is_in_doubt(const ErrorWeights& weights) const { return excess(weights) || excess_at_start(weights); }
  // Excess at another current point, which is returned to the user, or at the start.
  std::optional<CallResult> excess_at(DaeSystem& system, const ErrorWeights& weights, const double* x) const;

  bool has_errors() const { return !errors_.empty() || !errors_at_start_.empty(); }
  void archive(Archive& archive, std::size_t n);

 private:
  void forget_points();
  void note_start(const ErrorWeights& weights, const double* x, bool is_first);
  std::optional<CallResult> excess_at_start(const ErrorWeights& weights) const;

  double t_ = 0.0;
  std::vector<double> errors_;  // of x at the point accepted last; empty: none
  std::vector<double> sizes_;   // of the components there and shortly before
  int points_in_excess_ = 0;
  double t_start_ = 0.0;
  std::vector<double> errors_at_start_;  // empty: already compared with the tolerances
  std::vector<double> sizes_since_;      // largest values
  int points_since_ = 0;
};

// Excess at a point outside of integrations: errors are compared with the tolerances for the present x.
std::optional<CallResult> excess_of_differences(const ConsistentPoint& point, const Tolerances& tolerances);

}  // namespace sfdae::core
