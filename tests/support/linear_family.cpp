// SPDX-License-Identifier: BSD-3-Clause
#include "linear_family.h"

#include <stdexcept>
#include <vector>

namespace sfdae_test {

namespace {

// Plain derivative k out of the Taylor coefficients 0..k of an object with `size` entries.
void write_derivative(const std::vector<double>& coefficients, std::size_t size, int k, double* out) {
  const double* last = coefficients.data() + static_cast<std::size_t>(k) * size;
  for (std::size_t i = 0; i < size; ++i) out[i] = factorial(k) * last[i];
}

}  // namespace

LinearFamily::~LinearFamily() = default;

void LinearFamily::E(double t, int k, double* out) const {
  const auto size = static_cast<std::size_t>(m()) * static_cast<std::size_t>(n());
  std::vector<double> E(size * static_cast<std::size_t>(k + 1)), A(E.size());
  matrix_coefficients(t, k, E.data(), A.data());
  write_derivative(E, size, k, out);
}

void LinearFamily::A(double t, int k, double* out) const {
  const auto size = static_cast<std::size_t>(m()) * static_cast<std::size_t>(n());
  std::vector<double> E(size * static_cast<std::size_t>(k + 1)), A(E.size());
  matrix_coefficients(t, k, E.data(), A.data());
  write_derivative(A, size, k, out);
}

void LinearFamily::f(double t, int k, double* out) const {
  const auto size = static_cast<std::size_t>(m());
  std::vector<double> f(size * static_cast<std::size_t>(k + 1));
  vector_coefficients(t, k, f.data());
  write_derivative(f, size, k, out);
}

void LinearFamily::exact(double, double*, double*) const { throw std::logic_error(name_ + ": no exact solution"); }

}  // namespace sfdae_test
