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

// ker E = range of P [-R11^-1 R12; I], orthonormalized.
void LeadingProjector::build(const Carried& carried, Arena& arena) {
  const int r = carried.rank_E;
  count_ = n_ - r;
  if (count_ == 0) return;
  const Arena::Frame frame(arena);
  const View top = arena.matrix(r, count_);
  copy(carried.R.block(0, r, r, count_), top);
  solve_upper(Op::plain, carried.R.block(0, 0, r, r), top);
  const View basis = arena.matrix(n_, count_);
  fill(basis, 0.0);
  for (int j = 0; j < count_; ++j) {
    for (int i = 0; i < r; ++i) basis(carried.pivots[i], j) = -top(i, j);
    basis(carried.pivots[r + j], j) = 1.0;
  }
  double* tau = arena.take(index(count_));
  factor_qr(basis, tau, arena);
  form_q(basis, count_, tau, {K_.data(), n_, count_, n_}, arena);
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
