// The derivative array F_mu = 0 and F = 0 linearized at a jet and eliminated, for points nearby.
//
// Elimination is done once; residuals at other jets are transformed by it (stored_elimination.h) and become the
// constraints for a change dx = xp + T2 z of x (null_space_form.h, W = I), from which the change of y follows. Z1 is
// that of the linearization.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "array/analyzed_equations.h"
#include "linalg/arena.h"
#include "linalg/index.h"
#include "reduction/judge.h"
#include "reduction/null_space_form.h"
#include "reduction/stored_elimination.h"
#include "system/dae_system.h"
#include "system/jet.h"
#include "system/step_matrix.h"

namespace sfdae::core {

// Scaled residuals of F_mu = 0, array_rows() entries each.
struct ArrayResiduals {
  double* f;            // -F_0, ..., -F_mu
  double* transformed;  // by the elimination
};

class ArrayLinearization {
 public:
  // The origin of a linearization.
  struct Origin {
    Jet jet;
    std::vector<double> rows;  // factors of rows that are preferred for it
    bool is_judged = false;    // ranks were decided there, not taken as known
    int age = 0;               // points accepted since; for checkpoints alone
  };

  // counts: reductions and factorizations are added to it.
  ArrayLinearization(AnalyzedEquations& problem, SystemCounts& counts, Arena& arena)
      : problem_(problem), counts_(counts), arena_(arena) {}
  // Memory for the values that the analysis has found.
  void resize();

  // Linearizes and eliminates at the jet; the ranks are judged there, or the known ones are taken. Throws Failure if
  // prescribed components do not determine the free part.
  PointStatus renew(const Jet& jet, bool judged);
  // False after a renewal that was interrupted, for lack of memory for example; then only a renewal is allowed.
  bool is_complete() const { return is_complete_; }
  // Number of renewals: data derived from the linearization are valid until it changes.
  long renewals() const { return renewals_; }
  // Restores the linearization with these ranks; origin tells whether they were judged.
  PointStatus restore(Origin origin, const RankSequence& ranks);
  void count_point() { ++origin_.age; }
  // Forbids solving points with it.
  void forget() { is_usable_ = false; }

  // True if the last renewal succeeded and was not forgotten; otherwise no point may be solved with it.
  bool is_usable() const { return is_usable_; }
  Origin& origin() { return origin_; }
  const Origin& origin() const { return origin_; }
  // Known ranks: those of the last successful renewal.
  const RankSequence& ranks() const { return ranks_; }
  // Null before the first renewal.
  const std::vector<double>* preferred_rows() const { return preferred_rows_.empty() ? nullptr : &preferred_rows_; }
  const PointQuality& quality() const { return quality_; }
  // True if a kept value is below unit roundoff, so that the ranks do not hold.
  bool has_tiny_pivots() const;
  const TaylorData& data() const { return data_; }
  const NullSpaceForm& form() const { return form_; }
  const StoredElimination& elimination() const { return elimination_; }
  StepMatrix& matrix() { return matrix_; }
  // n x (mu + 1) flags: components of y that some equation determines.
  const std::vector<char>& determined() const { return determined_; }
  // Effects of rounding errors of F on changes of x, y_1, ..., y_{mu+1}, scaled (docs/design/error_control.md).
  const std::vector<double>& noise() const { return noise_; }
  // Rounding errors of x, in the user's units.
  const std::vector<double>& rounding_errors() const { return rounding_errors_; }

  bool factor_step_matrix(double c);
  // All matrices of the stages of a step h.
  bool factor_stages(const StageMethod& method, double h);
  // Evaluates residuals.f at the jet.
  PointStatus evaluate_array(const Jet& jet, const ArrayResiduals& residuals);
  // f_0 of the equations for z := -tau F(t, x, xdot).
  PointStatus evaluate_differential(double t, const double* x, const double* xdot);
  // Sets the constraints of the form to those for changes of x at the jet, and residuals.transformed.
  void set_constraints(const Jet& jet, const ArrayResiduals& residuals, RightHandSides rhs = RightHandSides::all);
  // Finds z with Z1^T E (xp + T2 z) = 0.
  void keep_differential_part(double* z) const;
  // dx := xp + T2 z.
  void change_of_x(const double* z, double* dx) const;
  // Changes the jet by dx and by the change dy of y that belongs to it.
  void apply_change(const ArrayResiduals& residuals, const double* dx, double* dy, Jet& jet) const;
  // Number of rows of the step equations: Z1^T F, and the rows of Z2^T F_mu that are not redundant.
  std::size_t num_step_rows() const { return index(form_.d) + index(form_.rank_of_constraints()); }
  // Copies these rows of the residuals evaluated last.
  void copy_step_rows(const double* transformed, double* rows) const;
  // Adds the terms of these rows for sizes of the columns of the jet, in the user's units, and of the x' of a step.
  void add_step_terms(const Jet& sizes, const double* xdot, double* rows);
  // factor Uz^T T2^T v: the free part of v, which is in the user's units.
  void free_part(double factor, const double* v, double* to) const;
  // Sets the component of xdot along free directions to 0.
  void remove_free_part(double* xdot) const;
  // Changes xdot within the directions that the constraints leave free, so that F1(t, x, xdot) = 0.
  PointStatus correct_derivative(double t, const double* x, double* xdot);
  // Like StrangenessFreeSystem::error_in_x; all of dw if the linearization is not usable.
  void error_in_x(const double* dw, int count, double* dx) const;

 private:
  PointStatus linearize(const Jet& jet, bool judged);
  PointRanks eliminate_array(Judge& judge);
  PointStatus renew_with_other_ranks(const Jet& jet);
  std::optional<RankSequence> ranks_in_other_units(const Jet& jet);
  void measure_noise(const Jet& jet);
  void measure_constraint_terms();

  AnalyzedEquations& problem_;
  SystemCounts& counts_;
  Arena& arena_;
  Origin origin_;
  bool is_usable_ = false, is_complete_ = true;
  long renewals_ = 0;
  TaylorData data_;
  StoredElimination elimination_;
  NullSpaceForm form_;
  NullSpaceForm rank_form_;  // for trying other ranks
  RankSequence ranks_;
  std::vector<double> preferred_rows_;
  PointQuality quality_;
  std::vector<char> determined_;
  std::vector<double> noise_, rounding_errors_;
  StepMatrix matrix_;
  std::vector<double> constraint_terms_;  // sums of sizes in the rows of Z2^T F_mu: row by row, by columns of the jet
  long renewal_of_terms_ = -1;
};

}  // namespace sfdae::core
