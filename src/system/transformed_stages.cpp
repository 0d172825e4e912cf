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

void TransformedStages::solve(const StageMethod& method, ConstView lu, const int* pivots, ConstView r, View z,
                              Arena& arena) {
  const int q = lu.rows;
  if (q == 0) return;
  const Arena::Frame frame(arena);
  solve_decoupled(
      method, r.top(q), arena.matrix(q, method.s), z.top(q), omega_.data(),
      [&](double* x) { solve_lu(lu, pivots, x); },
      [this](std::size_t k, std::complex<double>* omega) { solve_pair(k, omega); });
}

}  // namespace sfdae::core
