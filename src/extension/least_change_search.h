// Solution of all equations of the extension by least changes of all its unknowns.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include "extension/jet_search.h"
#include "extension/least_change_step.h"
#include "extension/minimal_extension.h"
#include "system/jet.h"

namespace sfdae::core {

class LeastChangeSearch {
 public:
  // Demands by columns.
  struct Demands {
    std::vector<double> W;         // weights of the squares of changes, in units of the search
    std::vector<char> are_drawn;   // to the guess; others only move with W from where they are
    std::vector<char> are_held;    // do not change
    double negligible = HUGE_VAL;  // sum of the changes of a step that may be the last one
  };
  LeastChangeSearch(MinimalExtension& extension, Demands demands, const SearchUnits& units);

  // All of these throw Failure if callbacks stop the computation. False: the search does not converge, or leads to
  // points where the equations cannot be evaluated.
  bool fulfil(Jet& jet);
  // Finds the point nearest to the guess by full steps: fast, but they may not converge if constraints are curved, or
  // if derivatives of high order lose too many digits.
  bool hurry(const Jet& guess, Jet& jet);
  // Sum of W times the squares of changes of drawn values from the guess.
  double sum(const Jet& guess, const Jet& jet) const;
  // Steps toward the guess, shortened until the sum of changes decreases; from a jet that satisfies the equations.
  void approach(const Jet& guess, Jet& jet);

 private:
  // Full steps from where steps are small already, as long as they become smaller.
  void settle(const Jet& guess, Jet& jet);
  // Computes the change from the jet, toward the guess or, without one, least.
  bool compute(const Jet& jet, const Jet* guess);
  JetChange apply(const std::vector<double>& dx, double part, Jet& jet) const;
  double sum_of_change() const;
  // In units.
  double distance(int k, const Jet& from, const Jet& to) const;
  double draw(std::size_t k) const { return demands_.are_drawn[k] != 0 ? demands_.W[k] : 0.0; }

  MinimalExtension& extension_;
  LeastChangeStep::Equations equations_;
  LeastChangeStep step_;
  Demands demands_;
  std::vector<double> unit_;  // of the columns
  const SearchUnits& units_;
  std::vector<double> dx_, r_, factors_, values_, sums_;
  // Residuals before the change: in units of the largest derivatives, and relative to the sum of terms.
  double residual_ = 0.0, relative_ = 0.0;
};

}  // namespace sfdae::core
