// A highest-value transversal: one unknown for each equation, no unknown twice, so that the sum of the orders is the
// largest [P01]. An assignment problem with few small costs.
//
// [HK73]  J. E. Hopcroft, R. M. Karp: An n^(5/2) Algorithm for Maximum Matchings in Bipartite Graphs. SIAM J. Comput. 2
//         (1973), 225-231.
// [BDM09] R. Burkard, M. Dell'Amico, S. Martello: Assignment Problems. SIAM, 2009, chapter 4.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "structure/signature.h"

namespace sfdae::core {

// These equations contain these unknowns only, which are fewer, whatever their values.
struct Overdetermined {
  std::vector<int> equations, unknowns;
};

struct Transversal {
  std::vector<int> unknown_of, equation_of;  // each the inverse of the other; -1: none
  Overdetermined overdetermined;             // empty if there is a transversal
  bool exists() const { return overdetermined.equations.empty(); }
};

// The time is nearly proportional to the number of entries if orders are small.
Transversal highest_transversal(const Signature& signature);

}  // namespace sfdae::core
