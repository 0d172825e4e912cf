// The jets that an integration has gone through last.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/jet_course.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"

namespace sfdae::core {

void JetCourse::start(const Jet& jet) {
  for (Jet& node : accepted_) node = jet;
  count_ = 1;
  newest_ = 0;
  num_nodes_ = num_stages_ = 0;
}

void JetCourse::add(const Jet& jet) {
  if (jet.t != newest().t) {
    newest_ = (newest_ + 1) % most;
    count_ = std::min(count_ + 1, most);
  }
  accepted_[index(newest_)] = jet;
  num_nodes_ = num_stages_ = 0;
}

void JetCourse::set_attempt(const Jet& end, const NonlinearStages* stages) {
  num_nodes_ = 0;
  is_improved_ = false;
  num_stages_ = stages != nullptr ? stages->count() : 0;
  for (int i = num_stages_ - 1; i >= 0; --i) nodes_[index(num_nodes_++)] = &stages->jet(i);
  if (num_stages_ == 0) nodes_[index(num_nodes_++)] = &end;
  for (int k = 0; k < count_; ++k) nodes_[index(num_nodes_++)] = &accepted_[index((newest_ - k + most) % most)];
}

void JetCourse::set_points() {
  num_nodes_ = num_stages_ = 0;
  is_improved_ = false;
  for (int k = 0; k < count_; ++k) nodes_[index(num_nodes_++)] = &accepted_[index((newest_ - k + most) % most)];
}

const Jet& JetCourse::earlier(double reach) const {
  const Jet* found = &newest();
  for (int k = 1; k < count_ && k < window; ++k) {
    found = &accepted_[index((newest_ - k + most) % most)];
    if (std::fabs(newest().t - found->t) >= std::fabs(reach)) break;
  }
  return *found;
}

void JetCourse::interpolate(double t, Jet& jet) const {
  const double direction = nodes_[0]->t < oldest().t ? -1.0 : 1.0;
  int first = 0, count = std::min(num_nodes_, window);
  if (num_stages_ > 0 && (t - newest().t) * direction >= 0.0) {
    count = num_stages_ + 1;
  } else {
    int before = 0;  // the first node that is not after t
    while (before < num_nodes_ - 1 && (nodes_[index(before)]->t - t) * direction > 0.0) ++before;
    first = std::clamp(before - count / 2, 0, num_nodes_ - count);
  }
  jet.n = newest().n;
  jet.order = newest().order;
  jet.t = t;
  jet.x.assign(newest().x.size(), 0.0);
  for (int i = first; i < first + count; ++i) {
    double weight = 1.0;
    const double t_i = nodes_[index(i)]->t;
    for (int j = first; j < first + count; ++j)
      if (j != i) weight *= (t - nodes_[index(j)]->t) / (t_i - nodes_[index(j)]->t);
    const double* x = nodes_[index(i)]->x.data();
    for (std::size_t k = 0; k < jet.x.size(); ++k) jet.x[k] += weight * x[k];
  }
}

}  // namespace sfdae::core
