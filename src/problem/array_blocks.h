// The blocks of the derivative array of a user: F_mu = (F, dF/dt, ..., d^mu F/dt^mu) and its Jacobian with respect to
// x, x', ..., x^(mu+1) contain all total derivatives of F, F_x and F_x' along the jet up to order mu:
//
//     J_kj = dF^(k)/dx^(j) = C(k, j) F_x^(k-j) + C(k, j-1) F_x'^(k-j+1),   0 <= k <= mu, 0 <= j <= mu + 1
//
// The first block column is F_x^(k), and J_k1 - k J_(k-1)0 is F_x'^(k). All other blocks follow from these.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

#include "expression/equation_names.h"
#include "linalg/index.h"

namespace sfdae::core {

// The array of `order` mu, of m equations in n unknowns. Matrices are column-major without padding.
struct ArrayShape {
  int m = 0, n = 0, order = 0;
  std::size_t rows() const { return index(m) * index(order + 1); }
  std::size_t columns() const { return index(n) * index(order + 2); }
  // Entries of F_x^(k), k = 0..mu, one after the other.
  std::size_t entries() const { return rows() * index(n); }
};

// The first entry of a Jacobian that is not finite, or that contradicts the entries before it.
struct ArrayFault {
  int row = -1, column = -1;  // in the Jacobian; -1: none
  double value = 0.0, expected = 0.0;
  bool exists() const { return row >= 0; }
  bool is_finite() const;
  // In words. where: for example "t = 0.5", or empty.
  std::string message(const ArrayShape& shape, const EquationNames& names, const std::string& where) const;
};

// Writes F_x^(k) and F_x'^(k), k = 0..mu, m x n matrices one after the other, and checks all blocks of the Jacobian,
// rows() x columns().
ArrayFault split_array(const ArrayShape& shape, const double* jacobian, double* F_x, double* F_xdot);

}  // namespace sfdae::core
