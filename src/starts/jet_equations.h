// The equations F_l = 0 of a derivative array, linearized at a jet, and the changes of the jet that solve them.
//
// Unknowns of a change are x, y_1, ..., y_{l+1}, one below the other, scaled as in taylor_data.h.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include "linalg/arena.h"
#include "problem/nonlinear_problem.h"
#include "reduction/judge.h"
#include "reduction/null_space_form.h"
#include "reduction/stored_elimination.h"
#include "starts/least_change.h"
#include "system/jet.h"

namespace sfdae::core {

class JetEquations {
 public:
  // A jet after a change.
  struct Trial {
    Jet jet;
    double norm = 0.0;   // of its residuals
    double moved = 0.0;  // how far what is differentiated went, in the sizes that count as one
    bool valid = false;
  };

  JetEquations(NonlinearProblem& problem, const Units& units) : problem_(problem), units_(units) {}

  // Components of x that must not change (n flags, or empty).
  const std::vector<char>& fixed() const { return fixed_; }
  void set_fixed(std::vector<char> fixed) { fixed_ = std::move(fixed); }
  // What is differentiated stays if it can: x changes as least_change.h says. sizes: of changes of x that count as
  // one, n of them in the user's units.
  void keep_differentiated(std::vector<double> sizes) { sizes_ = std::move(sizes); }
  bool keeps_differentiated() const { return !sizes_.empty(); }

  // time_scale 0: chosen. Throws Failure where the equations cannot be evaluated.
  void linearize(const Jet& jet, int level, double time_scale);
  double time_scale() const { return data_.time_scale; }
  const Units& units() const { return units_; }
  // 2-norm of the scaled residuals at the jet of the linearization.
  double norm() const { return norm_; }
  bool E0_was_rounding() const { return data_.E0_was_rounding; }
  // Whether some equation has a derivative of component j.
  bool has_derivative_of(int j) const;
  // Residuals relative to what was added up in them.
  bool is_converged(const Jet& jet, double tolerance) const;
  // What counts as noise in rank decisions at a jet with residuals, relative to the coefficients
  // (docs/design/rank_decisions.md).
  double residual_noise() const;

  // The staged elimination, with the ranks that it finds. noise: of the coefficients, as they are not those of a
  // consistent jet.
  const RankSequence& eliminate_staged(NoiseModel model, double noise);
  // By the last one: the smallest change of x, or, if `keep` and that is asked for, the one that moves what is
  // differentiated least. False if nothing finite is found, as below.
  bool staged_change(bool keep, std::vector<double>& change);
  // Of the last staged_change: see Trial.
  double moved_by_last_change() const { return moved_; }
  // Whether the change of every x_i is small beside x_i, what is added up in the constraints of x_i by the last
  // elimination, or the size of changes that counts as one.
  bool is_negligible(const Jet& jet, const std::vector<double>& change) const;
  // By the last elimination, for another change of x.
  void recover_derivatives(std::vector<double>& change);
  // change = U J^T (J J^T + damping I)^-1 f, J in units of U.
  bool damped_change(const Jet& jet, double damping, std::vector<double>& change);
  // The smallest change in units of U. Singular values at the level of the residuals are dropped, up to
  // most_dropped.
  bool dense_change(const Jet& jet, double most_dropped, std::vector<double>& change) const;
  Trial try_change(const Jet& jet, const std::vector<double>& change);

  // Throws Failure SFDAE_NO_CONSISTENT_VALUES: the largest residuals, in words.
  [[noreturn]] void give_up(const Jet& jet) const;

 private:
  // 2-norm of the residuals as scaled by the present data; infinite where F cannot be evaluated.
  double residual_norm(const Jet& jet);
  // U: changes that count as one, of x relative to its size, of y more.
  std::vector<double> unit_changes(const Jet& jet) const;
  std::vector<double> change_of_kept();

  NonlinearProblem& problem_;
  const Units& units_;
  std::vector<char> fixed_;
  std::vector<double> sizes_;
  int level_ = 0;
  TaylorData data_;
  double norm_ = 0.0, moved_ = 0.0;
  std::vector<double> residuals_;
  // The last elimination: of all rows, and what it leaves of them; its ranks, that of E_0, and what is kept by them.
  StoredElimination stored_;
  NullSpaceForm form_;
  RankSequence ranks_;
  int rank_E_ = 0;
  double kept_ = 1.0;
  Arena arena_;
};

}  // namespace sfdae::core
