// The projector P = E^+ E along ker E.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/leading_projector.h"

#include "linalg/dense.h"
#include "linalg/index.h"

namespace sfdae::core {

void LeadingProjector::resize(int n) {
  K_.resize(index(n) * index(n) + 1);
  n_ = n;
}

// The rows of E span those of [R11 R12] P^T; ker E is their orthogonal complement.
void LeadingProjector::build(const Carried& carried, Arena& arena) {
  const int r = carried.rank_E;
  count_ = n_ - r;
  if (count_ == 0) return;
  const Arena::Frame frame(arena);
  const View rows = arena.matrix(n_, r);
  for (int j = 0; j < n_; ++j)
    for (int i = 0; i < r; ++i) rows(carried.pivots[j], i) = i <= j ? carried.R(i, j) : 0.0;
  double* tau = arena.take(index(r) + 1);
  factor_qr(rows, tau, arena);
  form_last_q(rows, r, tau, {K_.data(), n_, count_, n_}, arena);
}

void LeadingProjector::apply(double* y, Arena& arena) const {
  if (count_ == 0) return;
  const Arena::Frame frame(arena);
  double* coefficients = arena.take(index(count_));
  multiply(1.0, Op::transposed, kernel(), y, 0.0, coefficients);
  multiply(-1.0, Op::plain, kernel(), coefficients, 1.0, y);
}

void LeadingProjector::apply(View Y, Arena& arena) const {
  if (count_ == 0) return;
  const Arena::Frame frame(arena);
  const View coefficients = arena.matrix(count_, Y.cols);
  multiply(1.0, Op::transposed, kernel(), Op::plain, Y, 0.0, coefficients);
  multiply(-1.0, Op::plain, kernel(), Op::plain, coefficients, 1.0, Y);
}

}  // namespace sfdae::core
