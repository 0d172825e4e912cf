// Newton search for the unknowns of one stage of an extension, each step the least change back to the guess.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "extension/jet_search.h"
#include "extension/least_change_step.h"
#include "extension/minimal_extension.h"
#include "system/jet.h"

namespace sfdae::core {

class StageSearch {
 public:
  // W: weight of the square of a change of each column of the stage, in the units of the search.
  StageSearch(MinimalExtension& extension, int stage, std::vector<double> W, const SearchUnits& units);

  // Returns why the search ended without a solution, or null. jet: its unknowns of the earlier stages are known. Throws
  // Failure if the equations cannot be evaluated at the guess.
  const char* run(const Jet& guess, Jet& jet);
  // One of these reasons: the structural analysis may be invalid.
  static constexpr char singular[] = "the equations are singular there.";

 private:
  // Target of the steps: as near to the guess as they can, or the solution nearest to the last iterate.
  enum class Toward { guess, solution };
  const char* run_toward(Toward toward, const Jet& guess, Jet& jet);
  const char* linearize(const Jet& guess, const Jet& jet, bool is_first);
  const char* explain(const CallbackError& error, const Jet& guess, bool is_first);
  struct Residual {
    ResidualSizes sizes;
    double weighted = 0.0;  // the largest, in units of the terms of its row at the linearization
  };
  void sum_rows_at(const Jet& jet, std::vector<double>& sums) const;
  Residual residual(const Jet& jet);
  bool has_improved() const;
  bool is_square() const { return equations_.rows() == equations_.unknowns; }
  bool is_solved(const Jet& guess, const Jet& jet) const;
  bool step(Toward toward, const Jet& guess, Jet& jet);

  MinimalExtension& extension_;
  int stage_;
  std::vector<MinimalExtension::Column> columns_;
  MinimalExtension::StageMatrix J_;
  LeastChangeStep::Equations equations_;
  LeastChangeStep step_;
  std::vector<double> W_, dx_, r_, factors_, sums_, sums_of_linearization_;
  std::vector<char> held_;    // none
  std::vector<double> unit_;  // of the columns
  const SearchUnits& units_;
  Residual before_, here_;  // at the point of the linearization, and after the step
  JetChange change_;
};

}  // namespace sfdae::core
