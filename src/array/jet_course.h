// The jets that an integration has gone through last, and those in between by interpolation.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "array/nonlinear_stages.h"
#include "system/jet.h"
#include "system/stage_method.h"

namespace sfdae::core {

class JetCourse {
 public:
  // From this point on.
  void start(const Jet& jet);
  // The next accepted point.
  void add(const Jet& jet);
  // The end of a step that is tried, and its stages if it has several (the last one is the end), or null: they are
  // referred to until the next call.
  void set_attempt(const Jet& end, const NonlinearStages* stages);
  // Polynomials go through accepted points alone, from the whole way so far: the farther back, the fewer.
  void set_landmarks();
  // Of those, the nearest one that lies so far before the newest, or the oldest.
  const Jet& landmark(double distance) const;
  const Jet& newest() const { return accepted_[index(newest_)]; }
  const Jet& oldest() const { return accepted_[index((newest_ - count_ + 1 + most) % most)]; }
  // What polynomials go through from now on, until the next attempt: every point after it has been passed to
  // improve(Jet&).
  template <class Improve>
  void improve_nodes(Improve improve) {
    if (is_improved_) return;
    for (int i = 0; i < num_nodes_; ++i) {
      Jet& node = improved_[index(i)];
      node = *nodes_[index(i)];
      improve(node);
      nodes_[index(i)] = &node;
    }
    is_improved_ = true;
  }
  // The jet at t, by polynomials through the jets nearby.
  void interpolate(double t, Jet& jet) const;

 private:
  void add_landmark(const Jet& jet);
  // More points than pass between two linearizations.
  static constexpr int most = 16;
  // Points of the polynomials outside of steps with stages: as accurate as BDF of low orders.
  static constexpr int window = 5;

  std::array<Jet, most> accepted_;  // a ring
  int count_ = 0, newest_ = 0;
  // Points from the whole way, the newest first; distances from the newest grow about as powers of sqrt(2).
  static constexpr int most_landmarks = 32;
  std::array<Jet, most_landmarks> landmarks_;
  std::array<int, most_landmarks> landmark_order_{};
  int num_landmarks_ = 0;
  std::array<const Jet*, most_landmarks> nodes_{};  // the newest first
  std::array<Jet, most_landmarks> improved_;
  static_assert(most + max_stages <= most_landmarks);
  int num_nodes_ = 0, num_stages_ = 0;
  bool is_improved_ = false;
};

}  // namespace sfdae::core
