// Permutations of rows and columns that make a sparse matrix a narrow band.
//
// [CM69]  E. Cuthill, J. McKee: Reducing the bandwidth of sparse symmetric matrices. Proc. 24th ACM National
// Conference,
//         1969, 157-172.
// [GL79]  A. George, J. W. H. Liu: An implementation of a pseudoperipheral node finder. ACM Trans. Math. Software 5
// (1979),
//         284-295.
// [HK73]  J. E. Hopcroft, R. M. Karp: An n^(5/2) algorithm for maximum matchings in bipartite graphs. SIAM J. Comput. 2
//         (1973), 225-231.
// [RS06]  J. K. Reid, J. A. Scott: Reducing the total bandwidth of a sparse unsymmetric matrix. SIAM J. Matrix Anal.
// Appl. 28
//         (2006), 805-821.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "linalg/sparse_pattern.h"

namespace sfdae::core {

// Row i goes to row_place[i], column j to column_place[j]; entries are then in the band -upper <= row - column <=
// lower.
struct BandOrder {
  std::vector<int> row_place, column_place;
  int lower = 0, upper = 0;
  // Operations of a factorization with row exchanges.
  double flops() const;
};

// column_of[i]: column of row i in a matching with as many rows as possible, -1 if it has none. Entries of the diagonal
// are preferred, then rows and columns with few entries [HK73].
std::vector<int> maximum_matching(const SparsePattern& pattern);

// The best of three: the given order; reverse Cuthill-McKee [CM69; GL79] on A + A^T after rows are matched to
// columns; the same on the bipartite graph of rows and columns, which needs no matching [RS06].
BandOrder band_order(const SparsePattern& pattern, const std::vector<int>& column_of);

}  // namespace sfdae::core
