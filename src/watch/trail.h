// Past points of an integration, thinned out so that they reach far back and are dense at the end.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace sfdae::core {

class Trail {
 public:
  struct Node {
    double t = 0.0;
    std::span<double> x;  // part of memory_
  };
  Trail() = default;
  Trail(Trail&&) = default;
  Trail& operator=(Trail&&) = default;

  // Starts with this point; x: n values. Allocates the memory for all later points.
  void start(double t, const double* x, std::size_t n);
  // Adds a point after the newest one.
  void add(double t, const double* x);
  void forget() { count_ = 0; }

  std::size_t count() const { return count_; }
  // Node i, from the oldest, 0, to the newest.
  const Node& node(std::size_t i) const { return nodes_[i]; }
  const Node& newest() const { return nodes_[count_ - 1]; }

 private:
  void drop_one();

  std::vector<Node> nodes_;
  std::vector<double> memory_;  // of all nodes in one block: with 64 blocks their allocation would
                                // take a tenth of the start of a small problem
  std::size_t count_ = 0;
};

}  // namespace sfdae::core
