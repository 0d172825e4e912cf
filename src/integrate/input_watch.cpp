// Steps that would not notice what inputs do within them.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/input_watch.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "integrate/radau_method.h"
#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

namespace {

// In tolerances: what a change of slopes amounts to over the step is of no importance; of the change that the ends of
// a step show, what may be hidden between them. (Chosen.)
constexpr double unimportant = 10.0, shown_part = 0.5;
constexpr int most_input_halvings = 30;
// Where slopes cannot be found the step fails of itself, or does not.
constexpr int most_blind_halvings = 3, most_blind_halvings_of_crests = 12;

}  // namespace

void InputWatch::resize(const DaeSystem& system, int inputs) {
  samples_.resize(inputs);
  slopes_.resize(system);
  const std::size_t size_w = index(system.leading_size());
  for (std::vector<double>* v : {&at_start_, &change_, &here_}) v->assign(size_w, 0.0);
  changes_.assign(size_w * InputSamples::most_nodes, 0.0);
}

// Of BDF the last point counts, too.
std::size_t InputWatch::set_nodes(const Integrator& integrator, double h) {
  const StepState state = integrator.stepper->state();
  std::size_t count = 0;
  nodes_[count++] = state.t;
  if (integrator.method == Method::radau) {
    const StageMethod& stages = radau_method((state.next_order + 1) / 2).stages;
    for (int i = 0; i < stages.s; ++i) nodes_[count++] = state.t + stages.c[index(i)] * h;
    return count;
  }
  nodes_[count++] = state.t + h;
  if (state.last.h != 0.0) nodes_[count++] = state.t - state.last.h;
  return count;
}

double InputWatch::noticing_step(Integrator& integrator, TimeInputs& inputs, double h) {
  has_slope_ = false;
  double size = h, seen = 0.0;
  for (int halvings = 0; halvings < most_input_halvings; ++halvings) {
    const std::span<const double> nodes(nodes_.data(), set_nodes(integrator, size));
    samples_.take(inputs, nodes, size, fastest_);
    const bool is_unseen = do_matter(integrator, size, samples_.unseen()).value_or(halvings < most_blind_halvings);
    if (!is_unseen && !do_crests_matter(integrator, size, nodes).value_or(halvings < most_blind_halvings_of_crests))
      break;
    size *= 0.5;
    if (is_unseen) seen = std::fabs(size);
  }
  if (seen > 0.0) fastest_ = fastest_ > 0.0 ? std::fmin(fastest_, seen) : seen;
  return size;
}

// Whether the slope of w at one of the places is far from what the ends of the step show; none: slopes cannot be found.
std::optional<bool> InputWatch::do_matter(Integrator& integrator, double h, std::span<const double> places) {
  if (places.empty()) return false;
  const QuietArithmetic quiet;
  const double start = integrator.stepper->state().t;
  if (!has_slope_at_start(integrator)) return false;
  if (!slopes_.find(integrator, start + h, change_)) return std::nullopt;
  for (std::size_t i = 0; i < change_.size(); ++i) change_[i] -= at_start_[i];
  const double shown = slopes_.size_of_change(integrator, h, change_);
  for (const double t : places) {
    if (!slopes_.find(integrator, t, here_)) return std::nullopt;
    const double part = (t - start) / h;
    for (std::size_t i = 0; i < here_.size(); ++i) here_[i] -= at_start_[i] + part * change_[i];
    if (!(slopes_.size_of_change(integrator, h, here_) <= unimportant + shown_part * shown)) return true;
  }
  return false;
}

// The same of crests, and of the polynomial through the slopes at all nodes, the first of which is the start: what
// depends on inputs in a linear way is as near to it as they are to theirs.
std::optional<bool> InputWatch::do_crests_matter(Integrator& integrator, double h, std::span<const double> nodes) {
  if (samples_.crests().empty()) return false;
  const QuietArithmetic quiet;
  if (!has_slope_at_start(integrator)) return false;
  const std::size_t size_w = at_start_.size();
  double shown = 0.0;
  for (std::size_t k = 1; k < nodes.size(); ++k) {
    if (!slopes_.find(integrator, nodes[k], change_)) {
      // Before the step w was another one, with which no x may exist: a polynomial of one degree less, then.
      if (k + 1 == nodes.size() && (nodes[k] - nodes[0]) * h < 0.0) {
        nodes = nodes.first(k);
        break;
      }
      return std::nullopt;
    }
    for (std::size_t i = 0; i < size_w; ++i) change_[i] -= at_start_[i];
    std::copy(change_.begin(), change_.end(), changes_.begin() + static_cast<std::ptrdiff_t>(k * size_w));
    shown = std::fmax(shown, slopes_.size_of_change(integrator, h, change_));
  }
  for (const double t : samples_.crests()) {
    if (!slopes_.find(integrator, t, here_)) return std::nullopt;
    std::array<double, InputSamples::most_nodes> weights{};
    set_lagrange_weights(nodes, t, weights.data());
    for (std::size_t i = 0; i < size_w; ++i) here_[i] -= at_start_[i];
    for (std::size_t k = 1; k < nodes.size(); ++k)
      for (std::size_t i = 0; i < size_w; ++i) here_[i] -= weights[k] * changes_[k * size_w + i];
    if (!(slopes_.size_of_change(integrator, h, here_) <= unimportant + shown_part * shown)) return true;
  }
  return false;
}

bool InputWatch::has_slope_at_start(Integrator& integrator) {
  if (has_slope_) return true;
  integrator.weights.update(integrator.stepper->x().data());
  has_slope_ = slopes_.find(integrator, integrator.stepper->state().t, at_start_);
  return has_slope_;
}

}  // namespace sfdae::core
