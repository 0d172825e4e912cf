// SPDX-License-Identifier: BSD-3-Clause
#include "spline.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace campaign {

namespace {

using Rows = std::vector<std::vector<double>>;

// Gaussian elimination with row pivoting; the last column is the right-hand side.
std::vector<double> solve(Rows rows) {
  const std::size_t n = rows.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i)
      if (std::abs(rows[i][k]) > std::abs(rows[pivot][k])) pivot = i;
    std::swap(rows[k], rows[pivot]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = rows[i][k] / rows[k][k];
      if (factor == 0.0) continue;
      for (std::size_t j = k; j <= n; ++j) rows[i][j] -= factor * rows[k][j];
    }
  }
  std::vector<double> solution(n);
  for (std::size_t k = n; k-- > 0;) {
    double sum = rows[k][n];
    for (std::size_t j = k + 1; j < n; ++j) sum -= rows[k][j] * solution[j];
    solution[k] = sum / rows[k][k];
  }
  return solution;
}

// Second derivatives at the points: continuous first derivatives inside, continuous third ones at the second and the
// last but one point.
std::vector<double> second_derivatives(const std::vector<double>& x, const std::vector<double>& y) {
  const std::size_t n = x.size();
  Rows rows(n, std::vector<double>(n + 1, 0.0));
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = x[i] - x[i - 1], after = x[i + 1] - x[i];
    rows[i][i - 1] = before / 6.0;
    rows[i][i] = (before + after) / 3.0;
    rows[i][i + 1] = after / 6.0;
    rows[i][n] = (y[i + 1] - y[i]) / after - (y[i] - y[i - 1]) / before;
  }
  const auto join = [&](std::size_t row, std::size_t middle) {
    const double before = x[middle] - x[middle - 1], after = x[middle + 1] - x[middle];
    rows[row][middle - 1] = after;
    rows[row][middle] = -(before + after);
    rows[row][middle + 1] = before;
  };
  join(0, 1);
  join(n - 1, n - 2);
  return solve(rows);
}

}  // namespace

Spline make_spline(int degree, std::vector<double> x, std::vector<double> y) {
  Spline spline{degree, std::move(x), std::move(y), {}};
  const std::size_t n = spline.x.size();
  const std::vector<double> curvature =
      degree == 3 ? second_derivatives(spline.x, spline.y) : std::vector<double>(n, 0.0);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const double h = spline.x[i + 1] - spline.x[i];
    const double slope = (spline.y[i + 1] - spline.y[i]) / h - h / 6.0 * (2.0 * curvature[i] + curvature[i + 1]);
    spline.pieces.push_back({spline.y[i], slope, curvature[i] / 2.0, (curvature[i + 1] - curvature[i]) / (6.0 * h)});
  }
  return spline;
}

const std::array<double, 4>& Spline::piece(double u, double& origin) const {
  const auto after = std::upper_bound(x.begin() + 1, x.end() - 1, u);
  const auto i = static_cast<std::size_t>(after - x.begin()) - 1;
  origin = x[i];
  return pieces[i];
}

double Spline::derivative(double u, int order) const {
  double origin = 0.0;
  const std::array<double, 4>& c = piece(u, origin);
  double sum = 0.0;
  for (int k = 3; k >= order; --k) {
    double factor = 1.0;
    for (int j = 0; j < order; ++j) factor *= k - j;
    sum = sum * (u - origin) + factor * c[static_cast<std::size_t>(k)];
  }
  return sum;
}

}  // namespace campaign
