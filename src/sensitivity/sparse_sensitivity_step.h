// BDF steps of sensitivities of regular problems of strangeness index 0 with sparse matrices.
//
// x solves F(t, x, c x + w_rest, p) = 0 there (index_zero_step.h). The derivative by p is
//
//     (c F_x' + F_x) S = -F_p - F_x' rest,     S' = c S + rest,
//
// constraints included: rows of the left kernel of F_x' have no part of S'. Nothing is eliminated, and the matrix is
// refactored in each step, with earlier pivots and operations if they are suitable (linalg/planned_lu.h).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/archive.h"
#include "linalg/known_pivots.h"
#include "linalg/matrix.h"
#include "linalg/planned_lu.h"
#include "linalg/sparse_lu.h"
#include "problem/parameter_series.h"
#include "reduction/index_analysis.h"
#include "system/jet.h"
#include "system/strangeness_free_system.h"

namespace sfdae::core {

// A derivative in recorded equations.
struct RecordedEntry {
  int row, column;
  bool of_slope;  // of F_x', else of F_x
};
// All derivatives, in the order of gradient_entries.
std::vector<RecordedEntry> recorded_entries(RecordedProblem& problem);

class SparseSensitivityStep {
 public:
  // Both arguments must outlive this object.
  SparseSensitivityStep(RecordedProblem& problem, ParameterSeries& parameters)
      : problem_(problem), parameters_(parameters) {}

  // For the values that the analysis has found: returns whether this method can solve steps. It is not used if the
  // matrix is nearly full.
  bool prepare(const IndexAnalysis& analysis);
  // Same with the jet at which steps start: also for small matrices that are not full.
  bool prepare(const IndexAnalysis& analysis, const Jet& jet);
  bool is_possible() const { return is_possible_; }
  // Reading restores the prepared state for the values of the analysis, pivots included. Throws DamagedArchive.
  void archive(Archive& archive, const IndexAnalysis& analysis);

  // x' = xdot, rest: n x count; all in the user's units.
  struct Step {
    double t;
    const double *x, *xdot;
    double c;
    const double* rest;
  };
  PointStatus solve(const Step& step, double* S);
  // Same transposed, without rest: weights of S become those of rest. weights: n x q, gradient: count x q, to which is
  // added.
  PointStatus solve_back(const Step& step, View weights, View gradient);
  const CallbackError& callback_error() const { return callback_error_; }

 private:
  SparsePattern find_pattern();
  PointStatus evaluate(const Step& step);
  void set_values(double c);
  PointStatus factor_and_solve(double* S);

  RecordedProblem& problem_;
  ParameterSeries& parameters_;
  bool is_possible_ = false;
  std::vector<RecordedEntry> entries_;
  std::vector<int> positions_;  // of these, in the matrix
  VaryingEntries varying_;
  std::vector<double> jet_, derivatives_, values_, right_, nu_;
  SparseLu<double> lu_;
  KnownPivots pivots_;
  PlannedLu planned_;
  CallbackError callback_error_;
};

}  // namespace sfdae::core
