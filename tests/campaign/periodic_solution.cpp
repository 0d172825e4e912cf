// SPDX-License-Identifier: BSD-3-Clause
#include "periodic_solution.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <utility>

#include "nodal_equations.h"

namespace campaign {

namespace {

using Complex = std::complex<long double>;

// Gaussian elimination with row scaling and column pivoting; false if singular. X: right-hand sides, then solutions.
bool solve(MatrixOf<Complex> matrix, MatrixOf<Complex>& X) {
  const int n = matrix.rows;
  for (int i = 0; i < n; ++i) {
    long double largest = 0.0L;
    for (int j = 0; j < n; ++j) largest = std::max(largest, std::abs(matrix(i, j)));
    if (largest == 0.0L) return false;
    for (int j = 0; j < n; ++j) matrix(i, j) /= largest;
    for (int j = 0; j < X.columns; ++j) X(i, j) /= largest;
  }
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int i = k + 1; i < n; ++i)
      if (std::abs(matrix(i, k)) > std::abs(matrix(pivot, k))) pivot = i;
    if (std::abs(matrix(pivot, k)) == 0.0L) return false;
    for (int j = 0; j < n; ++j) std::swap(matrix(k, j), matrix(pivot, j));
    for (int j = 0; j < X.columns; ++j) std::swap(X(k, j), X(pivot, j));
    for (int i = k + 1; i < n; ++i) {
      const Complex factor = matrix(i, k) / matrix(k, k);
      if (factor == Complex(0.0L)) continue;
      for (int j = k; j < n; ++j) matrix(i, j) -= factor * matrix(k, j);
      for (int j = 0; j < X.columns; ++j) X(i, j) -= factor * X(k, j);
    }
  }
  for (int k = n - 1; k >= 0; --k) {
    for (int j = 0; j < X.columns; ++j) {
      for (int l = k + 1; l < n; ++l) X(k, j) -= matrix(k, l) * X(l, j);
      X(k, j) /= matrix(k, k);
    }
  }
  return true;
}

// (i omega E - A) X = F, entries of E and A changed by a random relative amount up to `change`; empty if singular.
std::vector<Complex> amplitudes(const NodalEquations& equations, double omega, double change, RandomNumbers& random) {
  const int n = equations.E.rows;
  MatrixOf<Complex> matrix(n, n), X(n, 1);
  const auto changed = [&](double entry) {
    return static_cast<long double>(entry) * (1.0L + static_cast<long double>(change * random.uniform(-1.0, 1.0)));
  };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      matrix(i, j) =
          Complex(-changed(equations.A(i, j)), static_cast<long double>(omega) * changed(equations.E(i, j)));
  for (const auto& source : equations.sources)
    X(source.row, 0) +=
        std::polar(1.0L, static_cast<long double>(source.phase)) * static_cast<long double>(source.amplitude);
  if (!solve(matrix, X)) return {};
  return X.entries;
}

// Norm of (sigma R)^2, R = (lambda E - A)^-1 E, sigma = Re lambda, unknowns measured by their sizes.
double resolvent_norm(const NodalEquations& equations, const std::vector<double>& sizes, Complex lambda) {
  const int n = equations.E.rows;
  MatrixOf<Complex> matrix(n, n), R(n, n);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const auto E = static_cast<long double>(equations.E(i, j)), A = static_cast<long double>(equations.A(i, j));
      matrix(i, j) = lambda * E - A;
      R(i, j) = lambda.real() * E;
    }
  }
  if (!solve(matrix, R)) return 0.0;
  long double largest = 0.0L;
  for (int i = 0; i < n; ++i) {
    long double sum = 0.0L;
    for (int j = 0; j < n; ++j) {
      Complex entry = 0.0L;
      for (int k = 0; k < n; ++k) entry += R(i, k) * R(k, j);
      sum += std::abs(entry) * static_cast<long double>(sizes[static_cast<std::size_t>(j)]);
    }
    largest = std::max(largest, sum / static_cast<long double>(sizes[static_cast<std::size_t>(i)]));
  }
  return static_cast<double>(largest);
}

// Lower bound of how much errors grow: sup over t >= 0 of the norm of exp(J t), J the finite part of the pencil, is
// at least |(sigma (lambda - J)^-1)^2| for all lambda = sigma + i eta with sigma > 0 (Hille, Yosida). The square
// makes the nilpotent part vanish, mu <= 1.
double amplification(const NodalEquations& equations, const std::vector<double>& sizes, double duration) {
  double largest = 0.0;
  for (double decade = 0.0; decade <= 9.0; decade += 0.5) {
    const auto sigma = static_cast<long double>(std::pow(10.0, decade) / duration);
    for (long double slope : {0.0L, 1.0L, 3.0L, 10.0L})
      largest = std::max(largest, resolvent_norm(equations, sizes, Complex(sigma, slope * sigma)));
  }
  return largest;
}

// |X_j|, at least a thousandth of the largest of its kind; empty if there are only zeros.
std::vector<double> sizes_of(const std::vector<Complex>& X, std::size_t nodes) {
  std::array<double, 2> largest{};  // potentials, currents
  for (std::size_t j = 0; j < X.size(); ++j) {
    double& of_kind = largest[j < nodes ? 0 : 1];
    of_kind = std::max(of_kind, static_cast<double>(std::abs(X[j])));
  }
  std::vector<double> sizes;
  for (std::size_t j = 0; j < X.size(); ++j) {
    const double of_kind = largest[j < nodes ? 0 : 1];
    if (of_kind == 0.0) return {};
    sizes.push_back(std::max(static_cast<double>(std::abs(X[j])), 1e-3 * of_kind));
  }
  return sizes;
}

}  // namespace

std::optional<ExactSolution> periodic_solution(const Circuit& circuit, RandomNumbers& random) {
  constexpr double rounding = 1e-16, harmless = 1e-9;
  const NodalEquations equations = nodal_equations(circuit);
  const std::vector<Complex> X = amplitudes(equations, circuit.omega, 0.0, random);
  ExactSolution solution;
  solution.sizes = sizes_of(X, static_cast<std::size_t>(circuit.nodes));
  if (solution.sizes.empty()) return std::nullopt;
  for (int trial = 0; trial < 3; ++trial) {
    const std::vector<Complex> other = amplitudes(equations, circuit.omega, rounding, random);
    if (other.empty()) return std::nullopt;
    for (std::size_t j = 0; j < X.size(); ++j)
      if (!(static_cast<double>(std::abs(other[j] - X[j])) <= harmless * solution.sizes[j])) return std::nullopt;
  }
  solution.amplification = [equations, sizes = solution.sizes, duration = circuit.duration] {
    return amplification(equations, sizes, duration);
  };
  // Of the slowest mode: what does not decay within the duration keeps its size under the resolvent.
  solution.persistence = [equations, sizes = solution.sizes, duration = circuit.duration] {
    return resolvent_norm(equations, sizes, Complex(1.0L / static_cast<long double>(duration), 0.0L));
  };
  solution.x = [X, omega = circuit.omega](double t) {
    const Complex turned = std::polar(1.0L, static_cast<long double>(omega) * static_cast<long double>(t));
    std::vector<double> x;
    for (const Complex& amplitude : X) x.push_back(static_cast<double>((amplitude * turned).imag()));
    return x;
  };
  return solution;
}

}  // namespace campaign
