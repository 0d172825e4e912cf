// Consistent jets: values of all unknowns of the extension that satisfy its equations, with x near given values. They
// are found stage by stage [P01]: the equations of a stage determine its unknowns, or as many of them as there are
// equations, given those of the earlier stages. If given values have to move, all equations are then solved together so
// that the changes of x are least.
//
// [P01] J. D. Pryce: A Simple Structural Analysis Method for DAEs. BIT 41 (2001), 364-394.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

#include "extension/jet_search.h"
#include "extension/minimal_extension.h"
#include "starts/consistent_values.h"
#include "system/jet.h"
#include "system/model.h"

namespace sfdae::core {

// Flags: x_j' occurs in some equation.
std::vector<char> differentiated_unknowns(const Signature& signature);

class ConsistentExtension {
 public:
  // request: with tolerances (ConsistencyRequest::set_tolerances).
  ConsistentExtension(MinimalExtension& extension, const ConsistencyRequest& request)
      : extension_(extension),
        request_(request),
        units_{request.sizes()},
        drawn_sizes_(units_.sizes),
        differentiated_(differentiated_unknowns(extension.problem().structure()->signature)) {
    if (!request.weights.empty()) least_weight_ = *std::min_element(request.weights.begin(), request.weights.end());
  }

  // Finds a jet near the x and, if given, x' of the point. Differential variables move in proportion to their values if
  // their last digits explain the change, as published values are rounded (docs/design/consistent_initialization.md).
  // Throws Failure: errors of callbacks, SFDAE_NO_CONSISTENT_VALUES.
  Jet find(const PointOfInterest& point);
  // Reports the changes of given values by find() as requested. Throws Failure if the request does not allow them.
  void report(const PointOfInterest& point, const Jet& found, ConsistentPoint& result) const;

  // Weight of the square of a change, by the request; value: of the column, as far as it is known.
  double weight(const MinimalExtension::Column& column, double value = 0.0) const;
  // is_drawn: a value is to stay near the guess; others end where they have to. is_held: it is fixed.
  bool is_drawn(const MinimalExtension::Column& column) const;
  bool is_held(const MinimalExtension::Column& column) const;
  bool stays(int j) const { return is_held({j, 0}) || is_drawn({j, 0}); }

 private:
  Jet find_nearest(const PointOfInterest& point);
  bool may_be_digits(const double* given, const Jet& found) const;
  bool is_within(const std::vector<double>& tolerances, const double* given, const Jet& found) const;
  void solve_stage(int stage, const Jet& guess, Jet& jet);
  void solve_together(const Jet& guess, Jet& jet);
  bool has_to_move(const Jet& guess, const Jet& jet) const;
  bool has_derivatives_beyond_rounding(const Jet& jet) const;
  [[noreturn]] void fail(const Jet& jet, const char* why) const;

  MinimalExtension& extension_;
  const ConsistencyRequest& request_;
  SearchUnits units_;
  std::vector<double> drawn_sizes_;  // changes of drawn values that count as one
  std::vector<char> differentiated_;
  double least_weight_ = 1.0;  // only ratios of weights count
};

}  // namespace sfdae::core
