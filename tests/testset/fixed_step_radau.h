// SPDX-License-Identifier: BSD-3-Clause
// Radau IIA with two stages and constant steps for F(t, x, x') = 0 of index 0 or 1: slow, simple, independent of the
// library; order 3.
//
// [HW96] E. Hairer, G. Wanner: Solving Ordinary Differential Equations II, 2nd ed. Springer, 1996. Table IV.5.5.
#ifndef SFDAE_TESTS_FIXED_STEP_RADAU_H
#define SFDAE_TESTS_FIXED_STEP_RADAU_H

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

namespace sfdae_test {

// Solves A y = b by elimination with row pivots; A (n x n, by rows) and b are overwritten, b with y.
inline void eliminate(std::vector<double>& A, std::vector<double>& b) {
  const std::size_t n = b.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i)
      if (std::abs(A[i * n + k]) > std::abs(A[pivot * n + k])) pivot = i;
    if (pivot != k) {
      std::swap_ranges(A.begin() + static_cast<std::ptrdiff_t>(k * n),
                       A.begin() + static_cast<std::ptrdiff_t>(k * n + n),
                       A.begin() + static_cast<std::ptrdiff_t>(pivot * n));
      std::swap(b[k], b[pivot]);
    }
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = A[i * n + k] / A[k * n + k];
      if (factor == 0.0) continue;
      for (std::size_t j = k; j < n; ++j) A[i * n + j] -= factor * A[k * n + j];
      b[i] -= factor * b[k];
    }
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t j = i + 1; j < n; ++j) b[i] -= A[i * n + j] * b[j];
    b[i] /= A[i * n + i];
  }
}

// Residual: void(double t, const double* x, const double* xdot, double* F).
template <class Residual>
class FixedStepRadau {
 public:
  FixedStepRadau(Residual residual, std::vector<double> x) : residual_(residual), n_(x.size()), x_(std::move(x)) {}

  const std::vector<double>& x() const { return x_; }

  void integrate(double begin, double end, int steps) {
    h_ = (end - begin) / steps;
    for (int k = 0; k < steps; ++k) step(begin + k * h_);
  }

 private:
  static constexpr double c[2] = {1.0 / 3, 1.0};
  static constexpr double a[2][2] = {{5.0 / 12, -1.0 / 12}, {3.0 / 4, 1.0 / 4}};

  // The slopes K_i of the stages solve F(t + c_i h, x + h sum_j a_ij K_j, K_i) = 0.
  void step(double t) {
    std::vector<double> correction(2 * n_);
    slopes_.assign(2 * n_, 0.0);  // slopes of the last step would throw stiff components far away
    for (int iteration = 0; iteration < 30; ++iteration) {
      std::vector<double> matrix(4 * n_ * n_);
      for (std::size_t i = 0; i < 2; ++i) {
        const std::vector<double> stage = stage_values(i);
        residual_(t + c[i] * h_, stage.data(), &slopes_[i * n_], &correction[i * n_]);
        differentiate(i, t + c[i] * h_, matrix);
      }
      eliminate(matrix, correction);
      double size = 0.0;
      for (std::size_t i = 0; i < 2 * n_; ++i) {
        if (!std::isfinite(correction[i])) throw std::runtime_error("Newton's iteration left the domain of F");
        slopes_[i] -= correction[i];
        size = std::max(size, std::abs(h_ * correction[i]) / (1e-3 + std::abs(x_[i % n_])));
      }
      if (size < 1e-8) {
        x_ = stage_values(1);
        return;
      }
    }
    throw std::runtime_error("Newton's iteration did not converge");
  }
  std::vector<double> stage_values(std::size_t i) const {
    std::vector<double> x = x_;
    for (std::size_t k = 0; k < n_; ++k) x[k] += h_ * (a[i][0] * slopes_[k] + a[i][1] * slopes_[n_ + k]);
    return x;
  }
  // Rows of the iteration matrix that belong to stage i; F_x and F_x' by differences.
  void differentiate(std::size_t i, double t, std::vector<double>& matrix) const {
    std::vector<double> x = stage_values(i), F(n_), G(n_);
    const auto first = slopes_.begin() + static_cast<std::ptrdiff_t>(i * n_);
    std::vector<double> xdot(first, first + static_cast<std::ptrdiff_t>(n_));
    residual_(t, x.data(), xdot.data(), F.data());
    for (std::size_t j = 0; j < n_; ++j)
      for (const bool slope : {false, true}) {
        double& variable = slope ? xdot[j] : x[j];
        const double kept = variable, increment = (slope ? 1.0 : 1e-7) * (1e-2 + std::abs(kept));
        variable += increment;
        residual_(t, x.data(), xdot.data(), G.data());
        variable = kept;
        for (std::size_t k = 0; k < n_; ++k) {
          const double derivative = (G[k] - F[k]) / increment;
          double* row = &matrix[(i * n_ + k) * 2 * n_];
          if (slope) {
            row[i * n_ + j] += derivative;
          } else {
            row[j] += h_ * a[i][0] * derivative;
            row[n_ + j] += h_ * a[i][1] * derivative;
          }
        }
      }
  }

  Residual residual_;
  std::size_t n_;
  std::vector<double> x_, slopes_;
  double h_ = 0.0;
};

}  // namespace sfdae_test

#endif
