// Input watch: shortens steps that would miss changes of inputs within them.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/input_watch.h"

#include <algorithm>
#include <cmath>

#include "integrate/radau_method.h"
#include "linalg/index.h"
#include "linalg/quiet_arithmetic.h"

namespace sfdae::core {

namespace {

// A change hidden between the ends of a step may be this part of the change between the ends, if that is so many
// tolerances: then the error test detects it. (Chosen.)
constexpr double shown_part = 0.5, surely_seen = 20.0;
// An input is resolved if it and its derivative are nearer to their polynomials than this part of their ranges in a
// step. (Chosen.)
constexpr double resolved = 0.01;
// The account is charged with this part of the largest hidden change in a step, about the mean. (Chosen.)
constexpr double mean_part = 0.3;
// Initial balance of the account in tolerances.
constexpr double at_first = 2.0;
// After inputs have shortened a step, local errors are charged for this part of the interval of interest. (Chosen.)
constexpr double lately = 0.01;
// Inputs drive the steps if these are shorter than this part of the interval of interest, and steps longer by this
// factor would miss changes of inputs. (Chosen: 10 to 30 steps for a period of a sine.)
constexpr double short_step = 1e-3, much_longer = 8.0;
// The account is charged with this part of each estimated local error: their sum over the interval of interest stays
// below 50 tolerances, unless steps would need errors below the second part of a tolerance, after some 50,000 such
// steps. (Chosen.)
constexpr double charged = 0.2, least_allowed = 1e-3;
// After so many halvings the step is tried anyway, with a billionth of its initial size.
constexpr int most_input_halvings = 30;

}  // namespace

void InputWatch::resize(const DaeSystem& system, TimeInputs& inputs) {
  differentiates_ = system.differentiates();
  inputs.count_slopes(false);
  of_values_.resize(inputs.count());
  with_slopes_.resize(differentiates_ ? 2 * inputs.count() : 0);
  slopes_.resize(system);
  const std::size_t size_w = index(system.leading_size());
  for (std::vector<double>* v : {&at_start_, &change_, &here_}) v->assign(size_w, 0.0);
  changes_.assign(size_w * InputSearch::most_nodes, 0.0);
}

// For BDF the previous point is a node, too.
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

void InputWatch::open_account(double span) {
  account_.rate = span > 0.0 ? unimportant / span : 0.0;
  account_.balance = at_first;
}

void InputWatch::note_switch(double t) {
  account_.busy = t;
  account_.is_busy = true;
}

bool InputWatch::is_busy(double t) const {
  return account_.is_busy && account_.rate > 0.0 &&
         std::fabs(t - account_.busy) * account_.rate <= lately * unimportant;
}

double InputWatch::allowed_error(double t, double h) const {
  if (!is_busy(t)) return 1.0;
  return std::clamp((account_.balance + account_.rate * std::fabs(h)) / charged, least_allowed, 1.0);
}

void InputWatch::commit(double t, double h, double error) {
  account_.balance +=
      account_.rate * std::fabs(h) - mean_part * account_.charge - (is_busy(t) ? charged * error : 0.0);
  account_.charge = 0.0;
}

void InputWatch::archive_account(Archive& archive) {
  archive.real(account_.rate);
  archive.real(account_.balance);
  archive.real(account_.busy);
  archive.small(account_.is_busy);
}

// hidden, shown: due to changes of slopes over a step of size h, in tolerances.
bool InputWatch::is_important(double hidden, double shown, double h) const {
  const double allowed = account_.rate > 0.0 ? account_.balance + account_.rate * std::fabs(h) : unimportant;
  const bool is_covered = mean_part * hidden <= allowed;
  return !is_covered && !(shown >= surely_seen && hidden <= shown_part * shown);
}

// With differentiated equations, derivatives of inputs are inputs, too; relative to their ranges, their distances from
// their polynomials are similar to those of the inputs.
void InputWatch::search(TimeInputs& inputs, std::span<const double> nodes, double h) {
  inputs.count_slopes(false);
  of_values_.search(inputs, nodes, h, fastest_);
  is_with_slopes_ = differentiates_ && of_values_.farthest() > resolved;
  if (!is_with_slopes_) return;
  inputs.count_slopes(true);
  with_slopes_.search(inputs, nodes, h, fastest_);
}

double InputWatch::noticing_step(Integrator& integrator, TimeInputs& inputs, double h) {
  has_slope_ = false;
  double size = h, seen = 0.0;
  for (int halvings = 0; halvings < most_input_halvings; ++halvings) {
    const std::span<const double> nodes(nodes_.data(), set_nodes(integrator, size));
    search(inputs, nodes, size);
    account_.charge = 0.0;
    const Importance of_all = of_unseen(integrator, size, found().unseen());
    if (of_all == Importance::none && of_peaks(integrator, size, nodes) == Importance::none) break;
    size *= 0.5;
    if (of_all == Importance::matters) seen = std::fabs(size);
  }
  if (size != h || drive_steps(integrator, inputs, h)) note_switch(integrator.stepper->state().t);
  if (seen > 0.0) fastest_ = fastest_ > 0.0 ? std::fmin(fastest_, seen) : seen;
  return size;
}

// True if steps are short because inputs change fast: a moderately longer step than h would miss their changes.
bool InputWatch::drive_steps(Integrator& integrator, TimeInputs& inputs, double h) {
  const StepState state = integrator.stepper->state();
  const bool grows = std::fabs(h) > std::fabs(state.last.h);
  const bool is_short = account_.rate * std::fabs(h) <= short_step * unimportant;
  if (grows || !is_short || is_busy(state.t) || !inputs.are_enclosed()) return false;
  search(inputs, {nodes_.data(), set_nodes(integrator, much_longer * h)}, much_longer * h);
  const double charge = account_.charge;
  const Importance importance = of_unseen(integrator, much_longer * h, found().unseen());
  account_.charge = charge;
  return importance != Importance::none;
}

// Compares the slopes of w at these places with interpolation between the ends of the step. Elsewhere inputs may be
// `doubt()` times as far from their polynomials, and slopes as well.
InputWatch::Importance InputWatch::of_unseen(Integrator& integrator, double h, std::span<const double> places) {
  const double doubt = std::fmax(found().doubt(), 1.0);
  if (places.empty()) return doubt > 1.0 ? Importance::unknown : Importance::none;
  const QuietArithmetic quiet;
  const double start = integrator.stepper->state().t;
  if (!has_slope_at_start(integrator) || !slopes_.find(integrator, start + h, change_)) return Importance::unknown;
  for (std::size_t i = 0; i < change_.size(); ++i) change_[i] -= at_start_[i];
  const double shown = slopes_.size_of_change(integrator, h, change_);
  double largest = 0.0;
  for (const double t : places) {
    if (!slopes_.find(integrator, t, here_)) return Importance::unknown;
    const double part = (t - start) / h;
    for (std::size_t i = 0; i < here_.size(); ++i) here_[i] -= at_start_[i] + part * change_[i];
    const double size = slopes_.size_of_change(integrator, h, here_);
    if (is_important(size, shown, h)) return Importance::matters;
    largest = std::fmax(largest, size);
  }
  account_.charge = std::fmax(account_.charge, largest);
  return is_important(doubt * largest, shown, h) ? Importance::unknown : Importance::none;
}

// Compares the slopes at peaks with the polynomial through the slopes at all nodes, of which the first is the start:
// quantities that depend linearly on inputs are as near to it as the inputs are to theirs.
InputWatch::Importance InputWatch::of_peaks(Integrator& integrator, double h, std::span<const double> nodes) {
  if (found().peaks().empty()) return Importance::none;
  const QuietArithmetic quiet;
  if (!has_slope_at_start(integrator)) return Importance::unknown;
  const std::size_t size_w = at_start_.size();
  double shown = 0.0;
  for (std::size_t k = 1; k < nodes.size(); ++k) {
    if (!slopes_.find(integrator, nodes[k], change_)) {
      // Before the step w differed, and there may be no x for the present one: use a polynomial of one degree less.
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
  for (const double t : found().peaks()) {
    if (!slopes_.find(integrator, t, here_)) return Importance::unknown;
    std::array<double, InputSearch::most_nodes> weights{};
    set_lagrange_weights(nodes, t, weights.data());
    for (std::size_t i = 0; i < size_w; ++i) here_[i] -= at_start_[i];
    for (std::size_t k = 1; k < nodes.size(); ++k)
      for (std::size_t i = 0; i < size_w; ++i) here_[i] -= weights[k] * changes_[k * size_w + i];
    const double size = slopes_.size_of_change(integrator, h, here_);
    if (is_important(size, shown, h)) return Importance::matters;
    account_.charge = std::fmax(account_.charge, size);
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
