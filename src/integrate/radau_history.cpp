// The last nodes of a Radau integration, its last step and nodes within that.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/radau_history.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Nodes nearer to each other than this part of the interval before, or of the step, nearly coincide: divided
// differences over both would be rounding errors. Chosen well below the step-size ratios of the control (h_old / h_new
// <= 5): only steps cut short are dropped.
constexpr double coincidence = 0.02;

void archive_node(Archive& archive, RadauNode& node, bool with_x) {
  archive.real(node.t);
  archive.reals(node.w, node.w.size());
  archive.reals(node.wdot, node.wdot.size());
  if (!with_x) return;
  archive.reals(node.x, node.x.size());
  archive.reals(node.xdot, node.xdot.size());
}

}  // namespace

void RadauHistory::resize(std::size_t n, std::size_t size_w, const StepOptions& options) {
  max_count_ = options.max_stages + 1;
  for (int i = 0; i < max_count_; ++i) nodes_[index(i)].assign_zero(n, size_w);
  if (options.interpolates)
    for (RadauNode& node : inner_) node.assign_zero(n, size_w);
  polynomial_.resize(n, size_w, options.max_stages);
}

void RadauHistory::start(const StartingPoint& point) {
  nodes_[0] = {point.t, point.w, point.wdot, point.x, point.xdot};
  count_ = 1;
  inner_count_ = 0;
  last_ = {};
  polynomial_.forget();
}

void RadauHistory::append(RadauStep& step, const InteriorErrors& errors) {
  polynomial_.set(nodes_[0], step, errors);
  count_ = std::min(count_ + 1, max_count_);
  std::rotate(nodes_.begin(), nodes_.begin() + count_ - 1, nodes_.begin() + count_);
  std::swap(nodes_[0], step.end);
  if (count_ >= 3 && std::fabs(nodes_[0].t - nodes_[1].t) < coincidence * std::fabs(nodes_[1].t - nodes_[2].t)) {
    std::rotate(nodes_.begin() + 1, nodes_.begin() + 2, nodes_.begin() + count_);
    --count_;
  }
  inner_count_ = 0;
  last_ = {step.h, step.method->order(), step.method->stages.gamma / step.h};
}

// A new node replaces one that nearly coincides with it; nodes that nearly coincide with an end are not stored.
const RadauNode& RadauHistory::insert(RadauNode& node) {
  const double t = node.t;
  const auto is_near = [&](double other) { return std::fabs(other - t) < coincidence * std::fabs(last_.h); };
  int place = 0;
  while (place < inner_count_ && !is_near(inner_[index(place)].t)) ++place;
  place = std::min(place, inner_capacity - 1);
  std::swap(inner_[index(place)], node);
  if (!is_near(nodes_[0].t) && !is_near(nodes_[1].t)) inner_count_ = std::max(inner_count_, place + 1);
  return inner_[index(place)];
}

ChosenNodes RadauHistory::newest_nodes(int count) const {
  ChosenNodes chosen;
  chosen.count = count;
  for (int i = 0; i < count; ++i) chosen.nodes[index(i)] = &nodes_[index(i)];
  return chosen;
}

ChosenNodes RadauHistory::nodes_around(double t) const {
  std::array<const RadauNode*, index(max_radau_nodes + inner_capacity)> all{};
  int available = 0;
  for (int i = 0; i < count_; ++i) all[index(available++)] = &nodes_[index(i)];
  for (int i = 0; i < inner_count_; ++i) all[index(available++)] = &inner_[index(i)];
  // Both ends of the step are included, to avoid extrapolation.
  std::sort(all.begin() + std::min(available, 2), all.begin() + available,
            [t](const RadauNode* a, const RadauNode* b) { return std::fabs(a->t - t) < std::fabs(b->t - t); });
  ChosenNodes chosen;
  chosen.count = std::min({available, last_stages() + 1, max_radau_nodes});
  std::copy_n(all.begin(), chosen.count, chosen.nodes.begin());
  return chosen;
}

RadauHistory::Extent RadauHistory::extent(const StepOptions& options) const {
  return {std::min(count_, options.max_stages + (options.interpolates ? 1 : 0)), last_.order,
          options.interpolates ? inner_count_ : 0};
}

void RadauHistory::set_extent(const Extent& extent, const StrangenessFreeSystem& system, const StepOptions& options) {
  const int stages = (extent.order + 1) / 2;
  const bool is_order = extent.order == 0 || (extent.order == 2 * stages - 1 && stages % 2 == 1);
  if (!is_order || extent.nodes < 1 || extent.nodes > options.max_stages + 1 || extent.order < 0 ||
      extent.order > 2 * options.max_stages - 1 || extent.inner < 0 || extent.inner > inner_capacity)
    throw DamagedArchive();
  resize(index(system.unknowns()), index(system.leading_size()), options);
  count_ = extent.nodes;
  last_.order = extent.order;
  inner_count_ = extent.inner;
}

void RadauHistory::archive(Archive& archive, const Extent& extent, const Content& content) {
  archive.real(last_.h);
  archive.real(last_.leading_coefficient);
  for (int i = 0; i < extent.nodes; ++i) archive_node(archive, nodes_[index(i)], i == 0 || content.with_x);
  for (int i = 0; i < extent.inner; ++i) archive_node(archive, inner_[index(i)], true);
  if (content.with_polynomial) polynomial_.archive(archive, last_stages(), content.with_w);
}

}  // namespace sfdae::core
