// Components of x prescribed as functions of time.
// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/prescription.h"

#include <cmath>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"
#include "sfdae/sfdae.h"

namespace sfdae::core {

void demand_free_components(const std::vector<int>& prescribed, int u) {
  if (static_cast<int>(prescribed.size()) <= u) return;
  throw Failure(SFDAE_PRESCRIPTION_SINGULAR, format("%d components are prescribed, but only u = %d are free.",
                                                    static_cast<int>(prescribed.size()), u));
}

void demand_fitting_prescription(bool fits, double t) {
  if (fits) return;
  throw Failure(SFDAE_PRESCRIPTION_SINGULAR,
                format("the prescribed components do not determine the free part of the solution at t = %.15g: "
                       "choose others.",
                       t));
}

namespace {

// T2 has orthonormal columns: values are sines of angles. One below the square root of roundoff, 1e-8, leaves x with
// less than half of its digits.
constexpr double least_sine = 1e-8;

}  // namespace

void PrescribedDirections::resize(int n, int count) {
  n_ = n;
  P1_.resize(index(n) * index(count) + 1);
  R_.resize(index(count) * index(count) + 1);
}

bool PrescribedDirections::split(const std::vector<int>& components, View T2, Arena& arena) {
  const int n = T2.rows, columns = T2.cols, count = static_cast<int>(components.size());
  if (count > columns) return false;
  const Arena::Frame frame(arena);
  const View factors = arena.matrix(columns, count);
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < columns; ++j) factors(j, i) = T2(components[index(i)], j);
  double* tau = arena.take(index(count));
  factor_qr(factors, tau, arena);
  for (int i = 0; i < count; ++i)
    if (std::fabs(factors(i, i)) < least_sine) return false;
  copy(factors.block(0, 0, count, count), {R_.data(), count, count, count});
  const View Q = arena.matrix(columns, columns), moved = arena.matrix(n, columns);
  form_q(factors, count, tau, Q, arena);
  multiply(1.0, Op::plain, T2, Op::plain, Q, 0.0, moved);
  copy(moved.columns(0, count), {P1_.data(), n, count, n});
  copy(moved.columns(count, columns - count), T2.columns(0, columns - count));
  return true;
}

void PrescribedDirections::apply(Prescription prescription, double* xp, Arena& arena) const {
  const int count = prescription.count();
  if (count == 0) return;
  const Arena::Frame frame(arena);
  double* missing = arena.take(index(count));
  for (int i = 0; i < count; ++i) missing[i] = prescription.values[i] - xp[(*prescription.components)[index(i)]];
  solve_upper(Op::transposed, {R_.data(), count, count, count}, {missing, count, 1, count});
  multiply(1.0, Op::plain, ConstView{P1_.data(), n_, count, n_}, missing, 1.0, xp);
}

}  // namespace sfdae::core
