// The jet of level mu + 1 through a consistent x: its first derivative is x' of the solution except in free directions.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "array/analyzed_equations.h"
#include "linalg/archive.h"
#include "linalg/arena.h"
#include "reduction/null_space_form.h"
#include "reduction/stored_elimination.h"
#include "system/jet.h"

namespace sfdae::core {

class NextLevelJet {
 public:
  // Derivatives of F of order mu + 1 may not be available.
  enum class Availability { unknown, no };

  NextLevelJet(const AnalyzedEquations& problem, Arena& arena) : problem_(problem), arena_(arena) {}

  // Solves F_{mu+1}(t, x, y) = 0 for y with x given; start: a jet of level mu. If that is impossible, returns false and
  // keeps the last jet. Throws Failure if a callback stops the computation.
  bool solve(const Jet& start, const double* x);
  const double* derivative() const { return jet_.column(1); }
  // The last jet, of order mu + 2.
  const Jet& jet() const { return jet_; }
  // Makes the next solve() compute even if its arguments are those of the last one.
  void forget_solution() { is_new_ = false; }
  // Copies the derivatives that the jet has.
  void copy_derivatives(Jet& jet) const;

  bool has_jet() const { return jet_.n > 0; }
  Availability& availability() { return availability_; }
  // Archives the highest derivative, from which later iterations start; only if there is a jet, or has been.
  void archive_highest_derivative(Archive& archive);

 private:
  int level() const { return problem_.mu() + 1; }
  void begin(const Jet& start, const double* x);
  bool iterate();
  bool search();
  bool is_solved_for(const Jet& start, const double* x) const;
  bool eliminate_at(const Jet& jet);
  // Scaled x': the largest change, and the largest entry.
  struct Change {
    double norm = 0.0, size = 0.0;
  };
  std::optional<Change> change_derivatives(Jet& jet);

  const AnalyzedEquations& problem_;
  Arena& arena_;
  Availability availability_ = Availability::unknown;
  Jet jet_, trial_;
  bool is_new_ = false;  // and not used since it was solved
  TaylorData data_;
  StoredElimination elimination_;
  NullSpaceForm rank_form_;
  std::vector<double> transformed_, dy_;
};

}  // namespace sfdae::core
