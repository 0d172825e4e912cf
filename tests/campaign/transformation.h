// Regular matrices P(s), constant or varying, with their Taylor series: a constant matrix, then elementary operations
// on its rows.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "taylor_series.h"

namespace campaign {

enum class TransformationKind {
  dense,             // constant, U diag(sigma) V
  integer,           // constant, unimodular: shears by small integers, exact
  sparse,            // constant, a few rotations and shears of a permutation
  rotating,          // rotations with angles w s + phi of a sparse or orthogonal matrix
  polynomial,        // block-triangular with polynomials above the diagonal blocks
  exact_polynomial,  // the same with integer coefficients
  mixed              // both
};

class Transformation {
 public:
  // |P| |P^-1| <= condition for |s| <= 1.5.
  Transformation(TransformationKind kind, int n, double condition, RandomNumbers& random);

  bool constant() const { return constant_; }
  // All coefficients are integers.
  bool exact() const { return exact_; }
  TaylorMatrix series(double s, int order) const;

 private:
  // Rows i and j rotated by the angle frequency * s + phase.
  struct Rotation {
    int i, j;
    double frequency, phase;
  };
  // Row i gets p(s) times row j.
  struct Shear {
    int i, j;
    std::array<double, 4> p;
  };
  struct Operation {
    bool rotates;
    Rotation rotation;
    Shear shear;
  };

  void start_dense(double condition, RandomNumbers& random);
  void start_permuted(RandomNumbers& random);
  void add_rotations(int count, bool vary, RandomNumbers& random);
  void add_shears(double condition, int degree, bool integers, RandomNumbers& random);

  int n_;
  bool constant_ = true, exact_ = true;
  DenseMatrix start_;
  std::vector<Operation> operations_;
};

}  // namespace campaign
