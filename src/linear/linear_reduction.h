// Reduction of a linear problem at a point with known ranks: only a point where they differ is examined further.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/archive.h"
#include "linalg/arena.h"
#include "linalg/matrix.h"
#include "linear/linear_point.h"
#include "problem/linear_problem.h"
#include "system/strangeness_free_system.h"

namespace sfdae::core {

class LinearReduction {
 public:
  // The caller keeps all three alive.
  LinearReduction(LinearProblem& problem, const AnalysisSettings& settings, Arena& arena)
      : problem_(problem), settings_(settings), arena_(arena) {}
  // The analysis holds from now on.
  void start(const IndexAnalysis& analysis);

  // Fills the point. error: of the callback called last; count: of reductions, raised. Throws Failure if the
  // prescribed components do not fit.
  PointStatus reduce(double t, const KnownForm& known, LinearPoint& point, CallbackError& error, long& count);

  // Constant problems, from the first point on: E and A stay, so that f alone is evaluated and transformed.
  bool has_constant_form() const { return has_constant_form_; }
  void forget_constant_form() { has_constant_form_ = false; }
  PointStatus replace_rhs(double t, int mu, LinearPoint& point, CallbackError& error);

  // Change of x, consistent at the point reduced last with its differential part held, due to errors of derivatives:
  // the point is reduced again with data that have these errors, their signs at random.
  void errors_of_x(const KnownForm& known, const LinearPoint& point, const double* x, double* errors);

  // Scaling of rows from now on; RowScaling::each unless set.
  RowScaling rows() const { return rows_; }
  void set_rows(RowScaling rows) { rows_ = rows; }
  // The row factors of the point are preferred from now on.
  void prefer_rows_of(const LinearPoint& point);
  void archive_preferred_rows(Archive& archive, int m) { archive.reals(preferred_rows_, index(m)); }
  // The largest row over the smallest, at this point or by the factors preferred, whichever is less: it diverges
  // where a row vanishes.
  double row_ratio(const LinearPoint& point) const;

 private:
  // One way to reduce a point: with the unit of time, the factors of rows and the noise model given.
  struct Attempt {
    double t, time_scale;
    RowScaling rows;
    NoiseModel noise;
    const RankSequence* known_ranks = nullptr;  // taken, not decided
  };
  PointStatus attempt(const Attempt& attempt, const KnownForm& known, LinearPoint& point, CallbackError& error,
                      long& count);
  PointStatus attempt_others(double t, const KnownForm& known, LinearPoint& point, CallbackError& error, long& count);
  PointStatus keep_known_ranks(double t, const KnownForm& known, LinearPoint& point, CallbackError& error,
                               long& count);
  PointRanks build_form(const Attempt& attempt, const KnownForm& known, LinearPoint& point);
  CallbackError evaluate_prescribed(double t);
  bool build_changed_form(const KnownForm& known, const LinearPoint& point, TaylorData& changed, NullSpaceForm& form);

  LinearProblem& problem_;
  const AnalysisSettings& settings_;
  Arena& arena_;
  RowScaling rows_ = RowScaling::each;
  // Row factors at the point accepted last: superconvergence needs equations that depend smoothly on t, and jumps of
  // kept values would look like changes.
  std::vector<double> preferred_rows_;
  NoiseModel noise_ = NoiseModel::pivots;  // the first one tried
  std::vector<double> prescribed_values_;
  // Constant problems: f^ = Z^T (f_0, ..., f_mu).
  Matrix Zt_;
  TaylorData rhs_;
  bool has_constant_form_ = false;
  RankSequence ranks_, candidate_;  // of the last point where the values known hold, and of the one tried last
};

}  // namespace sfdae::core
