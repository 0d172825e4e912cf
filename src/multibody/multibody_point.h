// A mechanical system with constraints at one point (t, q, v): accelerations and forces of constraints.
//
//     K (a; mu) = (f; -s),   K = [M C^T; C 0]
//
// with independent rows of C; the other mu are zero until the solution of least norm is asked for.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/arena.h"
#include "linalg/matrix.h"
#include "multibody/multibody_partition.h"
#include "multibody/multibody_problem.h"
#include "multibody/multibody_tangent.h"

namespace sfdae::core {

// (t, q, v) without evaluated terms.
struct MultibodyPhasePoint {
  double t = 0.0;
  std::vector<double> q, v;
};

// Limits within which accelerations are computed by C M^-1 C^T; beyond them its condition would be much worse than that
// of K. Its condition contains the ratio of the masses, and the square of that of C: the square of this pivot loses
// four of sixteen digits.
inline constexpr double smallest_mass_ratio = 1e-4;
inline constexpr double smallest_pivot_with_masses = 1e-2;

class MultibodyPoint {
 public:
  void resize(const MultibodySizes& sizes);

  double t = 0.0;
  std::vector<double> q, v;
  MultibodyTerms terms;
  std::vector<double> a, mu;
  // Units of the rows of g and of C v + r: the lengths of their gradients; for rows g_q S that of g_q times the mean
  // size of S.
  std::vector<double> position_units, velocity_units;

  MultibodyPhasePoint phase_point() const { return {t, q, v}; }
  MultibodyState state() const { return {t, q.data(), v.data(), a.data(), mu.data()}; }
  void set(double new_t, const double* new_q, const double* new_v);
  ConstraintRows position_rows() const { return {terms.g_q.view(), position_units.data()}; }
  ConstraintRows velocity_rows() const { return {terms.C.view(), velocity_units.data()}; }
  void measure_rows();
  // C v + r, all rows.
  void velocity_residuals(double* residuals) const;
  // q' = S v
  void rates(double* rates) const;

  // Factors K with the independent rows; false if it is singular.
  bool factor(const std::vector<int>& rows, int rank);
  // a and mu from terms.
  void solve_accelerations(const std::vector<int>& rows, int rank);
  // a and mu for a diagonal mass of positive entries of similar size: (C M^-1 C^T) mu = C M^-1 f + s. False if the mass
  // is none, or that matrix is singular.
  bool solve_by_masses(const Partition& partition, const Tangent& tangent, Arena& arena);
  // a and mu without K: a = T y - N s with T^T M T y = T^T (f + M N s), which is cheaper for few free directions. False
  // if T^T M T is singular.
  bool solve_along(const Partition& partition, const Tangent& tangent, Arena& arena);
  // (y; z) := K^-1 (y; z)
  void solve(double* yz) const;
  void solve(View yz) const;
  void solve_transposed(View yz) const;
  int order() const { return order_; }
  // mu of least norm with the same C^T mu.
  void take_least_norm(const Partition& partition, Arena& arena) { take_least_norm(partition, mu.data(), arena); }
  void take_least_norm(const Partition& partition, double* forces, Arena& arena) const;

 private:
  int order_ = 0;
  Matrix K_;
  std::vector<int> pivots_;
  std::vector<double> solution_;
};

// |C| |(C Q2)^-1| at a point, rows in units of their lengths; infinite if singular.
double condition_of_constraints(const MultibodyPoint& point, const Partition& partition);
// Same for directions chosen at that very point, all rows being independent.
double condition_of_constraints(const MultibodyPoint& point);
// The largest residuals there of g = 0 and of C v + r = 0, in the same units.
double position_residual(const MultibodyPoint& point);
double velocity_residual(const MultibodyPoint& point);
// Return whether the constraints on positions, and those on velocities, hold there except for rounding errors of t, q
// and v.
bool positions_hold_to_rounding(const MultibodyPoint& point);
bool velocities_hold_to_rounding(const MultibodyPoint& point);
// Needs C v + r and |S| |v|; the latter is not read if S is the identity.
bool velocities_hold_to_rounding(const MultibodyPoint& point, const double* residuals, const double* rates);

}  // namespace sfdae::core
