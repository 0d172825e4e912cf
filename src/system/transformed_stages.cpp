// The stages of an implicit Runge-Kutta step decoupled.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/transformed_stages.h"

#include <algorithm>

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

void TransformedStages::forget() {
  for (auto& matrix : matrices_) matrix.clear();
}

void TransformedStages::solve_pair(std::size_t k, std::complex<double>* omega) {
  solve_lu(ComplexView{matrices_[k].data(), order_, order_, std::max(order_, 1)}, pivots_[k].data(), omega);
}

// rho = T^-1 r; one real and (s-1)/2 complex systems for zeta; z = T zeta.
void TransformedStages::solve(const StageMethod& method, ConstView lu, const int* pivots, ConstView r, View z,
                              Arena& arena) {
  const int s = method.s, q = lu.rows;
  if (q == 0) return;
  const Arena::Frame frame(arena);
  const View rho = arena.matrix(q, s);
  multiply(1.0, Op::plain, r.top(q), Op::transposed, ConstView{method.T_inverse.data(), s, s, s}, 0.0, rho);
  solve_lu(lu, pivots, rho.column(0));
  for (int k = 0; 2 * k + 2 < s; ++k) {
    double* first = rho.column(2 * k + 1);
    double* second = rho.column(2 * k + 2);
    for (int i = 0; i < q; ++i) omega_[index(i)] = {first[i], -second[i]};
    solve_pair(index(k), omega_.data());
    for (int i = 0; i < q; ++i) {
      first[i] = omega_[index(i)].real();
      second[i] = -omega_[index(i)].imag();
    }
  }
  multiply(1.0, Op::plain, rho, Op::transposed, ConstView{method.T.data(), s, s, s}, 0.0, z.top(q));
}

}  // namespace sfdae::core
