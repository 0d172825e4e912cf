// Past points of an integration.
// SPDX-License-Identifier: BSD-3-Clause
#include "watch/trail.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sfdae::core {

namespace {

// Maximum number of nodes, and number of the newest ones that are not thinned out, because steps near a point need not
// grow or shrink regularly. (Chosen: polynomials of degree 6 at most are fitted to them.)
constexpr std::size_t most_kept_nodes = 64, untouched = 16;
// Half as many for large problems, for which all nodes would dominate the memory of a solver (docs/design/memory.md).
constexpr std::size_t large_size = 1000, most_large_nodes = 32;

}  // namespace

void Trail::start(double t, const double* x, std::size_t n) {
  nodes_.resize(n > large_size ? most_large_nodes : most_kept_nodes);
  memory_.resize(nodes_.size() * n);
  for (std::size_t i = 0; i < nodes_.size(); ++i) nodes_[i].x = {memory_.data() + i * n, n};
  count_ = 0;
  add(t, x);
}

void Trail::add(double t, const double* x) {
  if (nodes_.empty()) return;
  if (count_ == nodes_.size()) drop_one();
  Node& node = nodes_[count_++];
  node.t = t;
  std::copy_n(x, node.x.size(), node.x.begin());
}

// Drops the node whose neighbors are nearest to each other, relative to their distance from the end.
void Trail::drop_one() {
  const double end = nodes_[count_ - 1].t;
  std::size_t dropped = 1;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i + untouched < count_; ++i) {
    const double gap = std::fabs(nodes_[i + 1].t - nodes_[i - 1].t), distance = std::fabs(end - nodes_[i - 1].t);
    const double ratio = distance > 0.0 ? gap / distance : 0.0;
    if (ratio < least) least = ratio, dropped = i;
  }
  const auto first = nodes_.begin() + static_cast<std::ptrdiff_t>(dropped);
  std::rotate(first, first + 1, nodes_.begin() + static_cast<std::ptrdiff_t>(count_));
  --count_;
}

}  // namespace sfdae::core
