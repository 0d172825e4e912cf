// The unknowns of one stage of an extension by Newton's method, each step the least change back to the guess.
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
  // W: of the square of a change of each column of the stage, in the units of the search.
  StageSearch(MinimalExtension& extension, int stage, std::vector<double> W, const SearchUnits& units);

  // What has ended the search without a solution, or null. jet: its unknowns of the stages before are known. Throws
  // Failure where the equations cannot be evaluated at the guess.
  const char* run(const Jet& guess, Jet& jet);
  // One of these reasons: the structure may mislead.
  static constexpr char singular[] = "the equations are singular there.";

 private:
  // Where steps lead: as near to the guess as they can, or to the nearest solution from where the search is.
  enum class Toward { guess, solution };
  const char* run_toward(Toward toward, const Jet& guess, Jet& jet);
  const char* linearize(const Jet& guess, const Jet& jet, bool is_first);
  const char* explain(const CallbackError& error, const Jet& guess, bool is_first);
  struct Residual {
    ResidualSizes sizes;
    double weighted = 0.0;  // the largest, in units of what was added up in its row where it was linearized
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
