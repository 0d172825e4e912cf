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
    double moved = 0.0;  // move of the differential variables, in the sizes that count as one
    bool valid = false;
  };

  JetEquations(NonlinearProblem& problem, const Units& units) : problem_(problem), units_(units) {}

  // Components of x that must not change (n flags, or empty).
  const std::vector<char>& fixed() const { return fixed_; }
  void set_fixed(std::vector<char> fixed) { fixed_ = std::move(fixed); }
  // Keeps differential variables if possible: x changes as in least_change.h. sizes: n changes of x that count as one,
  // in the user's units.
  void keep_differentiated(std::vector<double> sizes) { sizes_ = std::move(sizes); }
  bool keeps_differentiated() const { return !sizes_.empty(); }

  // time_scale 0: chosen. Throws Failure if the equations cannot be evaluated.
  void linearize(const Jet& jet, int level, double time_scale);
  double time_scale() const { return data_.time_scale; }
  const Units& units() const { return units_; }
  // 2-norm of the scaled residuals at the jet of the linearization.
  double norm() const { return norm_; }
  bool E0_was_rounding() const { return data_.E0_was_rounding; }
  // True if some equation contains a derivative of component j.
  bool has_derivative_of(int j) const;
  // True if residuals are small relative to their terms.
  bool is_converged(const Jet& jet, double tolerance) const;
  // Noise level of rank decisions at a jet with residuals, relative to the coefficients
  // (docs/design/rank_decisions.md).
  double residual_noise() const;

  // The staged elimination, with the ranks that it finds. noise: of the coefficients, as they are not those of a
  // consistent jet.
  const RankSequence& eliminate_staged(NoiseModel model, double noise);
  // Change by the last elimination: the smallest change of x or, if `keep` and this was requested, the one that moves
  // the differential variables least. False if nothing finite is found, as below.
  bool staged_change(bool keep, std::vector<double>& change);
  // Move by the last staged_change: see Trial.
  double moved_by_last_change() const { return moved_; }
  // True if the change of every x_i is small relative to x_i, to the terms in the constraints of x_i by the last
  // elimination, or to the size of changes that counts as one.
  bool is_negligible(const Jet& jet, const std::vector<double>& change) const;
  // Recovers the derivatives by the last elimination, for another change of x.
  void recover_derivatives(std::vector<double>& change);
  // change = U J^T (J J^T + damping I)^-1 f, J in units of U.
  bool damped_change(const Jet& jet, double damping, std::vector<double>& change);
  // The smallest change in units of U. Singular values at the level of the residuals are dropped, up to
  // most_dropped.
  bool dense_change(const Jet& jet, double most_dropped, std::vector<double>& change) const;
  Trial try_change(const Jet& jet, const std::vector<double>& change);

  // Throws Failure SFDAE_NO_CONSISTENT_VALUES; its message names the largest residuals.
  [[noreturn]] void give_up(const Jet& jet) const;

 private:
  // 2-norm of the residuals as scaled by the present data; infinite if F cannot be evaluated.
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
  // The last elimination of all rows, the form of its result, its ranks, that of E_0, and the values they kept.
  StoredElimination stored_;
  NullSpaceForm form_;
  RankSequence ranks_;
  int rank_E_ = 0;
  double kept_ = 1.0;
  Arena arena_;
};

}  // namespace sfdae::core
