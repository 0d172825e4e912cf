// Points within stored steps.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/points_within.h"

#include <cmath>
#include <utility>

#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Maximum of halvings of the step to a point if its equations have no solution.
constexpr int most_point_halvings = 8;
// Part of the tolerances, as in steps of nonlinear problems.
constexpr double tolerance_factor = 0.2;

const KeptPoint& end_of(const KeptSurroundings& given) {
  return given.own[given.step.method != nullptr ? given.step.method->s - 1 : 0];
}

// Copies the present system of the integration: results of the analysis, including known ranks, matter.
std::unique_ptr<SystemTwin> twin_of(AdjointSystem& system) {
  Archive counter = Archive::counter();
  system.system().archive(counter);
  std::vector<double> saved(counter.size());
  Archive writer = Archive::writer(saved.data(), saved.size());
  system.system().archive(writer);
  Archive reader = Archive::reader(saved.data(), saved.size());
  std::unique_ptr<SystemTwin> twin = system.twin();
  try {
    twin->restore(reader);
  } catch (const DamagedArchive&) {
    throw Failure(SFDAE_INTERNAL, "the equations cannot be evaluated where the integration stands.");
  }
  return twin;
}

}  // namespace

PointsWithin::PointsWithin(AdjointSystem& system, const Tolerances& tolerances, KeepToPiece keep_to_piece)
    : system_(system), keep_to_piece_(std::move(keep_to_piece)) {
  weights_.set(tolerances, Tightening::none, tolerance_factor);
  const std::size_t n = index(system.unknowns());
  collocation_.resize(n, max_radau_nodes);
  xdot_.resize(n);
}

// Moves the second system of x to its state after the step.
void PointsWithin::stand_at(const KeptSurroundings& given) {
  const KeptPoint &from = *given.before.front(), &to = end_of(given);
  if (twin_ && from_ == from.jet.t && to_ == to.jet.t) return;
  if (!twin_) twin_ = twin_of(system_);
  from_ = to_ = 0.0;  // invalid until both are set
  keep_to_piece_(twin_->system(), from.jet.t);
  twin_->stand_between(from, to);
  from_ = from.jet.t;
  to_ = to.jet.t;
}

KeptPoint PointsWithin::interpolated(const KeptSurroundings& given, const KeptStep& formula) {
  stand_at(given);
  const std::size_t n = xdot_.size();
  std::vector<double> x(n, 0.0);
  for (int i = 0; i <= formula.order; ++i) {
    const Jet& jet = i == 0 ? end_of(given).jet : given.before[index(i - 1)]->jet;
    for (std::size_t r = 0; r < n; ++r) x[r] += formula.rest[index(i)] * jet.x[r];
  }
  DaeSystem& system = twin_->system();
  const PointStatus status = system.move_to(formula.t);
  if (status == PointStatus::callback_error) system.callback_error().raise();
  if (status != PointStatus::ok)
    throw Failure(SFDAE_CHARACTERISTICS_CHANGED,
                  format("the characteristic values do not hold at t = %.15g, an isolated point: choose another time "
                         "for the functional.",
                         formula.t));
  const std::vector<double> guess(x);
  system.restore(nullptr, guess.data(), x.data());
  return twin_->point(nullptr);
}

// Prediction by the collocation polynomial of the step.
Guess PointsWithin::predict(const StageMethod& method, double t_start, double t_end, const KeptSurroundings& given) {
  const int order = twin_->system().taylor_order();
  const std::size_t block = xdot_.size() * index(order + 1);
  predicted_.resize(block * index(method.s));
  at_end_.resize(block);
  at_start_.resize(block);
  for (int i = 0; i < method.s; ++i)
    collocation_.taylor(i + 1 == method.s ? t_end : t_start + method.c[index(i)] * (t_end - t_start), order,
                        predicted_.data() + block * index(i));
  collocation_.taylor(given.step.t, order, at_end_.data());
  collocation_.taylor(given.before.front()->jet.t, order, at_start_.data());
  return {.taylor = predicted_.data(),
          .taylor_before = at_end_.data(),
          .inverse_weights = weights_.inverse(),
          .taylor_at_start = at_start_.data()};
}

std::vector<ShorterStep> PointsWithin::steps_to(double t, const KeptSurroundings& given) {
  stand_at(given);
  const StageMethod& method = *given.step.method;
  const std::size_t n = xdot_.size();
  const KeptPoint& start = *given.before.front();
  collocation_.set_collocation(method, {given.step.t, given.step.h}, n,
                               [&](int i) { return i == 0 ? start.jet.x.data() : given.own[i - 1].jet.x.data(); });
  weights_.update(end_of(given).jet.x.data());
  stages_.resize(n * index(method.s));
  w_.resize(stages_.size());
  DaeSystem& system = twin_->system();
  std::vector<ShorterStep> steps;
  std::vector<double> from(start.jet.x.begin(), start.jet.x.begin() + static_cast<std::ptrdiff_t>(n));
  double at = start.jet.t, h = t - at;
  for (int halvings = 0;;) {
    const bool is_last = std::fabs(t - at) < 1.5 * std::fabs(h);
    const double to = is_last ? t : at + h;
    double reached = to;
    // Halvings may end between two adjacent numbers.
    PointStatus status =
        to == at ? PointStatus::not_converged
                 : system.solve_stages({method, at, to, from.data(), from.data(), predict(method, at, to, given)},
                                       stages_.data(), w_.data(), reached);
    if (status == PointStatus::ok && !all_finite(stages_.data(), stages_.size())) status = PointStatus::not_converged;
    const bool is_final = status == PointStatus::callback_error && !system.callback_error().is_recoverable();
    if (is_final) system.callback_error().raise();
    if (status == PointStatus::ok) {
      TriedStep tried;
      tried.t = to;
      tried.h = to - at;
      tried.x = stages_.data();
      tried.method = &method;
      tried.x_start = from.data();
      steps.push_back({tried.h, {}});
      keep_points(*twin_, tried, xdot_, steps.back().stages);
      if (is_last) return steps;
      std::copy_n(stages_.data() + n * index(method.s - 1), n, from.data());
      at = to;
    } else if (++halvings > most_point_halvings) {
      throw Failure(SFDAE_NO_CONSISTENT_VALUES,
                    format("the stages of a step from t = %.15g to t = %.15g, within the one to t = %.15g, have no "
                           "solution: take the end of a step for the functional.",
                           start.jet.t, t, given.step.t));
    } else {
      h *= 0.5;
    }
  }
}

}  // namespace sfdae::core
