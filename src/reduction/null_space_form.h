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
#include "problem/taylor_data.h"
#include "reduction/elimination.h"
#include "reduction/judge.h"

namespace sfdae::core {

enum class LeadingTerm { automatic, projector, matrix, identity };

// Dimensions that a point is found to have.
struct PointRanks {
  int rank_E = 0;
  int a = 0;  // without prescribed components
  int d = 0;
  int v_hat = 0;                  // rows carried that are redundant
  bool prescription_fits = true;  // the prescribed components determine as many free ones
};

// Components x_j that are prescribed, and their values at the point.
struct Prescription {
  const std::vector<int>* components = nullptr;
  const double* values = nullptr;
  int count() const { return components == nullptr ? 0 : static_cast<int>(components->size()); }
};

class NullSpaceForm {
 public:
  // Room for m x n problems whose elimination carries at most `carried` rows.
  void resize(int m, int n, int num_prescribed, int carried);

  // carried.rhs is one column, f^.
  PointRanks build(const TaylorData& data, const Carried& carried, Prescription prescription, LeadingTerm leading,
                   Judge& judge, Arena& arena);
  // A new right-hand side f_hat, f_0 = data.f(0) and new prescribed values; all matrices stay.
  void replace_rhs(const TaylorData& data, const double* f_hat, Prescription prescription, Arena& arena);

  int m = 0, n = 0;
  int a = 0, d = 0, u = 0;                // a with, u without the prescribed components
  int unknowns() const { return d + u; }  // columns of T2, unknowns of a step

  ConstView T2() const { return {T2_.data(), n, unknowns(), std::max(n, 1)}; }
  const double* xp() const { return T2_.data() + static_cast<std::ptrdiff_t>(unknowns()) * n; }
  ConstView Z1() const { return {Z1_.data(), m, d, std::max(m, 1)}; }
  ConstView G() const { return {G_.data(), d, unknowns(), std::max(d, 1)}; }                   // Z1^T E T2
  ConstView B() const { return {B_.data(), d, unknowns(), std::max(d, 1)}; }                   // Z1^T C T2
  const double* b() const { return B_.data() + static_cast<std::ptrdiff_t>(unknowns()) * d; }  // Z1^T (C xp + f)
  ConstView T2_xp() const { return {T2_.data(), n, unknowns() + 1, std::max(n, 1)}; }          // [T2 xp]
  ConstView B_b() const { return {B_.data(), d, unknowns() + 1, std::max(d, 1)}; }             // [B b]
  const double* g0() const { return g0_.data(); }                                              // Z1^T E xp
  ConstView Uz() const { return {Uz_.data(), unknowns(), u, std::max(unknowns(), 1)}; }
  ConstView kernel() const { return {K_.data(), n, kernel_, std::max(n, 1)}; }  // K: orthonormal, E K = 0
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
  void solve_G(const double* q, double* z, Arena& arena) const;
  // Sign of det G, 0 if it vanishes; u = 0 only.
  int sign_of_G() const;
  // y := P y = y - K K^T y.
  void project(double* y, Arena& arena) const;
  void project(View Y, Arena& arena) const;
  // Dimensions, T2 and Z1: what later points are compared with.
  void archive_bases(Archive& archive);

 private:
  void build_constraints(const Carried& carried, Judge& judge, Arena& arena, PointRanks& ranks);
  void solve_constraints(const double* f_hat, double norm_f, Arena& arena);
  bool build_prescription(const std::vector<int>& components, Arena& arena);
  void apply_prescription(Prescription prescription);
  void build_kernel(const Carried& carried, Arena& arena);
  void build_differential_equations(const TaylorData& data, Judge& judge, Arena& arena, PointRanks& ranks);
  void factor_G(ConstView R3, const int* pivots, Arena& arena);

  View columns_T2(int j, int count) { return {T2_.data() + static_cast<std::ptrdiff_t>(j) * n, n, count, n}; }

  LeadingTerm leading_ = LeadingTerm::projector;
  std::vector<double> T2_;  // [T2 | xp]
  std::vector<double> Z1_, G_, B_, Uz_, g0_, K_;
  std::vector<double> R3_;  // u = 0: R of E T2; u > 0: R of its transpose
  std::vector<double> Qg_;  // u > 0: rows of G
  std::vector<int> pivots3_;
  std::vector<double> factors_, tau_;  // QR of A^^T, n x carried rows
  std::vector<int> pivots_;
  int carried_ = 0, rank_ = 0, kernel_ = 0;
  std::vector<double> P1_, Rp_;  // prescribed: directions n x np in which they act, and their R
  double inconsistency_ = 0.0;
};

}  // namespace sfdae::core
