// History of the jets of an integration.
// SPDX-License-Identifier: BSD-3-Clause
#include "array/jet_course.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"

namespace sfdae::core {

void JetCourse::start(const Jet& jet) {
  for (Jet& node : accepted_) node = jet;
  for (Jet& node : landmarks_) node = jet;
  for (Jet& node : improved_) node = jet;
  num_landmarks_ = 0;
  add_landmark(jet);
  count_ = 1;
  newest_ = 0;
  num_nodes_ = num_stages_ = 0;
}

void JetCourse::add(const Jet& jet) {
  if (jet.t != newest().t) {
    newest_ = (newest_ + 1) % most;
    count_ = std::min(count_ + 1, most);
    add_landmark(jet);
  }
  accepted_[index(newest_)] = jet;
  num_nodes_ = num_stages_ = 0;
}

void JetCourse::set_attempt(const Jet& end, const NonlinearStages* stages) {
  num_nodes_ = 0;
  is_improved_ = false;
  // Stages of a step of a few units of roundoff in t may have equal t.
  const auto add_node = [this](const Jet& jet) {
    const bool is_there = jet.t == newest().t || (num_nodes_ > 0 && jet.t == nodes_[index(num_nodes_ - 1)]->t);
    if (!is_there) nodes_[index(num_nodes_++)] = &jet;
  };
  for (int i = stages != nullptr ? stages->count() - 1 : -1; i >= 0; --i) add_node(stages->jet(i));
  num_stages_ = num_nodes_;
  if (stages == nullptr || stages->count() == 0) add_node(end);
  for (int k = 0; k < count_; ++k) nodes_[index(num_nodes_++)] = &accepted_[index((newest_ - k + most) % most)];
}

// Replaces a landmark that is not needed, or else the oldest one.
void JetCourse::add_landmark(const Jet& jet) {
  const auto distance = [&](int i) { return std::fabs(jet.t - landmarks_[index(landmark_order_[index(i)])].t); };
  int removed = num_landmarks_ < most_landmarks ? num_landmarks_ : most_landmarks - 1;
  for (int i = 1; i + 1 < num_landmarks_; ++i)
    if (distance(i + 1) <= 2.0 * distance(i - 1)) {
      removed = i;
      break;
    }
  if (removed == num_landmarks_) landmark_order_[index(num_landmarks_++)] = removed;
  std::rotate(landmark_order_.begin(), landmark_order_.begin() + removed, landmark_order_.begin() + removed + 1);
  landmarks_[index(landmark_order_[0])] = jet;
}

void JetCourse::set_landmarks() {
  num_nodes_ = num_stages_ = 0;
  is_improved_ = false;
  for (int i = 0; i < num_landmarks_; ++i)
    nodes_[index(num_nodes_++)] = &landmarks_[index(landmark_order_[index(i)])];
}

const Jet& JetCourse::landmark(double distance) const {
  int i = 1;
  while (i + 1 < num_nodes_ && std::fabs(nodes_[index(i)]->t - nodes_[0]->t) < distance) ++i;
  return *nodes_[index(std::min(i, num_nodes_ - 1))];
}

void JetCourse::interpolate(double t, Jet& jet) const {
  const double direction = nodes_[0]->t < nodes_[index(num_nodes_ - 1)]->t ? -1.0 : 1.0;
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
