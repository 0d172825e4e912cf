// All equations of the extension fulfilled by changes of all its unknowns that are least.
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
  // By columns.
  struct Demands {
    std::vector<double> W;         // weights of the squares of changes, in units of the search
    std::vector<char> are_drawn;   // to the guess; the others only move with W from where they are, and end anywhere
    std::vector<char> are_held;    // do not change
    double negligible = HUGE_VAL;  // of the sum of a step's changes: the last one may be that large
  };
  LeastChangeSearch(MinimalExtension& extension, Demands demands, const SearchUnits& units);

  // All of these throw Failure where callbacks stop. False: the search does not come to an end, or leads to where the
  // equations cannot be evaluated.
  bool fulfil(Jet& jet);
  // Nearest to the guess, by whole steps alone: fast, but where constraints are bent, or derivatives of high order
  // lose too many digits, they may not come to an end.
  bool hurry(const Jet& guess, Jet& jet);
  // Of W times the squares of changes of what is drawn to the guess.
  double sum(const Jet& guess, const Jet& jet) const;
  // Steps toward the guess, each as long as the sum of changes becomes smaller by it; from a jet that fulfils the
  // equations.
  void approach(const Jet& guess, Jet& jet);

 private:
  // Whole steps on from where steps are small already, as long as they become smaller.
  void settle(const Jet& guess, Jet& jet);
  // The change from the jet on, toward the guess or, without one, least.
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
  // Before the change, in units of the largest derivatives, and relative to what is added up in each.
  double residual_ = 0.0, relative_ = 0.0;
};

}  // namespace sfdae::core
