// The last points of a BDF integration and the polynomials through them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "integrate/newton_polynomial.h"
#include "integrate/step_control.h"
#include "integrate/stepper.h"

namespace sfdae::core {

class BdfHistory {
 public:
  // Points of a polynomial of degree k + 1 and one more point for its error.
  static constexpr int capacity = max_bdf_order + 3;
  using Table = std::array<std::vector<double>, capacity>;
  using Polynomial = NewtonPolynomial<Table, std::array<double, capacity>>;

  void start(const StartingPoint& point);
  // The newest point first.
  int points() const { return points_; }
  double time(int i) const { return times_[index(i)]; }
  const std::vector<double>& x() const { return x_at(0); }
  const std::vector<double>& x_at(int i) const { return is_same_[index(i)] ? w_[index(i)] : x_[index(i)]; }
  std::size_t size_x() const { return n_; }
  std::size_t size_w() const { return w_[0].size(); }

  // Before the first step there is only one point. A second one on its tangent, at t - h, makes this slope the
  // predictor of a step of size h.
  void place_fictitious_point(double h);
  bool is_at_start() const { return points_ == 2 && is_fictitious_; }
  void append(double t, const std::vector<double>& w, const std::vector<double>& x);

  // The polynomial through the newest `count` points at another t, without differences: its value, and its slope minus
  // c times the value; returns c = sum of 1 / (t - t_i). Rounding errors are relative to w even if w is constant.
  double formula_by_points(double t, int count, double* predicted, double* rest) const;
  // Divided differences of w, and of x if with_x, over the newest points; the polynomials use them.
  void compute_differences(int count, bool with_x);
  // w[t_0, ..., t_i].
  const std::vector<double>& difference(int i) const { return dw_[index(i)]; }
  const std::vector<double>& difference_x(int i) const { return table_x()[index(i)]; }
  Polynomial polynomial_w(int degree) const { return {dw_, times_, degree, size_w()}; }
  Polynomial polynomial_x(int degree) const { return {table_x(), times_, degree, size_x()}; }

  // Archives the number of points, at most max_points, with the order of the last step; returns that number. Allocates
  // memory for them when reading.
  struct Sizes {
    std::size_t x, w;
  };
  int archive_size(Archive& archive, const Sizes& sizes, int max_points, int& last_order);
  void archive_points(Archive& archive, int points);

 private:
  void resize(std::size_t n, std::size_t size_w);
  void reserve_x();
  void set_x(int i, const double* x);
  const Table& table_x() const { return shares_ ? dw_ : dx_; }

  std::array<double, capacity> times_{};
  std::size_t n_ = 0;
  Table w_, x_;
  int points_ = 0;
  bool is_fictitious_ = false;             // the second point at the start
  std::vector<double> slope_w_, slope_x_;  // until there is a second point; slope_x_ is empty if both are equal
  Table dw_, dx_;
  // True if x = w bitwise at these points, as for W = I: then x shares w and its differences, and x_ and dx_ stay
  // unallocated until another point comes.
  std::array<bool, capacity> is_same_{};
  bool shares_ = false;
};

}  // namespace sfdae::core
