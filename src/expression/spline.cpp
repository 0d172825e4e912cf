// Splines through data: the banded system for their coefficients, and the polynomials between the points.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/spline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "linalg/format.h"
#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

namespace {

constexpr int max_degree = 7;

// Each end is repeated so often that the spline ends there.
std::vector<double> knots_of(const TableData& data) {
  const int n = static_cast<int>(data.x.size()), p = data.degree, half = (p + 1) / 2;
  std::vector<double> knots(index(p + 1), data.x.front());
  for (int i = half; i < n - half; ++i) knots.push_back(data.x[index(i)]);
  knots.insert(knots.end(), index(p + 1), data.x.back());
  return knots;
}

// knots[l] <= x < knots[l + 1], the last such interval at the end.
int span_of(const std::vector<double>& knots, int degree, double x) {
  const auto last = knots.end() - degree - 1;
  const auto after = std::upper_bound(knots.begin() + degree + 1, last, x);
  return static_cast<int>(after - knots.begin()) - 1;
}

// The B-splines that do not vanish in span l, at x: N_{l-p}, ..., N_l [dB01, p. 111].
std::array<double, max_degree + 1> basis(const std::vector<double>& knots, int degree, int l, double x) {
  std::array<double, max_degree + 1> N{1.0};
  for (int j = 1; j <= degree; ++j) {
    double saved = 0.0;
    for (int r = 0; r < j; ++r) {
      const double right = knots[index(l + r + 1)], left = knots[index(l + 1 - j + r)];
      const double share = N[index(r)] / (right - left);
      N[index(r)] = saved + (right - x) * share;
      saved = (x - left) * share;
    }
    N[index(j)] = saved;
  }
  return N;
}

// Coefficients of the spline that passes through the data. The matrix of values of B-splines is totally positive, so
// that elimination needs no pivots [dB01, p. 169].
std::vector<double> coefficients_of(const TableData& data, const std::vector<double>& knots) {
  const int n = static_cast<int>(data.x.size()), p = data.degree, width = 2 * p + 1;
  std::vector<double> band(index(n) * index(width), 0.0), c = data.y;  // entry (i, j) at row i, column j - i + p
  const auto entry = [&](int i, int j) -> double& { return band[index(i) * index(width) + index(j - i + p)]; };
  for (int i = 0; i < n; ++i) {
    const double x = data.x[index(i)];
    const int l = span_of(knots, p, x);
    const auto N = basis(knots, p, l, x);
    for (int r = 0; r <= p; ++r)
      if (std::abs(l - p + r - i) <= p) entry(i, l - p + r) = N[index(r)];
  }
  for (int k = 0; k < n; ++k)
    for (int i = k + 1; i < std::min(n, k + p + 1); ++i) {
      if (entry(i, k) == 0.0) continue;
      const double factor = entry(i, k) / entry(k, k);
      for (int j = k + 1; j < std::min(n, k + p + 1); ++j) entry(i, j) -= factor * entry(k, j);
      c[index(i)] -= factor * c[index(k)];
    }
  for (int k = n - 1; k >= 0; --k) {
    for (int j = k + 1; j < std::min(n, k + p + 1); ++j) c[index(k)] -= entry(k, j) * c[index(j)];
    c[index(k)] /= entry(k, k);
  }
  return c;
}

}  // namespace

std::string Spline::complaint(const TableData& data) {
  const int n = static_cast<int>(data.x.size()), p = data.degree;
  if (p != 1 && p != 3 && p != 5 && p != 7) return format("degree %d: it has to be 1, 3, 5 or 7", p);
  if (n < p + 1) return format("%d points are too few: degree %d needs at least %d", n, p, p + 1);
  for (int i = 0; i < n; ++i) {
    if (!std::isfinite(data.x[index(i)]) || !std::isfinite(data.y[index(i)]))
      return format("point %d is (%g, %g), which is not finite", i, data.x[index(i)], data.y[index(i)]);
    if (i > 0 && !(data.x[index(i)] > data.x[index(i - 1)]))
      return format("x[%d] = %.15g does not lie after x[%d] = %.15g: the points have to be sorted, no two equal", i,
                    data.x[index(i)], i - 1, data.x[index(i - 1)]);
  }
  return {};
}

std::shared_ptr<const Spline> Spline::through(const TableData& data) {
  const QuietArithmetic quiet;
  std::shared_ptr<const Spline> spline(new Spline(data));
  return spline->passes_through_data() ? spline : nullptr;
}

Spline::Spline(const TableData& data) : PointFunction("table", 1), data_(data) {
  const std::vector<double> knots = knots_of(data);
  breakpoints_.assign(knots.begin() + data.degree, knots.end() - data.degree);
  make_pieces(knots, coefficients_of(data, knots));
}

// The derivatives of a piece at its start are those of B-splines of lower degree, whose coefficients are differences
// [dB01, p. 116].
void Spline::make_pieces(const std::vector<double>& knots, const std::vector<double>& coefficients) {
  const int p = data_.degree;
  for (std::size_t i = 0; i + 1 < data_.x.size(); ++i) {
    const double x = data_.x[i];
    const int l = span_of(knots, p, x);
    std::array<double, max_degree + 1> d{};
    std::copy_n(coefficients.begin() + (l - p), p + 1, d.begin());
    double factorial = 1.0;
    for (int m = 0; m <= p; ++m) {
      const int degree = p - m;
      const auto N = basis(knots, degree, l, x);
      double derivative = 0.0;
      for (int r = 0; r <= degree; ++r) derivative += N[index(r)] * d[index(r)];
      pieces_.push_back(derivative / factorial);
      factorial *= m + 1;
      for (int r = 0; r < degree; ++r)
        d[index(r)] =
            degree * (d[index(r + 1)] - d[index(r)]) / (knots[index(l + 1 + r)] - knots[index(l + 1 - degree + r)]);
    }
  }
}

// Returns whether the spline passes through the data but for rounding errors, of which uneven points cost a few digits.
// The values at the ends of pieces are compared.
bool Spline::passes_through_data() const {
  constexpr double allowed = 1e-9;
  double size = 0.0;
  for (double y : data_.y) size = std::max(size, std::fabs(y));
  for (double piece : pieces_)
    if (!std::isfinite(piece)) return false;
  const int p = data_.degree;
  for (std::size_t i = 0; i + 1 < data_.x.size(); ++i) {
    const double* const piece = pieces_.data() + i * index(p + 1);
    const double width = data_.x[i + 1] - data_.x[i];
    double end = piece[p];
    for (int m = p - 1; m >= 0; --m) end = end * width + piece[m];
    const double error = std::max(std::fabs(piece[0] - data_.y[i]), std::fabs(end - data_.y[i + 1]));
    if (!(error <= allowed * size)) return false;
  }
  return true;
}

std::size_t Spline::piece_of(double x) const {
  const auto after = std::upper_bound(data_.x.begin() + 1, data_.x.end() - 1, x);
  return static_cast<std::size_t>(after - data_.x.begin()) - 1;
}

// Arguments that equal an end but for rounding errors count as within.
bool Spline::is_within(double x) const {
  const double first = data_.x.front(), last = data_.x.back();
  // More than half the gap of a kink (time_breakpoints.cpp): steps across the end of data that an argument is limited
  // to.
  const double slack = 256.0 * std::numeric_limits<double>::epsilon() * std::max(std::fabs(first), std::fabs(last));
  return x >= first - slack && x <= last + slack;
}

int Spline::derivatives(int order, const double* arguments, double* values) const {
  if (!is_within(*arguments)) return 1;
  const int p = data_.degree;
  const std::size_t i = piece_of(*arguments);
  const double* const piece = pieces_.data() + i * index(p + 1);
  const double s = *arguments - data_.x[i];
  double sum = 0.0;
  for (int m = p; m >= order; --m) {
    double factor = 1.0;
    for (int k = 0; k < order; ++k) factor *= m - k;
    sum = sum * s + factor * piece[m];
  }
  values[0] = sum;
  return 0;
}

std::string Spline::objection(const double* arguments) const {
  if (is_within(*arguments)) return {};
  return format("table at %.9g, outside of its data from %.9g to %.9g", *arguments, data_.x.front(), data_.x.back());
}

}  // namespace sfdae::core
