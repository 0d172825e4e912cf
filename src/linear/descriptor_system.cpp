// SPDX-License-Identifier: BSD-3-Clause
#include "linear/descriptor_system.h"

#include <cmath>

#include "problem/failure.h"

namespace sfdae::core {

namespace {

[[noreturn]] void throw_singular_pencil(const DescriptorSystem& system, const CharacteristicValues& values) {
  throw Failure(SFDAE_SINGULAR,
                format("the pencil s E - A, %d x %d, is singular for every s (%s): it has no poles and no transfer "
                       "function. Free components have to be inputs, redundant equations have to be left out.",
                       system.equations(), system.unknowns(), describe(values).c_str()));
}

double largest(const ShiftedPencil::Vector& x) {
  double result = 0.0;
  for (const std::complex<double>& value : x) result = std::max(result, std::abs(value));
  return result;
}

}  // namespace

PencilSpectrum poles(const DescriptorSystem& system, double rank_tol) {
  PencilSpectrum found = spectrum_of_pencil(system.E, system.A, rank_tol, "pencil s E - A");
  if (!found.is_regular()) throw_singular_pencil(system, found.values);
  return found;
}

PencilSpectrum invariant_zeros(const DescriptorSystem& system, double rank_tol) {
  const int m = system.equations(), n = system.unknowns(), q = system.inputs(), p = system.outputs();
  // E x' = A x + B u, 0 = C x + D u.
  Matrix E(m + p, n + q), A(m + p, n + q);
  copy(system.E, E.view().block(0, 0, m, n));
  copy(system.A, A.view().block(0, 0, m, n));
  if (q > 0) copy(system.B, A.view().block(0, n, m, q));
  if (p > 0) copy(system.C, A.view().block(m, 0, p, n));
  if (p > 0 && q > 0) copy(system.D, A.view().block(m, n, p, q));
  return spectrum_of_pencil(E, A, rank_tol, "system pencil [s E - A, -B; C, D]");
}

TransferFunction::TransferFunction(const DescriptorSystem& system) : system_(system), pencil_(system.E, system.A) {
  if (system.equations() != system.unknowns())
    throw_singular_pencil(system, {0, 0, 0, std::max(0, system.unknowns() - system.equations()),
                                   std::max(0, system.equations() - system.unknowns())});
}

// One step of refinement reduces errors to those of relative errors of the entries, and measures them (Skeel 1980).
ShiftedPencil::Vector TransferFunction::solve(int input) {
  constexpr double no_digits = 0.1;
  const int n = pencil_.size();
  Vector b(index(n));
  for (int i = 0; i < n; ++i)
    b[index(i)] = times_power_of_two(system_.B(i, input), pencil_.row_exponents()[index(i)]);
  Vector x = b;
  pencil_.solve(Op::plain, x);
  Vector change = pencil_.product(Op::plain, x);
  for (std::size_t i = 0; i < b.size(); ++i) change[i] = b[i] - change[i];
  pencil_.solve(Op::plain, change);
  if (!(largest(change) <= no_digits * largest(x)))
    throw Failure(SFDAE_SINGULAR, format("s E - A is singular but for rounding errors at s = %.15g %+.15g i: a pole.",
                                         pencil_.s().real(), pencil_.s().imag()));
  for (std::size_t i = 0; i < b.size(); ++i) x[i] += change[i];
  return x;
}

void TransferFunction::evaluate(std::complex<double> s, std::complex<double>* H) {
  if (!pencil_.factor(s))
    throw Failure(SFDAE_SINGULAR,
                  format("s E - A is singular at s = %.15g %+.15g i: a pole, or the pencil is singular for every s.",
                         s.real(), s.imag()));
  const int p = system_.outputs();
  for (int k = 0; k < system_.inputs(); ++k) {
    Vector x = solve(k);
    for (int j = 0; j < pencil_.size(); ++j)
      x[index(j)] = times_power_of_two(x[index(j)], pencil_.column_exponents()[index(j)]);
    for (int i = 0; i < p; ++i) {
      std::complex<double> sum = system_.D(i, k);
      for (int j = 0; j < pencil_.size(); ++j) sum += system_.C(i, j) * x[index(j)];
      H[index(k) * index(p) + index(i)] = sum;
    }
  }
}

}  // namespace sfdae::core
