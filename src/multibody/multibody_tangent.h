// Dependent directions as functions of independent ones under constraints C w = b at some point.
//
// With a partition [Q1 Q2] for which C Q2 is nonsingular,
//
//     [Q1^T; C]^-1 = [T N],   T = Q1 - Q2 E,   N = Q2 (C Q2)^-1,   E = (C Q2)^-1 C Q1
//
// so that w = T y + N b. At the point where an orthogonal partition was chosen, E = 0. For few uses, T is not formed: T
// y = Q1 y - N C Q1 y.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

#include "linalg/arena.h"
#include "linalg/matrix.h"
#include "multibody/multibody_partition.h"

namespace sfdae::core {

class Tangent {
 public:
  void resize(int directions, int constraints);
  // Fits N without T. False if C Q2 is singular. few: N is not formed, as products with its factors cost less.
  enum class Uses { many, few };
  bool fit(const Partition& partition, const ConstraintRows& constraints, Uses uses = Uses::many);
  // T and E, after fit; false if they are not finite.
  bool complete(const Partition& partition, Arena& arena);
  bool build(const Partition& partition, const ConstraintRows& constraints, Arena& arena) {
    return fit(partition, constraints) && complete(partition, arena);
  }
  bool is_complete() const { return is_complete_; }
  // Valid after complete().
  ConstView T() const { return {T_.data(), T_.rows(), T_.rows() - rank_, std::max(T_.rows(), 1)}; }
  // The independent rows in their units, row k times units()[k].
  ConstView rows() const { return {C_.data(), rank_, T_.rows(), std::max(rank_, 1)}; }
  const double* units() const { return units_.data(); }
  // w := w - N (C w + b), b of all rows or none: T y - N b for w = Q1 y.
  void enforce(const Partition& partition, const double* b, double* w, Arena& arena) const;
  // w := -N b, b the independent ones of all residuals.
  void correction(const Partition& partition, const double* residuals, double* w, Arena& arena) const;
  // mu := the independent multipliers with Q2^T C^T mu = Q2^T force, the others zero.
  void multipliers(const Partition& partition, const double* force, double* mu, Arena& arena) const;
  // max |E|, after complete(): about the tangent of the angle by which C has turned since the choice.
  double rotation() const { return rotation_; }
  double smallest_pivot() const { return pivot_; }
  // Sign of det C Q2.
  int sign() const { return sign_; }
  // Number of combinations of the constraints that vanish on the straight line from rows B at another point to C, where
  // sB + (1 - s) C is singular on Q2 (each counts once), and the row that turns most.
  struct ZeroCrossings {
    int count = 0;
    int row = -1;
  };
  ZeroCrossings zero_crossings_from(const Partition& partition, ConstView B, Arena& arena) const;
  // The real eigenvalue mu of largest size of B Q2 (C Q2)^-1, for which a combination of rows C - B / mu vanishes on
  // Q2, 0 if there is none, and the row that changes most.
  double fastest_change(const Partition& partition, ConstView B, int& row, Arena& arena) const;

 private:
  void relative_to_rows(const Partition& partition, ConstView B, View Xt, Arena& arena) const;
  bool invert(const Partition& partition, View C2);
  bool factor(View C2);
  void gather(const Partition& partition, const double* residuals, double* b) const;
  // w -= N b, rows of b in their units; b is overwritten.
  void subtract(const Partition& partition, double* b, double* w) const;

  int rank_ = 0;
  bool is_complete_ = false, has_N_ = false;
  Matrix C_;  // independent rows in their units
  Matrix T_;
  Matrix N_;   // for these rows, if has_N_
  Matrix lu_;  // (C Q2)^-1 where the rows are few, else the factors of C Q2
  std::vector<int> pivots_;
  std::vector<double> units_;
  double rotation_ = 0.0, pivot_ = 1.0;
  int sign_ = 1;
};

// Signs of det C Q2 on the levels of positions and velocities.
struct MultibodyOrientation {
  int positions = 1, velocities = 1;
  bool operator==(const MultibodyOrientation&) const = default;
};

// Tangents of the constraints on both levels; one for both if their rows are the same.
struct Tangents {
  Tangent positions, velocities;
  bool same_rows = false;
  const Tangent& of_velocities() const { return same_rows ? positions : velocities; }
  Tangent& of_velocities() { return same_rows ? positions : velocities; }
  MultibodyOrientation orientation() const { return {positions.sign(), of_velocities().sign()}; }
  double rotation() const {
    return same_rows ? positions.rotation() : std::max(positions.rotation(), velocities.rotation());
  }
};

}  // namespace sfdae::core
