// The change of values that makes them consistent and moves the differential variables as little as possible.
//
// With K spanning ker E, consistent points x + dx, Q^T dx = r (Q orthonormal: the normals of the constraints):
//
//     Q^T K P = Qc [R1; 0]        what the kernel can fulfil, and constraints B dx = b on E x alone, B K = 0
//     dx_1 = least |dx|, B dx = b     E x moves by E dx_1, as little as it can
//     dx = dx_1 + K c             least |K c| with R1 c = what remains
//
// The separation of the constraints does not depend on the units of the unknowns if K consists of unit vectors:
// unknowns whose derivative does not occur. |dx| is measured in the given sizes
// (docs/design/consistent_initialization.md).
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/matrix.h"

namespace sfdae::core {

// The kernel of E of the given rank: unit vectors for unknowns without a derivative, then the rest.
struct LeadingKernel {
  // known: an orthonormal basis of it, or empty.
  LeadingKernel(ConstView E, int rank, ConstView known = {});
  Matrix basis;  // K, orthonormal
  int num_unit_vectors = 0;
  // True if every unknown is differentiated by itself, or not at all.
  bool is_coordinates() const { return num_unit_vectors == basis.cols(); }
};

// Consistent points: base + directions z, with orthonormal directions.
struct ConsistentSet {
  const double* base;
  ConstView directions;
};

struct ChangeMeasure {
  std::vector<double> sizes;  // a change of x_j by sizes_j counts as one; positive
  // Least number of constraints that the kernel satisfies: its dimension less u, as it has u directions in common with
  // the set, by the rank of E T2. Cosines of angles between kernel and constraints depend on units; they find further
  // ones.
  int least_fulfilled;
  double noise;  // cosines below it count as zero
};

// Error of the directions that satisfy constraints, relative, if the decisions behind them kept values of this size.
double error_of_directions(int n, double kept);
// Cosine that counts as zero then.
double least_cosine(int n, double kept);

// dx such that x + dx is in the set.
std::vector<double> least_change(const ConsistentSet& set, const LeadingKernel& kernel, const ChangeMeasure& measure,
                                 const double* x);

// Sum of the terms of x in the constraints of x_i: row i of |I - T2 T2^T| |x|, T2 the directions of the set.
double size_in_constraints(const ConsistentSet& set, int i, const double* x);

// The part of dx that moves E x: orthogonal to the kernel in the norm of the sizes.
std::vector<double> differentiated_part(const LeadingKernel& kernel, const std::vector<double>& sizes,
                                        const std::vector<double>& dx);

}  // namespace sfdae::core
