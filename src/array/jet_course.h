// History of the jets of an integration, with interpolation between them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "array/nonlinear_stages.h"
#include "system/jet.h"
#include "system/stage_method.h"

namespace sfdae::core {

class JetCourse {
 public:
  // Starts the history at this point.
  void start(const Jet& jet);
  // Adds the next accepted point.
  void add(const Jet& jet);
  // Sets the end of a step that is tried, and its stages if it has several (the last one is the end), or null.
  // References to them are kept until the next call.
  void set_attempt(const Jet& end, const NonlinearStages* stages);
  // Interpolates through landmarks only: accepted points of the whole history, sparser the farther back.
  void set_landmarks();
  // The nearest landmark that is at least this far from the newest one, or the oldest.
  const Jet& landmark(double distance) const;
  const Jet& newest() const { return accepted_[index(newest_)]; }
  const Jet& oldest() const { return accepted_[index((newest_ - count_ + 1 + most) % most)]; }
  // Replaces the nodes of the polynomials, until the next attempt, by copies changed by improve(Jet&).
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
  // Nodes of the polynomials outside steps with stages: as accurate as BDF of low orders.
  static constexpr int window = 5;

  std::array<Jet, most> accepted_;  // a ring buffer
  int count_ = 0, newest_ = 0;
  // Points of the whole history, the newest first; distances from the newest grow about as powers of sqrt(2).
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
