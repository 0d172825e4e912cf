// Steps of regular problems of strangeness index 0: F(t, x, c x + w_rest) = 0, solved as it stands.
//
// If F_x' has rank d near the solution, these n equations are equivalent to F(t, x, y) = 0 and Z1^T F(t, x, c x +
// w_rest) = 0: the values of F(t, x, .) are a manifold of dimension d through F(t, x, y) = 0 with the tangent space Z1.
// So a step needs no projectors, only one evaluation of F in each iteration and one factorization of c F_x' + F_x. The
// factorization is reused while c changes little [BCP96, 5.2.2]; changes of x are then multiplied by 2 / (1 + c / c of
// the matrix), half-way between the right factors for a dominating F_x' and a dominating F_x
// (docs/design/iteration_matrices.md).
//
// [BCP96] K. E. Brenan, S. L. Campbell, L. R. Petzold: Numerical Solution of Initial-Value Problems in
//         Differential-Algebraic Equations. SIAM, 1996.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "array/analyzed_equations.h"
#include "array/nonlinear_iteration.h"
#include "linalg/archive.h"
#include "linalg/arena.h"
#include "problem/taylor_data.h"
#include "reduction/null_space_form.h"
#include "system/chord_iteration.h"
#include "system/jet.h"
#include "system/step_matrix.h"

namespace sfdae::core {

class IndexZeroStep {
 public:
  IndexZeroStep(AnalyzedEquations& problem, Arena& arena) : problem_(problem), arena_(arena) {}
  // Allocates memory for the values found by the analysis, and decides whether such steps are possible.
  void resize();
  bool is_possible() const { return is_possible_; }

  // Evaluates the Jacobian for later iterations. rows: preferred factors, or null.
  PointStatus renew(const Jet& jet, const std::vector<double>* rows);
  // Takes the Jacobian of a linearization made at the jet.
  void take(const Jet& jet, const TaylorData& data);
  void forget() { has_jacobian_ = false; }
  bool has_jacobian_of(double t) const { return has_jacobian_ && origin_.t == t; }
  bool has_jacobian() const { return has_jacobian_; }
  // True if the Jacobian is so near to the one whose ranks were judged that these ranks hold for it. False if this
  // cannot be decided without an elimination.
  bool has_ranks_of(const TaylorData& judged, const NullSpaceForm& form);

  // Like StrangenessFreeSystem::error_in_x if there are few constraints; otherwise returns false.
  bool error_in_x(const double* dw, int count, double* dx);

  // Solves the step for x and x', starting from the jet. noise: effects of rounding errors on changes of x, scaled.
  // factorizations: a count that is raised.
  struct Shared {
    const std::vector<double>& noise;
    ChordIteration& chord;
    long& factorizations;
  };
  PointStatus solve(const IterationTask& task, const Shared& shared, Jet& jet);
  // After a slow step: forgets the matrix and returns true if its c differs enough to be the cause.
  bool blames_matrix();

  // When reading, restores the Jacobian. Throws DamagedArchive.
  void archive(Archive& archive, long& factorizations);

 private:
  class Equations;
  bool find_constraints(const TaylorData& data);
  bool is_near(const TaylorData& judged, const NullSpaceForm& form, const double* factors);
  bool maps_by_kernel() const;
  bool prepare_kernel();
  bool prepare_matrix(double c, const Shared& shared);

  AnalyzedEquations& problem_;
  Arena& arena_;
  bool is_possible_ = false, has_jacobian_ = false;
  Jet origin_;                // of the Jacobian
  std::vector<double> rows_;  // preferred for it
  TaylorData data_;
  StepMatrix matrix_;
  double deviation_ = 0.0;  // |c - c of the matrix| / |c + c of the matrix|: the contraction due to its reuse
  double waste_ = 0.0;      // iterations that its reuse has cost so far
  std::vector<double> change_;
  std::vector<char> is_constraint_;  // rows of E that vanish
  bool has_kernel_ = false;          // that of the Jacobian
  std::vector<double> kernel_;       // K, n x a: E K = 0, A2 K = I
};

}  // namespace sfdae::core
