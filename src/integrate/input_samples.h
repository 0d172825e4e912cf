// Whether the points that a step looks at show what inputs do between them.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "expression/time_inputs.h"

namespace sfdae::core {

class InputSamples {
 public:
  static constexpr std::size_t most_nodes = 8;

  void resize(int inputs);
  // nodes: the points of a step of size h from t at which equations are evaluated, those before t among them. Inputs are sampled in
  // between: times at which some are far from the polynomial through their values at the nodes, or beyond all of these, the worst ones
  // first. fastest: in which time inputs are known to change, or 0. Valid until the next call.
  std::span<const double> unseen(TimeInputs& inputs, std::span<const double> nodes, double t, double h,
                                 double fastest);

 private:
  static constexpr std::size_t most_places = 4;
  struct Extreme {
    double value, distance, t;
  };
  void take_nodes(TimeInputs& inputs, std::span<const double> nodes);
  void take_sample(TimeInputs& inputs, std::span<const double> nodes, double t);
  double range_of(std::size_t i) const;
  bool are_smooth() const;
  void add_place(double score, double t);

  std::vector<double> at_nodes_;  // of input i, one for each node, from i most_nodes on
  std::vector<double> now_;
  // Of each input, at the nodes and in between, with the distance from the polynomial there; and where that is largest.
  std::vector<double> lowest_node_, highest_node_;
  std::vector<Extreme> lowest_, highest_, farthest_;
  std::array<double, most_places> places_{}, scores_{};
  std::size_t num_places_ = 0;
};

}  // namespace sfdae::core
