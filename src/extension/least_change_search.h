// All equations of the extension fulfilled by changes of all its unknowns that are least.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "extension/jet_search.h"
#include "extension/least_change_step.h"
#include "extension/minimal_extension.h"
#include "system/jet.h"

namespace sfdae::core {

class LeastChangeSearch {
 public:
  // W: weights of the squares of changes, by columns; those that are held do not change. sizes: of x, n changes that do not
  // matter.
  LeastChangeSearch(MinimalExtension& extension, std::vector<double> W, std::vector<char> held,
                    const std::vector<double>& sizes);

  // All of these throw Failure where the equations cannot be evaluated. False: the search does not come to an end.
  bool fulfil(Jet& jet);
  // Nearest to the guess, by whole steps alone: fast, but where constraints are bent, or derivatives of high order lose too
  // many digits, they may not come to an end.
  bool hurry(const Jet& guess, Jet& jet);
  // Of W times the squares of all changes.
  double sum(const Jet& guess, const Jet& jet) const;
  // Steps toward the guess, each as long as the sum of changes becomes smaller by it; from a jet that fulfils the equations.
  void approach(const Jet& guess, Jet& jet);

 private:
  // The change from the jet on, toward the guess or, without one, least.
  bool compute(const Jet& jet, const Jet* guess);
  JetChange apply(const std::vector<double>& dx, double part, Jet& jet) const;
  double sum_of_change() const;

  MinimalExtension& extension_;
  LeastChangeStep::Equations equations_;
  LeastChangeStep step_;
  std::vector<double> W_;
  std::vector<char> held_;
  const std::vector<double>& sizes_;
  std::vector<double> dx_, r_, factors_, values_;
  // Before the change, in units of the largest derivatives, and relative to what is added up in each.
  double residual_ = 0.0, relative_ = 0.0;
};

}  // namespace sfdae::core
