// Sparse matrices for tests and benchmarks.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/sparse_pattern.h"

namespace sfdae_test {

struct Triplet {
  int row, column;
  double value;
};

struct SparseMatrix {
  sfdae::core::SparsePattern pattern;
  std::vector<double> values;
};

// Entries at one place are added up.
SparseMatrix sparse_matrix(int size, std::vector<Triplet> entries);
// Row i and column j go to places row[i], column[j].
SparseMatrix permuted(const SparseMatrix& matrix, const std::vector<int>& row, const std::vector<int>& column);

// I - h J of two reacting species in each cell of a line (the Brusselator): blocks of 2 x 2.
SparseMatrix reaction_diffusion(int cells);
// Five points on a rectangle, the value 0 around it.
SparseMatrix laplacian(int width, int height);
// Stokes' equations on a square of cells with staggered velocities: a saddle point without a diagonal for the pressure,
// which is fixed in one cell.
SparseMatrix flow(int cells);
// A diagonal, and as many last rows and columns that are full.
SparseMatrix arrow(int size, int full);
// Entries in a band, all of them random, and larger on the diagonal by `dominance`.
SparseMatrix random_band(int size, int lower, int upper, double dominance, unsigned seed);
// About `per_column` entries in each column besides a random transversal.
SparseMatrix random_sparse(int size, int per_column, unsigned seed);

}  // namespace sfdae_test
