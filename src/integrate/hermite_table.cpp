// Divided differences over nodes of a Radau integration.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/hermite_table.h"

#include <algorithm>

#include "linalg/index.h"

namespace sfdae::core {

void HermiteTable::resize(std::size_t size, int max_nodes) {
  for (int i = 0; i < 2 * max_nodes; ++i) entries_[index(i)].resize(size);
}

void HermiteTable::set_nodes(const ChosenNodes& chosen, Interpolated which, int entries, double origin, double unit) {
  size_ = values_of(*chosen.nodes[0], which).size();
  degree_ = entries - 1;
  origin_ = origin;
  unit_ = unit;
  for (int i = 0; i < entries; ++i) {
    const RadauNode& node = *chosen.nodes[index(i / 2)];
    const bool is_slope = i % 2 == 1;
    times_[index(i)] = scaled(node.t);
    const double factor = is_slope ? unit : 1.0;
    const double* from = (is_slope ? slopes_of(node, which) : values_of(node, which)).data();
    for (std::size_t r = 0; r < size_; ++r) entries_[index(i)][r] = factor * from[r];
  }
  hermite_differences(times_, entries, size_, [this](int i) { return entries_[index(i)].data(); });
}

void HermiteTable::set_values(const ChosenNodes& chosen, double origin, double unit) {
  size_ = chosen.nodes[0]->x.size();
  degree_ = chosen.count - 1;
  origin_ = origin;
  unit_ = unit;
  for (int i = 0; i <= degree_; ++i) {
    const RadauNode& node = *chosen.nodes[index(i)];
    times_[index(i)] = scaled(node.t);
    std::copy_n(node.x.data(), size_, entries_[index(i)].data());
  }
  divided_differences(times_, degree_ + 1, size_, [this](int i) { return entries_[index(i)].data(); });
}

void HermiteTable::set_collocation(const RadauHistory& history) {
  set_collocation(radau_method(history.last_stages()).stages, {history.newest().t, history.last().h},
                  history.newest().x.size(), [&history](int i) { return history.polynomial().x_at(i); });
}

void HermiteTable::evaluate(double t, double* value, double* slope) const {
  polynomial().evaluate(scaled(t), value, slope);
  if (slope == nullptr) return;
  for (std::size_t r = 0; r < size_; ++r) slope[r] /= unit_;
}

void HermiteTable::taylor(double t, int order, double* coefficients) const {
  polynomial().taylor(scaled(t), order, coefficients);
  double power = 1.0;
  for (int k = 1; k <= order; ++k) {
    power *= unit_;
    for (std::size_t r = 0; r < size_; ++r) coefficients[size_ * index(k) + r] /= power;
  }
}

void HermiteTable::contribution_of_last(int nodes, double t, std::vector<double>& contribution) const {
  const double at = scaled(t);
  const int value = 2 * nodes - 2, slope = 2 * nodes - 1;
  double product = 1.0;
  for (int i = 0; i < value; ++i) product *= at - times_[index(i)];
  const double last_gap = at - times_[index(value)];
  for (std::size_t r = 0; r < contribution.size(); ++r)
    contribution[r] = product * (entries_[index(value)][r] + last_gap * entries_[index(slope)][r]);
}

}  // namespace sfdae::core
