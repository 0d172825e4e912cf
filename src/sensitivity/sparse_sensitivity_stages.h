// Radau steps of sensitivities of regular problems of strangeness index 0 with sparse matrices.
//
// At stage i x solves F(t_i, x_i, x_i', p) = 0, x_i' = sum_j D_ij (x_j - x) / h. Differentiated by p that is
//
//     F_x' sum_j D_ij (S_j - S) / h + F_x S_i = -F_p,     F_x', F_x, F_p at stage i,
//
// constraints included, as in sparse_sensitivity_step.h: one sparse matrix of order s n for all stages and parameters.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/archive.h"
#include "linalg/matrix.h"
#include "linalg/planned_lu.h"
#include "linalg/sparse_lu.h"
#include "problem/parameter_series.h"
#include "reduction/index_analysis.h"
#include "sensitivity/sparse_sensitivity_step.h"
#include "system/stage_method.h"

namespace sfdae::core {

class SparseSensitivityStages {
 public:
  // Both arguments must outlive this object.
  SparseSensitivityStages(RecordedProblem& problem, ParameterSeries& parameters)
      : problem_(problem), parameters_(parameters) {}

  void prepare(const IndexAnalysis& analysis);
  // Reading restores the prepared state for the values of the analysis, pivots included. Throws DamagedArchive.
  void archive(Archive& archive, const IndexAnalysis& analysis);
  // Returns whether this method can solve the stages: matrices are sparse, and pivots do not have to be chosen often.
  bool is_possible(const StageMethod& method) const;
  // x' = xdot, in the user's units.
  PointStatus keep(const StageMethod& method, int i, double t, const double* x, const double* xdot);
  // Solves a step h from S_start; S: one block for each stage. Returns ok or singular.
  PointStatus solve(const StageMethod& method, double h, const double* S_start, double* S);
  const CallbackError& callback_error() const { return callback_error_; }

 private:
  void resize(int s);
  void set_values(const StageMethod& method, double h);
  void set_right_hand_sides(const StageMethod& method, double h, const double* S_start);
  bool solve_system();

  RecordedProblem& problem_;
  ParameterSeries& parameters_;
  bool fits_ = false;
  int s_ = 0;
  std::vector<RecordedEntry> entries_;
  std::vector<std::size_t> positions_;  // of each entry at each stage: of F_x' for all S_j, of F_x for S_i alone
  std::vector<int> limits_;
  std::vector<double> jet_, derivatives_;  // derivatives: a block for each stage
  std::vector<double> F_p_;                // n x count for each stage
  std::vector<double> values_, right_, solution_;
  SparsePattern pattern_;
  PlannedLu planned_;
  CallbackError callback_error_;
};

}  // namespace sfdae::core
