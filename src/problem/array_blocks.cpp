// The blocks of the derivative array of a user.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/array_blocks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "linalg/format.h"

namespace sfdae::core {

namespace {

constexpr double roundoff = std::numeric_limits<double>::epsilon();

// A contradiction is an error if it exceeds the first factor times the terms of the entry, as no rounding error of a
// formula does, and the second one times the largest entry of its row: terms that cancel leave rounding errors of
// larger terms.
constexpr double relative_to_terms = 1e-6, relative_to_row = 1e3 * roundoff;
// Rounding errors of the three operations that the difference J_k1 - k J_(k-1)0 undoes.
constexpr double rounding_of_difference = 4.0 * roundoff;

// C(k, j), 0 unless 0 <= j <= k.
double binomial(int k, int j) {
  double product = j < 0 || j > k ? 0.0 : 1.0;
  for (int r = 0; r < j && product > 0.0; ++r) product = product * (k - r) / (r + 1);
  return product;
}

class Splitting {
 public:
  Splitting(const ArrayShape& shape, const double* jacobian, double* F_x, double* F_xdot)
      : shape_(shape), J_(jacobian), F_x_(F_x), F_xdot_(F_xdot), largest_(shape.rows(), 0.0) {}

  ArrayFault run() {
    ArrayFault fault = measure_rows();
    if (fault.exists()) return fault;
    for (int k = 0; k <= shape_.order; ++k) read_order(k);
    // The blocks of the first two columns have been read, and follow from themselves.
    for (int k = 0; k <= shape_.order; ++k)
      for (int j = 2; j <= shape_.order + 1 && !fault.exists(); ++j) fault = check_block(k, j);
    return fault;
  }

 private:
  std::size_t place(int k, int j, int row, int column) const {
    return index(shape_.m * k + row) + shape_.rows() * index(shape_.n * j + column);
  }
  std::size_t place(int k, int row, int column) const {
    return index(row) + index(shape_.m) * (index(shape_.n) * index(k) + index(column));
  }

  // Also finds entries that are not finite.
  ArrayFault measure_rows() {
    for (std::size_t column = 0; column < shape_.columns(); ++column)
      for (std::size_t row = 0; row < shape_.rows(); ++row) {
        const double value = J_[row + shape_.rows() * column];
        if (!std::isfinite(value)) return {static_cast<int>(row), static_cast<int>(column), value, 0.0};
        largest_[row] = std::max(largest_[row], std::fabs(value));
      }
    return {};
  }

  void read_order(int k) {
    for (int column = 0; column < shape_.n; ++column)
      for (int row = 0; row < shape_.m; ++row) {
        const std::size_t to = place(k, row, column);
        F_x_[to] = J_[place(k, 0, row, column)];
        const double lower = k == 0 ? 0.0 : k * J_[place(k - 1, 0, row, column)];
        const double difference = J_[place(k, 1, row, column)] - lower;
        const bool is_rounding = std::fabs(difference) <= rounding_of_difference * std::fabs(lower);
        F_xdot_[to] = is_rounding ? 0.0 : difference;
      }
  }

  ArrayFault check_block(int k, int j) const {
    const double of_F_x = binomial(k, j), of_F_xdot = binomial(k, j - 1);
    for (int column = 0; column < shape_.n; ++column)
      for (int row = 0; row < shape_.m; ++row) {
        const double value = J_[place(k, j, row, column)];
        const double a = of_F_x > 0.0 ? of_F_x * F_x_[place(k - j, row, column)] : 0.0;
        const double b = of_F_xdot > 0.0 ? of_F_xdot * F_xdot_[place(k - j + 1, row, column)] : 0.0;
        const double terms = std::fabs(a) + std::fabs(b) + std::fabs(value);
        const double allowed =
            std::max(relative_to_terms * terms, relative_to_row * largest_[index(shape_.m * k + row)]);
        if (std::fabs(value - (a + b)) > allowed) return {shape_.m * k + row, shape_.n * j + column, value, a + b};
      }
    return {};
  }

  ArrayShape shape_;
  const double* J_;
  double *F_x_, *F_xdot_;
  std::vector<double> largest_;  // absolute value in each row of the Jacobian
};

}  // namespace

bool ArrayFault::is_finite() const { return std::isfinite(value); }

std::string ArrayFault::message(const ArrayShape& shape, const EquationNames& names, const std::string& where) const {
  const std::string place = format(
      "row %d, column %d of the Jacobian of the derivative array of order %d%s, that is, the derivative of order %d "
      "of "
      "%s with respect to the derivative of order %d of unknown %d,",
      row, column, shape.order, where.empty() ? "" : (" at " + where).c_str(), row / shape.m,
      names.in_words(row % shape.m).c_str(), column / shape.n, column % shape.n);
  if (!is_finite()) return place + " is NaN, Inf or a number near overflow.";
  return place + format(
                     " is %.6g, but the blocks for F_x and F_x' require %.6g: block (k, j) has to be C(k, j) "
                     "F_x^(k-j) + C(k, j-1) F_x'^(k-j+1). Correct the Jacobian.",
                     value, expected);
}

ArrayFault split_array(const ArrayShape& shape, const double* jacobian, double* F_x, double* F_xdot) {
  return Splitting(shape, jacobian, F_x, F_xdot).run();
}

}  // namespace sfdae::core
