// Output of the Radau methods within steps.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "integrate/newton_polynomial.h"
#include "integrate/radau.h"
#include "linalg/index.h"
#include "linalg/matrix.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

// Of the Hermite polynomial without its farthest node.
constexpr double interpolation_error = 0.5, nonlinear_interpolation_error = 1e-3;

}  // namespace

// For x, through the start of the last step and its stages: returns the degree. All of it lies within the step.
int Radau::collocation_polynomial() {
  const int s = (last_order_ + 1) / 2;
  const RadauMethod& method = radau_method(s);
  const std::size_t n = nodes_[0].x.size();
  for (int i = 0; i <= s; ++i) {
    table_times_[index(i)] = i == 0 ? -1.0 : method.stages.c[index(i - 1)] - 1.0;
    const double* from = i == 0 ? nodes_[1].x.data() : last_stages_.data() + n * index(i - 1);
    std::copy_n(from, n, table_[index(i)].data());
  }
  for (int k = 1; k <= s; ++k)
    for (int i = s; i >= k; --i) {
      const double per_gap = 1.0 / (table_times_[index(i)] - table_times_[index(i - k)]);
      const double* earlier = table_[index(i - 1)].data();
      double* to = table_[index(i)].data();
      for (std::size_t r = 0; r < n; ++r) to[r] = (to[r] - earlier[r]) * per_gap;
    }
  return s;
}

int Radau::choose_nodes(double t) {
  std::array<const Node*, index(capacity + inner_capacity)> all{};
  int available = 0;
  for (int i = 0; i < count_; ++i) all[index(available++)] = &nodes_[index(i)];
  for (int i = 0; i < inner_count_; ++i) all[index(available++)] = &inner_[index(i)];
  // Both ends of the step always, lest it be extrapolation.
  std::sort(all.begin() + std::min(available, 2), all.begin() + available,
            [t](const Node* a, const Node* b) { return std::fabs(a->t - t) < std::fabs(b->t - t); });
  const int wanted = std::min({available, (last_order_ + 1) / 2 + 1, capacity});
  std::copy_n(all.begin(), wanted, chosen_.begin());
  return wanted;
}

void Radau::hermite_polynomial(const Vector Node::*values, const Vector Node::*slopes, int count) {
  const std::size_t size = (nodes_[0].*values).size();
  for (int i = 0; i < 2 * count; ++i) {
    const Node& node = *chosen_[index(i / 2)];
    const bool is_slope = i % 2 == 1;
    table_times_[index(i)] = (node.t - nodes_[0].t) / last_step_;
    const double unit = is_slope ? last_step_ : 1.0;
    const double* from = (node.*(is_slope ? slopes : values)).data();
    for (std::size_t r = 0; r < size; ++r) table_[index(i)][r] = unit * from[r];
  }
  divided_differences(table_, table_times_, 2 * count, size);
}

// Newton's polynomial in the table and its derivative (slope may be null).
void Radau::evaluate_hermite(int count, double t, std::size_t size, double* value, double* slope) const {
  const double at = (t - nodes_[0].t) / last_step_;
  std::copy_n(table_[index(2 * count - 1)].data(), size, value);
  if (slope != nullptr) std::fill_n(slope, size, 0.0);
  for (int i = 2 * count - 2; i >= 0; --i) {
    const double gap = at - table_times_[index(i)];
    const double* d = table_[index(i)].data();
    if (slope != nullptr)
      for (std::size_t r = 0; r < size; ++r) slope[r] = slope[r] * gap + value[r];
    for (std::size_t r = 0; r < size; ++r) value[r] = value[r] * gap + d[r];
  }
  if (slope != nullptr)
    for (std::size_t r = 0; r < size; ++r) slope[r] /= last_step_;
}

void Radau::interpolate(double t, double* w, double* x, double* xdot) {
  const Node& last = nodes_[0];
  if (t == last.t || count_ < 2) {
    std::copy(last.w.begin(), last.w.end(), w);
    std::copy(last.x.begin(), last.x.end(), x);
    std::copy(last.xdot.begin(), last.xdot.end(), xdot);
    return;
  }
  const int count = choose_nodes(t);
  hermite_polynomial(&Node::x, &Node::xdot, count);
  evaluate_hermite(count, t, last.x.size(), x, xdot);
  hermite_polynomial(&Node::w, &Node::wdot, count);
  evaluate_hermite(count, t, last.w.size(), w, nullptr);
}

// The stages of a step from the start of the last one to t, or of a few shorter ones if they have no solution: within_ is
// the end. tried_.t: the stage that fails.
PointStatus Radau::solve_within(StrangenessFreeSystem& system, ErrorWeights& weights, double t) {
  constexpr int most_halvings = 4;
  const RadauMethod& method = radau_method((last_order_ + 1) / 2);
  const std::size_t n = nodes_[0].x.size();
  const bool needs_guess = !system.is_linear();
  if (needs_guess) weights.update(nodes_[0].x.data());
  Node& from = within_from_;
  from = nodes_[1];
  double h = t - from.t;
  for (int halvings = 0; halvings <= most_halvings;) {
    const bool is_last = std::fabs(t - from.t) < 1.5 * std::fabs(h);
    within_.t = is_last ? t : from.t + h;
    Guess prediction;
    if (needs_guess) {
      prediction = guess(system, method, from, within_.t, collocation_polynomial());
      prediction.inverse_weights = weights.inverse();
      prediction.taylor_at_start = guess_start_.data();
    }
    PointStatus status =
        system.solve_stages({method.stages, from.t, within_.t, from.w.data(), from.x.data(), prediction},
                            stage_x_.data(), stage_w_.data(), tried_.t);
    if (status == PointStatus::ok && !all_finite(stage_x_.data(), n * index(method.s())))
      status = PointStatus::not_converged;
    if (status == PointStatus::ok) {
      take_last_stage(method, from, within_);
      if (is_last) return status;
      std::swap(from, within_);
    } else if (status != PointStatus::not_converged || ++halvings > most_halvings) {
      return status;
    } else {
      h *= 0.5;
    }
  }
  return PointStatus::not_converged;
}

PointStatus Radau::refine(StrangenessFreeSystem& system, ErrorWeights& weights, double t, double* w, double* x,
                          double* xdot) {
  const PointStatus status = system.move_to(t);
  if (status != PointStatus::ok || system.differential() == 0 || count_ < 2) return status;
  // What the farthest node contributes to the polynomial for w, which stands in the table, is the error of the others.
  const int count = choose_nodes(t);
  const std::size_t size_w = nodes_[0].w.size();
  const double at = (t - nodes_[0].t) / last_step_;
  double product = 1.0;
  for (int i = 0; i < 2 * count - 2; ++i) product *= at - table_times_[index(i)];
  const double last_gap = at - table_times_[index(2 * count - 2)];
  for (std::size_t r = 0; r < size_w; ++r)
    columns_[r] = product * (table_[index(2 * count - 2)][r] + last_gap * table_[index(2 * count - 1)][r]);
  system.error_in_x(columns_.data(), mapped_.data());
  update(weights, nodes_[1], nodes_[0]);
  // What the iteration leaves of errors at the nodes is not seen by differences: more is asked for.
  const double limit = system.is_linear() ? interpolation_error : nonlinear_interpolation_error;
  if (weights.norm(mapped_.data()) <= limit) return PointStatus::ok;
  tried_.t = t;
  const PointStatus stages = solve_within(system, weights, t);
  // A stage may fail where the point itself does not: then the polynomial has to do.
  if (stages != PointStatus::ok)
    return stages == PointStatus::callback_error && tried_.t == t ? stages : system.move_to(t);
  // Of points that nearly coincide the newest is kept, and none that nearly coincides with an end: the divided differences
  // would be rounding errors.
  const auto is_near = [&](double other) { return std::fabs(other - t) < coincidence * std::fabs(last_step_); };
  int place = 0;
  while (place < inner_count_ && !is_near(inner_[index(place)].t)) ++place;
  place = std::min(place, inner_capacity - 1);
  Node& node = inner_[index(place)];
  std::swap(node, within_);
  if (!is_near(nodes_[0].t) && !is_near(nodes_[1].t)) inner_count_ = std::max(inner_count_, place + 1);
  std::copy(node.w.begin(), node.w.end(), w);
  std::copy(node.x.begin(), node.x.end(), x);
  std::copy(node.xdot.begin(), node.xdot.end(), xdot);
  return PointStatus::ok;
}

void Radau::archive(Archive& archive, Node& node, bool with_x) {
  archive.real(node.t);
  archive.reals(node.w, node.w.size());
  archive.reals(node.wdot, node.wdot.size());
  if (!with_x) return;
  archive.reals(node.x, node.x.size());
  archive.reals(node.xdot, node.xdot.size());
}

void Radau::archive(Archive& archive, const StrangenessFreeSystem& system) {
  // Points within steps need one node more, and x at all of them.
  int count = std::min(count_, options_.max_stages + (options_.interpolates ? 1 : 0));
  int inner = options_.interpolates ? inner_count_ : 0;
  archive.small(count, last_order_, inner, first_stages_, options_.min_stages, options_.max_stages);
  if (archive.is_reading()) {
    const auto is_number = [](int s) { return s >= 1 && s <= max_stages && s % 2 == 1; };
    if (!is_number(options_.min_stages) || !is_number(options_.max_stages) ||
        options_.min_stages > options_.max_stages || !is_number(first_stages_))
      throw DamagedArchive();
    if (count < 1 || count > options_.max_stages + 1 || last_order_ < 0 ||
        last_order_ > 2 * options_.max_stages - 1 || inner < 0 || inner > inner_capacity)
      throw DamagedArchive();
    count_ = count;
    inner_count_ = inner;
    control_.set_options(options_);
    resize(index(system.unknowns()), index(system.leading_size()));
  }
  control_.archive(archive);
  for (double* value : {&next_step_, &last_step_, &leading_coefficient_}) archive.real(*value);
  // Guesses extrapolate x.
  const bool needs_x = options_.interpolates || !system.is_linear();
  for (int i = 0; i < count; ++i) this->archive(archive, nodes_[index(i)], i == 0 || needs_x);
  for (int i = 0; i < inner; ++i) this->archive(archive, inner_[index(i)], true);
  if ((options_.interpolates || system.guesses_values()) && !system.is_linear() && last_order_ > 0)
    archive.reals(last_stages_.data(), nodes_[0].x.size() * index((last_order_ + 1) / 2));
}

}  // namespace sfdae::core
