// Table of divided differences over nodes of a Radau integration, and the polynomial that it defines.
//
// Its times are (t - origin) / unit, so that nothing overflows.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "integrate/newton_polynomial.h"
#include "integrate/radau_history.h"
#include "integrate/radau_method.h"

namespace sfdae::core {

class HermiteTable {
 public:
  // For polynomials through max_nodes nodes with slopes, for vectors with at most `size` components.
  void resize(std::size_t size, int max_nodes);

  // Polynomial through the first `entries` values and slopes, alternating, of the nodes.
  void set_nodes(const ChosenNodes& chosen, Interpolated which, int entries, double origin, double unit);
  // Polynomial through the values of x at the nodes only.
  void set_values(const ChosenNodes& chosen, double origin, double unit);
  // The collocation polynomial for x of the last step, through its start and its stages, all of them within the step.
  void set_collocation(const RadauHistory& history);
  // The collocation polynomial of any step; x_at(i): `size` numbers, at the start, i = 0, and at the stages.
  struct StepTimes {
    double end, h;
  };
  template <class Column>
  void set_collocation(const StageMethod& method, const StepTimes& step, std::size_t size, Column x_at);

  int degree() const { return degree_; }
  // The divided difference of the highest order, in units.
  const std::vector<double>& last_entry() const { return entries_[index(degree_)]; }

  // The polynomial at t and, unless slope is null, its derivative.
  void evaluate(double t, double* value, double* slope) const;
  // Its Taylor coefficients at t: size x (order + 1).
  void taylor(double t, int order, double* coefficients) const;
  // Contribution of the last of `nodes` nodes to the value at t, by its value and its slope.
  void contribution_of_last(int nodes, double t, std::vector<double>& contribution) const;

 private:
  static constexpr int capacity = 2 * max_radau_nodes;
  using Entries = std::array<std::vector<double>, capacity>;
  NewtonPolynomial<Entries, std::array<double, capacity>> polynomial() const {
    return {entries_, times_, degree_, size_};
  }
  double scaled(double t) const { return (t - origin_) / unit_; }

  Entries entries_;
  std::array<double, capacity> times_{};
  int degree_ = 0;
  std::size_t size_ = 0;
  double origin_ = 0.0, unit_ = 1.0;
};

template <class Column>
void HermiteTable::set_collocation(const StageMethod& method, const StepTimes& step, std::size_t size, Column x_at) {
  size_ = size;
  degree_ = method.s;
  origin_ = step.end;
  unit_ = step.h;
  for (int i = 0; i <= degree_; ++i) {
    times_[index(i)] = i == 0 ? -1.0 : method.c[index(i - 1)] - 1.0;
    std::copy_n(x_at(i), size_, entries_[index(i)].data());
  }
  divided_differences(times_, degree_ + 1, size_, [this](int i) { return entries_[index(i)].data(); });
}

}  // namespace sfdae::core
