// The strangeness-free system of a linear problem at one point, in null-space form.
//
// With tau the time scale, D the row scaling and all data of taylor_data.h:
//
//     0 = A2 x + f2        (a rows)        x = xp + T2 z,  A2 T2 = 0,  xp of smallest norm
//     Z1^T [ tau E D_h w - C x - f ] = 0   (d rows)        w = W x
//
//     W = P = E^+ E:  C = A + E'(I - P)  (as E P' = E'(I - P));   W = E:  C = A + E';   W = I:  C = A
//
// so that a step solves for z only: d + u unknowns. Free components of the solution (u > 0) obey U^T D_h x = 0,
// U = T2 Uz an orthonormal basis of ker [E1; A2].
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "linalg/archive.h"
#include "linalg/arena.h"
#include "linalg/matrix.h"
#include "linalg/room.h"
#include "problem/taylor_data.h"
#include "reduction/constraint_factors.h"
#include "reduction/differential_factors.h"
#include "reduction/elimination.h"
#include "reduction/judge.h"
#include "reduction/leading_projector.h"
#include "reduction/prescription.h"

namespace sfdae::core {

// Right-hand sides of the constraints only, or also those of the differential equations, which points without a step do
// not need.
enum class RightHandSides { constraints, all };

enum class LeadingTerm { automatic, projector, matrix, identity };

// Dimensions found at a point.
struct PointRanks {
  int rank_E = 0;
  int a = 0;  // without prescribed components
  int d = 0;
  int v_hat = 0;                  // rows carried that are redundant
  bool prescription_fits = true;  // the prescribed components determine as many free ones
};

class NullSpaceForm {
 public:
  // Memory for m x n problems whose elimination carries at most `carried` rows.
  void resize(int m, int n, int num_prescribed, int carried);
  // The same for find_ranks() alone.
  void resize_for_ranks(int m, int n, int carried);

  // Results computed from an elimination: ranks alone; constraints, with T2 and xp; or all. carried.rhs is one column,
  // f^.
  PointRanks find_ranks(const TaylorData& data, const Carried& carried, Judge& judge, Arena& arena);
  PointRanks build_constraints(const TaylorData& data, const Carried& carried, Prescription prescription,
                               Judge& judge, Arena& arena);
  PointRanks build(const TaylorData& data, const Carried& carried, Prescription prescription, LeadingTerm leading,
                   Judge& judge, Arena& arena);
  // A new right-hand side f_hat, f_0 = data.f(0) and new prescribed values; all matrices stay.
  void replace_rhs(const TaylorData& data, const double* f_hat, Prescription prescription, Arena& arena,
                   RightHandSides rhs = RightHandSides::all);

  int m = 0, n = 0;
  int a = 0, d = 0, u = 0;                // a with, u without the prescribed components
  int unknowns() const { return d + u; }  // columns of T2, unknowns of a step

  ConstView T2() const { return {T2_.data(), n, unknowns(), std::max(n, 1)}; }
  const double* xp() const { return T2_.data() + static_cast<std::ptrdiff_t>(unknowns()) * n; }
  ConstView Z1() const { return {Z1_.data(), m, d, std::max(m, 1)}; }
  ConstView G() const { return {G_.data(), d, unknowns(), std::max(d, 1)}; }                   // Z1^T E T2
  ConstView B() const { return {B_.data(), d, unknowns(), std::max(d, 1)}; }                   // Z1^T C T2
  const double* b() const { return B_.data() + static_cast<std::ptrdiff_t>(unknowns()) * d; }  // Z1^T (C xp + f)
  ConstView T2_xp() const { return T2_xp_of(unknowns()); }                                     // [T2 xp]
  ConstView B_b() const { return {B_.data(), d, unknowns() + 1, std::max(d, 1)}; }             // [B b]
  const double* g0() const { return g0_.data(); }                                              // Z1^T E xp
  ConstView Uz() const { return differential_.kernel(); }   // orthonormal, G Uz = 0
  ConstView kernel() const { return projector_.kernel(); }  // K: orthonormal, E K = 0; none unless W = P
  // Contradiction of redundant equations: largest entry of Z3^T g relative to the entries of f^ and x.
  double inconsistency() const { return inconsistency_; }

  // M := [c_tau G - B; c_tau Uz^T], the matrix of a step, for a real or complex c_tau.
  template <class Scalar>
  void step_matrix(Scalar c_tau, BasicView<Scalar> M) const {
    for (int j = 0; j < unknowns(); ++j) {
      const double* G_j = G().column(j);
      const double* B_j = B().column(j);
      Scalar* to = M.column(j);
      for (int i = 0; i < d; ++i) to[i] = c_tau * G_j[i] - B_j[i];
      for (int i = d; i < unknowns(); ++i) to[i] = c_tau * Uz()(j, i - d);
    }
  }
  // z of smallest norm with G z = q.
  void solve_G(const double* q, double* z, Arena& arena) const { differential_.solve(q, z, arena); }
  // Sign of det G, 0 if it vanishes; u = 0 only.
  int sign_of_G() const { return differential_.determinant_sign(); }
  // For regular problems with mu = 0: the sign of det(Q1 Q1^T E + (I - Q1 Q1^T) A), Q1 a basis of range E, which is
  // independent of the choice of bases; otherwise, or if it vanishes, 0.
  int orientation() const { return orientation_; }
  // Smallest values kept in the decisions on A^ and on E T2 (a > 0, d > 0), or of about their size.
  double smallest_constraint() const { return constraints_.smallest_kept(); }
  double smallest_of_G() const { return differential_.smallest_kept(); }
  const ConstraintFactors& constraints() const { return constraints_; }
  int rank_of_constraints() const { return constraints_.rank(); }  // a without the prescribed components
  // y := P y for W = P, else y stays.
  void project(double* y, Arena& arena) const { projector_.apply(y, arena); }
  void project(View Y, Arena& arena) const { projector_.apply(Y, arena); }
  // Dimensions, T2 and Z1, for comparison with later points.
  void archive_bases(Archive& archive);

 private:
  // A^ and T2 without the prescribed components.
  PointRanks factor_constraints(const Carried& carried, Judge& judge, Arena& arena);
  struct PivotedFactors {
    View factors;
    int* pivots;
    double* tau;
  };
  int factor_differential(const PivotedFactors& ET, Judge& judge, Arena& arena);
  void factor_E_T2(const TaylorData& data, Judge& judge, Arena& arena);
  void factor_within_range(const Carried& carried, Judge& judge, Arena& arena);
  void build_differential_equations(const TaylorData& data, LeadingTerm leading, Arena& arena);
  void apply_C(const TaylorData& data, LeadingTerm leading, ConstView X, View CX, Arena& arena) const;

  View columns_T2(int count) { return {T2_.data(), n, count, n}; }
  ConstView T2_xp_of(int columns) const { return {T2_.data(), n, columns + 1, std::max(n, 1)}; }
  double* particular() { return T2_.data() + static_cast<std::ptrdiff_t>(unknowns()) * n; }

  ConstraintFactors constraints_;
  PrescribedDirections prescribed_;
  DifferentialFactors differential_;
  LeadingProjector projector_;
  Room T2_;  // [T2 | xp]
  Room Z1_, G_, B_, g0_;
  double inconsistency_ = 0.0;
  int orientation_ = 0;
};

}  // namespace sfdae::core
