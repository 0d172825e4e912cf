// Steps that would not notice what inputs do within them.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/input_watch.h"

#include <algorithm>
#include <cmath>

#include "integrate/radau_method.h"
#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

namespace {

// In tolerances: what a change of slopes amounts to over the step is of no importance; of the change that the ends of
// a step show, what may be hidden between them. (Chosen.)
constexpr double unimportant = 10.0, shown_part = 0.5;
// After as many the step is tried as it is, a billionth of the one that was wanted.
constexpr int most_input_halvings = 30;

}  // namespace

void InputWatch::resize(const DaeSystem& system, int inputs) {
  search_.resize(inputs);
  slopes_.resize(system);
  const std::size_t size_w = index(system.leading_size());
  for (std::vector<double>* v : {&at_start_, &change_, &here_}) v->assign(size_w, 0.0);
  changes_.assign(size_w * InputSearch::most_nodes, 0.0);
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
    search_.search(inputs, nodes, size, fastest_);
    const Importance of_all = of_unseen(integrator, size, search_.unseen());
    if (of_all == Importance::none && of_peaks(integrator, size, nodes) == Importance::none) break;
    size *= 0.5;
    if (of_all == Importance::matters) seen = std::fabs(size);
  }
  if (seen > 0.0) fastest_ = fastest_ > 0.0 ? std::fmin(fastest_, seen) : seen;
  return size;
}

// Whether the slope of w at one of the places is far from what the ends of the step show. Elsewhere inputs may be
// `doubt()` times as far from what the step sees of them, and so may slopes.
InputWatch::Importance InputWatch::of_unseen(Integrator& integrator, double h, std::span<const double> places) {
  const double doubt = std::fmax(search_.doubt(), 1.0);
  if (places.empty()) return doubt > 1.0 ? Importance::unknown : Importance::none;
  const QuietArithmetic quiet;
  const double start = integrator.stepper->state().t;
  if (!has_slope_at_start(integrator) || !slopes_.find(integrator, start + h, change_)) return Importance::unknown;
  for (std::size_t i = 0; i < change_.size(); ++i) change_[i] -= at_start_[i];
  const double enough = unimportant + shown_part * slopes_.size_of_change(integrator, h, change_);
  double largest = 0.0;
  for (const double t : places) {
    if (!slopes_.find(integrator, t, here_)) return Importance::unknown;
    const double part = (t - start) / h;
    for (std::size_t i = 0; i < here_.size(); ++i) here_[i] -= at_start_[i] + part * change_[i];
    const double size = slopes_.size_of_change(integrator, h, here_);
    if (!(size <= enough)) return Importance::matters;
    largest = std::fmax(largest, size);
  }
  return doubt * largest <= enough ? Importance::none : Importance::unknown;
}

// The same of peaks, and of the polynomial through the slopes at all nodes, the first of which is the start: what
// depends on inputs in a linear way is as near to it as they are to theirs.
InputWatch::Importance InputWatch::of_peaks(Integrator& integrator, double h, std::span<const double> nodes) {
  if (search_.peaks().empty()) return Importance::none;
  const QuietArithmetic quiet;
  if (!has_slope_at_start(integrator)) return Importance::unknown;
  const std::size_t size_w = at_start_.size();
  double shown = 0.0;
  for (std::size_t k = 1; k < nodes.size(); ++k) {
    if (!slopes_.find(integrator, nodes[k], change_)) {
      // Before the step w was another one, with which no x may exist: a polynomial of one degree less, then.
      if (k + 1 == nodes.size() && (nodes[k] - nodes[0]) * h < 0.0) {
        nodes = nodes.first(k);
        break;
      }
      return Importance::unknown;
    }
    for (std::size_t i = 0; i < size_w; ++i) change_[i] -= at_start_[i];
    std::copy(change_.begin(), change_.end(), changes_.begin() + static_cast<std::ptrdiff_t>(k * size_w));
    shown = std::fmax(shown, slopes_.size_of_change(integrator, h, change_));
  }
  for (const double t : search_.peaks()) {
    if (!slopes_.find(integrator, t, here_)) return Importance::unknown;
    std::array<double, InputSearch::most_nodes> weights{};
    set_lagrange_weights(nodes, t, weights.data());
    for (std::size_t i = 0; i < size_w; ++i) here_[i] -= at_start_[i];
    for (std::size_t k = 1; k < nodes.size(); ++k)
      for (std::size_t i = 0; i < size_w; ++i) here_[i] -= weights[k] * changes_[k * size_w + i];
    if (!(slopes_.size_of_change(integrator, h, here_) <= unimportant + shown_part * shown))
      return Importance::matters;
  }
  return Importance::none;
}

bool InputWatch::has_slope_at_start(Integrator& integrator) {
  if (has_slope_) return true;
  integrator.weights.update(integrator.stepper->x().data());
  has_slope_ = slopes_.find(integrator, integrator.stepper->state().t, at_start_);
  return has_slope_;
}

}  // namespace sfdae::core
