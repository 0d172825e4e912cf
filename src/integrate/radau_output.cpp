// Points within the last step of a Radau method.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/radau_output.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"
#include "linalg/matrix.h"

namespace sfdae::core {

namespace {

// Errors allowed for the collocation polynomial, in units of the weights: for w, if constraints determine the rest, and
// for x. The weights of nonlinear problems are a fifth of the tolerances (docs/design/error_control.md).
constexpr double error_in_w = 2.0, error_in_x = 3.0, nonlinear_units = 5.0;
// The estimate is that of the end of the step. If the matrices of a linear problem turn within a step, errors are much
// larger. Consistent values show this: they differ from interpolated ones by more than this, and by more than so many
// estimates (otherwise by 1.2 of them). Polynomials with estimates below the last number are not tested.
constexpr double doubtful_difference = 5.0, doubtful_ratio = 4.0, safe_error = 0.5;
// Errors below this part of the allowed error do not limit the next step, because they may be due to the slope at the
// start, from a longer step before; smallest limit in units of the last step. (Chosen.)
constexpr double telling_error = 0.02, least_ratio = 0.1;
// Errors allowed for the Hermite polynomial without its most distant node, in units of the tolerances: they are larger
// than the errors of the full polynomial. Differences do not show the iteration errors of nonlinear equations at the
// nodes: their limit is smaller. (Chosen; with these limits polynomials within steps were accurate.)
constexpr double hermite_error = 0.5, nonlinear_hermite_error = 1e-3;
// Maximum of halvings of the step to a point within the last one if its equations have no solution.
constexpr int most_output_halvings = 4;

// Hermite polynomial through the nodes around t.
void set_polynomial(const RadauHistory& history, Interpolated which, double t, HermiteTable& table) {
  const ChosenNodes chosen = history.nodes_around(t);
  table.set_nodes(chosen, which, 2 * chosen.count, history.newest().t, history.last().h);
}

void copy_to(const RadauNode& node, const PointValues& point) {
  if (point.w != nullptr) std::copy(node.w.begin(), node.w.end(), point.w);
  std::copy(node.x.begin(), node.x.end(), point.x);
  if (point.xdot != nullptr) std::copy(node.xdot.begin(), node.xdot.end(), point.xdot);
}

}  // namespace

void RadauOutput::resize(const StrangenessFreeSystem& system, int most_stages) {
  const std::size_t n = index(system.unknowns()), size_w = index(system.leading_size());
  is_linear_ = system.is_linear();
  interpolates_well_ = false;
  longest_ = std::numeric_limits<double>::infinity();
  within_.stages.resize(n, size_w, most_stages);
  for (RadauNode* node : {&within_.end, &from_}) node->assign_zero(n, size_w);
  contribution_.assign(size_w, 0.0);
  mapped_.assign(n, 0.0);
  guess_.assign_zero(n * index(system.taylor_order() + 1));
}

// Steps of one stage have no accurate polynomial, and are short.
void RadauOutput::note_step(const RadauHistory& history) {
  guess_.forget_ends();
  const int s = history.polynomial().stages();
  const double limit = (is_linear_ ? 1.0 : nonlinear_units) * error_in_w, error = history.polynomial().error_of_w();
  interpolates_well_ = s > 1 && error <= limit;
  const bool says_much = s > 1 && error > telling_error * limit;
  longest_ = says_much ? std::fabs(history.last().h) * std::max(least_ratio, std::pow(limit / error, 1.0 / (s + 1)))
                       : std::numeric_limits<double>::infinity();
}

bool RadauOutput::interpolates_x(const RadauHistory& history) const {
  const double limit = (is_linear_ ? 1.0 : nonlinear_units) * error_in_x;
  return interpolates_well_ && history.polynomial().error_of_x() <= limit && !point_of_test(history);
}

// Midpoint between two stages near the middle, where values are interpolated.
std::optional<double> RadauOutput::point_of_test(const RadauHistory& history) const {
  const RadauPolynomial& polynomial = history.polynomial();
  if (!is_linear_ || !interpolates_well_ || polynomial.is_tested() || polynomial.error_of_w() <= safe_error)
    return std::nullopt;
  const int s = polynomial.stages();
  const auto& c = radau_method(s).stages.c;
  return history.newest().t - (1.0 - 0.5 * (c[index(s / 2)] + c[index(s / 2 + 1)])) * history.last().h;
}

bool RadauOutput::gives_up_polynomial(RadauHistory& history, const ErrorWeights& weights, const double* interpolated,
                                      const double* x) {
  if (!is_linear_) return false;
  for (std::size_t i = 0; i < mapped_.size(); ++i) mapped_[i] = interpolated[i] - x[i];
  const double difference = weights.norm(mapped_.data());
  const bool is_doubtful =
      difference > doubtful_difference && difference > doubtful_ratio * history.polynomial().error_of_x();
  history.note_test(is_doubtful ? difference : 0.0);
  if (is_doubtful) note_step(history);
  return is_doubtful;
}

Guess RadauOutput::guess_within(const RadauHistory& history, double t, int order) {
  if (!interpolates_well_) return {};
  const double newest = history.newest().t;
  return guess_.within(history.polynomial(), {t, newest, newest - history.last().h}, order);
}

void RadauOutput::interpolate(const RadauHistory& history, HermiteTable& table, const PointValues& point) {
  const RadauNode& newest = history.newest();
  if (point.t == newest.t) return copy_to(newest, point);
  if (interpolates_well_) {
    history.polynomial().evaluate_x(point.t, point.x, point.xdot);
    if (point.w != nullptr) history.polynomial().evaluate_w(point.t, point.w);
    return;
  }
  if (history.count() < 2) return copy_to(newest, point);
  set_polynomial(history, Interpolated::x, point.t, table);
  table.evaluate(point.t, point.x, point.xdot);
  if (point.w == nullptr) return;
  set_polynomial(history, Interpolated::w, point.t, table);
  table.evaluate(point.t, point.w, nullptr);
}

// A step from the start of the last one, or a few shorter ones if it has no solution.
PointStatus RadauOutput::solve_within(StrangenessFreeSystem& system, ErrorWeights& weights,
                                      const RadauHistory& history, RadauWorkspace& workspace, double target) {
  double reached = target;
  const RadauMethod& method = radau_method(history.last_stages());
  const std::size_t n = history.newest().x.size();
  const bool needs_guess = !system.is_linear();
  if (needs_guess) weights.update(history.newest().x.data());
  RadauNode &from = from_, &end = within_.end;
  RadauStages& stages = within_.stages;
  from = history.node(1);
  double h = target - from.t;
  for (int halvings = 0; halvings <= most_output_halvings;) {
    const bool is_last = std::fabs(target - from.t) < 1.5 * std::fabs(h);
    end.t = is_last ? target : from.t + h;
    if (end.t == from.t) return PointStatus::not_converged;  // halves are below the resolution of t
    Guess prediction;
    if (needs_guess) {
      workspace.table.set_collocation(history);
      const RadauPredictor predictor{history, &workspace.table};
      prediction = workspace.guess.predict(predictor, method.stages, from.t, end.t, system.taylor_order());
      prediction.inverse_weights = weights.inverse();
      prediction.taylor_at_start = workspace.guess.at_start(predictor, system.taylor_order());
    }
    PointStatus status = system.solve_stages({method.stages, from.t, end.t, from.w.data(), from.x.data(), prediction},
                                             stages.x.data(), stages.w.data(), reached);
    if (status == PointStatus::ok && !all_finite(stages.x.data(), n * index(method.s())))
      status = PointStatus::not_converged;
    if (status == PointStatus::ok) {
      stages.take_end(method, from, end);
      if (is_last) return status;
      std::swap(from, end);
    } else if (status != PointStatus::not_converged || ++halvings > most_output_halvings) {
      return status;
    } else {
      h *= 0.5;
    }
  }
  return PointStatus::not_converged;
}

PointStatus RadauOutput::refine(StrangenessFreeSystem& system, ErrorWeights& weights, const PointValues& point,
                                RadauHistory& history, RadauWorkspace& workspace) {
  const double t = point.t;
  const PointStatus status = system.move_to(t);
  if (status != PointStatus::ok || system.differential() == 0 || interpolates_well_ || history.count() < 2)
    return status;
  set_polynomial(history, Interpolated::w, t, workspace.table);
  // The contribution of the most distant node to the polynomial bounds the error of the others.
  workspace.table.contribution_of_last(history.nodes_around(t).count, t, contribution_);
  system.error_in_x(contribution_.data(), mapped_.data());
  workspace.scales.update(weights, history.node(1), history.newest());
  const double limit = system.is_linear() ? hermite_error : nonlinear_hermite_error;
  if (weights.norm(mapped_.data()) <= limit) return PointStatus::ok;
  const PointStatus stages = solve_within(system, weights, history, workspace, t);
  if (stages != PointStatus::ok) return stages;
  copy_to(history.insert(within_.end), point);
  return PointStatus::ok;
}

}  // namespace sfdae::core
