// Splines through data, as functions in recorded equations.
//
// [dB01] C. de Boor: A Practical Guide to Splines, revised ed. Springer, 2001. Chapters IX, X, XIII.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "expression/point_function.h"

namespace sfdae::core {

struct TableData {
  int degree = 0;
  std::vector<double> x, y;
  bool operator==(const TableData&) const = default;
};

// A spline of odd degree p through n points, with p - 1 continuous derivatives. Its knots are the x of the data, but
// for the first and last (p - 1) / 2 inside the interval ("not a knot", [dB01, p. 44]): there are as many
// coefficients as data, and polynomials of that degree are reproduced.
class Spline : public PointFunction {
 public:
  // Error message about the data; "" if they are valid.
  static std::string complaint(const TableData& data);

  // Spline through valid data. Null if rounding errors keep it from passing through the data, as points are too uneven
  // for the degree.
  static std::shared_ptr<const Spline> through(const TableData& data);

  const TableData& data() const { return data_; }
  // Returns 1 outside of the data.
  int derivatives(int order, const double* arguments, double* values) const override;
  std::string objection(const double* arguments) const override;
  const std::vector<double>& breakpoints() const override { return breakpoints_; }
  int jumping_order() const override { return data_.degree; }
  void add_data(WordHash& hash) const override {
    hash.add(static_cast<std::uint64_t>(data_.degree));
    for (const std::vector<double>* values : {&data_.x, &data_.y}) hash.add(values->data(), values->size());
  }

 private:
  explicit Spline(const TableData& data);
  void make_pieces(const std::vector<double>& knots, const std::vector<double>& coefficients);
  bool is_within(double x) const;
  bool passes_through_data() const;
  // Number of the polynomial that holds from x[i] to x[i + 1].
  std::size_t piece_of(double x) const;

  TableData data_;
  std::vector<double> breakpoints_;
  std::vector<double> pieces_;  // coefficients of powers of x - x[i], degree + 1 for each i
};

}  // namespace sfdae::core
