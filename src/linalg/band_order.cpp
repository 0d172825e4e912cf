// Reverse Cuthill-McKee [CM69] from pseudoperipheral nodes [GL79].
// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/band_order.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Neighbors of node v: first[v], ..., first[v + 1] - 1.
struct Graph {
  std::vector<int> first, neighbour;
  int size() const { return static_cast<int>(first.size()) - 1; }
  int degree(int v) const { return first[index(v) + 1] - first[index(v)]; }
};

// Each edge is given once, and joined to both of its ends; double edges do no harm.
Graph graph_of(int size, const std::vector<std::pair<int, int>>& edges) {
  Graph graph;
  graph.first.assign(index(size) + 1, 0);
  for (const auto& [v, w] : edges) {
    ++graph.first[index(v) + 1];
    ++graph.first[index(w) + 1];
  }
  std::partial_sum(graph.first.begin(), graph.first.end(), graph.first.begin());
  graph.neighbour.resize(2 * edges.size());
  std::vector<int> next(graph.first.begin(), graph.first.end() - 1);
  for (const auto& [v, w] : edges) {
    graph.neighbour[index(next[index(v)]++)] = w;
    graph.neighbour[index(next[index(w)]++)] = v;
  }
  return graph;
}

class CuthillMcKee {
 public:
  explicit CuthillMcKee(const Graph& graph)
      : graph_(graph), is_placed_(index(graph.size()), false), seen_(index(graph.size()), 0) {}

  // The nodes in reverse order.
  std::vector<int> run() {
    std::vector<int> by_degree(index(graph_.size()));
    std::iota(by_degree.begin(), by_degree.end(), 0);
    std::stable_sort(by_degree.begin(), by_degree.end(),
                     [&](int v, int w) { return graph_.degree(v) < graph_.degree(w); });
    for (const int v : by_degree)
      if (!is_placed_[index(v)]) place_component(peripheral_node(v));
    std::reverse(order_.begin(), order_.end());
    return std::move(order_);
  }

 private:
  int peripheral_node(int start);
  int find_levels(int start);
  void place_component(int start);

  const Graph& graph_;
  std::vector<bool> is_placed_;
  std::vector<int> seen_;  // number of the search that met it last
  int search_ = 0;
  std::vector<int> queue_;
  std::size_t last_level_ = 0;  // begins there in the queue
  std::vector<int> order_;
};

// Breadth first; returns the number of levels.
int CuthillMcKee::find_levels(int start) {
  ++search_;
  queue_.assign(1, start);
  seen_[index(start)] = search_;
  int levels = 0;
  for (std::size_t begin = 0; begin < queue_.size();) {
    last_level_ = begin;
    ++levels;
    const std::size_t end = queue_.size();
    for (; begin < end; ++begin)
      for (int k = graph_.first[index(queue_[begin])]; k < graph_.first[index(queue_[begin]) + 1]; ++k) {
        const int w = graph_.neighbour[index(k)];
        if (seen_[index(w)] == search_) continue;
        seen_[index(w)] = search_;
        queue_.push_back(w);
      }
  }
  return levels;
}

int CuthillMcKee::peripheral_node(int start) {
  int levels = find_levels(start);
  while (true) {
    const auto last = queue_.begin() + static_cast<std::ptrdiff_t>(last_level_);
    const int next =
        *std::min_element(last, queue_.end(), [&](int v, int w) { return graph_.degree(v) < graph_.degree(w); });
    const int more = find_levels(next);
    if (more <= levels) return start;
    start = next;
    levels = more;
  }
}

void CuthillMcKee::place_component(int start) {
  std::size_t begin = order_.size();
  order_.push_back(start);
  is_placed_[index(start)] = true;
  for (; begin < order_.size(); ++begin) {
    const std::ptrdiff_t end = static_cast<std::ptrdiff_t>(order_.size());
    const int v = order_[begin];
    for (int k = graph_.first[index(v)]; k < graph_.first[index(v) + 1]; ++k) {
      const int w = graph_.neighbour[index(k)];
      if (is_placed_[index(w)]) continue;
      is_placed_[index(w)] = true;
      order_.push_back(w);
    }
    std::stable_sort(order_.begin() + end, order_.end(),
                     [&](int a, int b) { return graph_.degree(a) < graph_.degree(b); });
  }
}

void find_widths(const SparsePattern& pattern, BandOrder& order) {
  order.lower = order.upper = 0;
  for (std::size_t j = 0; j < index(pattern.size); ++j)
    for (int k = pattern.first[j]; k < pattern.first[j + 1]; ++k) {
      const int below = order.row_place[index(pattern.row[index(k)])] - order.column_place[j];
      order.lower = std::max(order.lower, below);
      order.upper = std::max(order.upper, -below);
    }
  if (order.lower <= order.upper) return;
  // Counted from the end, entries below the diagonal are above it: a wide lower band is the expensive one.
  const auto reverse = [&](std::vector<int>& places) {
    for (int& place : places) place = pattern.size - 1 - place;
  };
  reverse(order.row_place);
  reverse(order.column_place);
  std::swap(order.lower, order.upper);
}

BandOrder given_order(const SparsePattern& pattern) {
  BandOrder order;
  order.row_place.resize(index(pattern.size));
  std::iota(order.row_place.begin(), order.row_place.end(), 0);
  order.column_place = order.row_place;
  find_widths(pattern, order);
  return order;
}

// Nodes are columns together with the rows that are matched to them.
BandOrder matched_order(const SparsePattern& pattern, const std::vector<int>& column_of) {
  std::vector<std::pair<int, int>> edges;
  edges.reserve(pattern.row.size());
  for (int j = 0; j < pattern.size; ++j)
    for (int k = pattern.first[index(j)]; k < pattern.first[index(j) + 1]; ++k) {
      const int v = column_of[index(pattern.row[index(k)])];
      if (v != j) edges.emplace_back(v, j);
    }
  const std::vector<int> nodes = CuthillMcKee(graph_of(pattern.size, edges)).run();
  BandOrder order;
  order.column_place.resize(nodes.size());
  order.row_place.resize(nodes.size());
  for (std::size_t place = 0; place < nodes.size(); ++place)
    order.column_place[index(nodes[place])] = static_cast<int>(place);
  for (std::size_t i = 0; i < nodes.size(); ++i) order.row_place[i] = order.column_place[index(column_of[i])];
  find_widths(pattern, order);
  return order;
}

// Nodes are columns, and rows after them.
BandOrder bipartite_order(const SparsePattern& pattern) {
  std::vector<std::pair<int, int>> edges;
  edges.reserve(pattern.row.size());
  for (int j = 0; j < pattern.size; ++j)
    for (int k = pattern.first[index(j)]; k < pattern.first[index(j) + 1]; ++k)
      edges.emplace_back(j, pattern.size + pattern.row[index(k)]);
  BandOrder order;
  order.column_place.resize(index(pattern.size));
  order.row_place.resize(index(pattern.size));
  int columns = 0, rows = 0;
  for (const int v : CuthillMcKee(graph_of(2 * pattern.size, edges)).run())
    if (v < pattern.size) order.column_place[index(v)] = columns++;
    else order.row_place[index(v - pattern.size)] = rows++;
  find_widths(pattern, order);
  return order;
}

}  // namespace

double BandOrder::flops() const {
  return 2.0 * static_cast<double>(row_place.size()) * (lower + 1.0) * (lower + upper + 1.0);
}

BandOrder band_order(const SparsePattern& pattern, const std::vector<int>& column_of) {
  BandOrder best = given_order(pattern);
  const auto try_order = [&](BandOrder order) {
    if (order.flops() < best.flops()) best = std::move(order);
  };
  if (std::find(column_of.begin(), column_of.end(), -1) == column_of.end())
    try_order(matched_order(pattern, column_of));
  try_order(bipartite_order(pattern));
  return best;
}

}  // namespace sfdae::core
