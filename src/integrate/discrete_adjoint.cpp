// The discrete adjoint of an integration.
// SPDX-License-Identifier: BSD-3-Clause
#include "integrate/discrete_adjoint.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "linalg/dense.h"
#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// Size of the ring of point weights: points on which steps still to be read depend, and one for a point within the step
// being read, or at the end.
constexpr std::size_t window = max_bdf_order + 2;

bool is_zero(ConstView a) {
  for (int j = 0; j < a.cols; ++j)
    for (int i = 0; i < a.rows; ++i)
      if (a(i, j) != 0.0) return false;
  return true;
}

template <class Value>
void make_room_for_one(std::vector<Value>& values) {
  if (values.size() == values.capacity()) values.reserve(2 * values.size() + 64);
}

// Options that affect the steps.
bool are_alike(const IntegrationOptions& a, const IntegrationOptions& b) {
  return a.tolerances == b.tolerances && a.stepping == b.stepping && a.never_pass_output == b.never_pass_output;
}

std::shared_ptr<const IntegrationOptions> options_of_steps(const IntegrationOptions& options) {
  auto copy = std::make_shared<IntegrationOptions>();
  copy->tolerances = options.tolerances;
  copy->stepping = options.stepping;
  copy->never_pass_output = options.never_pass_output;
  return copy;
}

// In either direction.
bool is_between(double from, double t, double to) { return from < to ? from < t && t < to : to < t && t < from; }

// True if the steps take more memory than the checkpoint from which they can be repeated.
bool is_worth_dropping(const StepPiece& piece) { return piece.kept.bytes() > piece.bytes() - piece.kept.bytes(); }

// The points before step i of a piece, the newest first.
std::vector<const KeptPoint*> points_before(const StepPiece& piece, const KeptSteps& steps, std::size_t i) {
  const std::size_t wanted = index(std::max(steps.step(i).order, 1));
  std::vector<const KeptPoint*> points;
  for (std::size_t k = i; k-- > 0 && points.size() < wanted;) points.push_back(&steps.end(k));
  for (std::size_t k = 0; k < piece.before.size() && points.size() < wanted; ++k) points.push_back(&piece.before[k]);
  if (points.size() < wanted)
    throw Failure(SFDAE_INTERNAL, format("points before t = %.15g are missing.", steps.step(i).t));
  return points;
}

// Drops the steps of a piece, or its checkpoint if that takes more memory or evaluations have failed.
void close(StepPiece& piece) {
  if (piece.checkpoint.empty()) return;
  if (!piece.has_failures && is_worth_dropping(piece)) {
    piece.kept.drop();
    piece.attempts.shrink_to_fit();
  } else {
    piece.checkpoint = {};
    piece.attempts = {};
  }
}

}  // namespace

// A third of the steps each: the piece being filled, the stored ones before it, and, in the backward pass, a repeated
// one.
DiscreteAdjoint::DiscreteAdjoint(std::unique_ptr<AdjointSystem> system, std::vector<double> S, long max_kept_steps)
    : system_(std::move(system)),
      S_(std::move(S)),
      length_of_pieces_(max_kept_steps == 0 ? 0 : static_cast<std::size_t>(std::max(max_kept_steps / 3, 1L))),
      xdot_(index(system_->unknowns())) {}

// ---- Forward ---------------------------------------------------------------------------------------------------

void DiscreteAdjoint::start(const Integrator& integrator) {
  KeptStep step;
  step.t = integrator.stepper->state().t;
  tried_points_.clear();
  tried_points_.push_back(system_->point(nullptr));
  make_room_for_one(times_);
  if (pieces_.empty() || !keeps_all()) {
    StepPiece piece;
    piece.first = piece.origin = times_.size();
    piece.begins_anew = true;
    piece.kept.make_room();
    pieces_.push_back(std::move(piece));
    drop_pieces();
  } else {
    pieces_.back().kept.make_room();
  }
  origin_ = times_.size();
  last_ = step;
  pieces_.back().kept.add(step, tried_points_);
  ++pieces_.back().count;
  ++kept_points_;
  times_.push_back(step.t);
}

// After failed evaluations, which may not recur, a new piece begins, so that they are not part of a repetition.
void DiscreteAdjoint::prepare(Integrator& integrator, const IntegrationOptions& options, double t) {
  if (keeps_all()) return;
  const StepPiece& piece = pieces_.back();
  const long failed_evaluations = integrator.system.failed_evaluations();
  const bool has_failed = failed_evaluations != failed_evaluations_ ||
                          (!piece.attempts.empty() && piece.attempts.back().end == AttemptEnd::failed);
  const bool is_full = piece.count >= length_of_pieces_ && is_worth_dropping(piece);
  if (piece.checkpoint.empty() || has_failed || is_full || !are_alike(*piece.options, options))
    begin_piece(integrator, options);
  failed_evaluations_ = failed_evaluations;
  std::vector<Attempt>& attempts = pieces_.back().attempts;
  make_room_for_one(attempts);
  attempts.push_back({t, AttemptEnd::failed, integrator.weights.part()});
}

// Begins at the point reached by the integrator, which may be the first one of the last piece.
void DiscreteAdjoint::begin_piece(Integrator& integrator, const IntegrationOptions& options) {
  StepPiece& last = pieces_.back();
  std::shared_ptr<const IntegrationOptions> kept =
      last.options && are_alike(*last.options, options) ? last.options : options_of_steps(options);
  if (last.count == (last.begins_anew ? 1u : 0u)) {
    last.save(integrator);
    last.options = std::move(kept);
    return;
  }
  StepPiece piece;
  piece.first = times_.size();
  piece.origin = origin_;
  piece.follow(last, integrator.method == Method::bdf ? index(max_bdf_order) : 1);
  piece.save(integrator);
  piece.options = std::move(kept);
  pieces_.push_back(std::move(piece));
  drop_pieces();
}

// The oldest ones are dropped before the last one is filled.
void DiscreteAdjoint::drop_pieces() {
  for (; next_to_drop_ + 1 < pieces_.size() && kept_points_ > length_of_pieces_; ++next_to_drop_) {
    StepPiece& piece = pieces_[next_to_drop_];
    close(piece);
    kept_points_ -= piece.is_dropped() ? piece.count : 0;
  }
}

void DiscreteAdjoint::note(AttemptEnd end) {
  if (keeps_all()) return;
  AttemptEnd& noted = pieces_.back().attempts.back().end;
  const bool is_final = noted == AttemptEnd::failed && end == AttemptEnd::reduced;
  if (!is_final) noted = end;
}

StepOutcome DiscreteAdjoint::attempt(Integrator& integrator, const Tolerances&) {
  Stepper& stepper = *integrator.stepper;
  const TriedStep tried = stepper.tried();
  try {
    make_room_for_one(times_);
    pieces_.back().kept.make_room();
    tried_ = formula_of(tried, &times_.back(), times_.size() - origin_);
    keep_points(*system_, tried, xdot_, tried_points_);
  } catch (...) {
    stepper.withdraw();
    stepper.set_next_step(tried.h);
    throw;
  }
  return StepOutcome::accepted;
}

void DiscreteAdjoint::commit(Integrator& integrator) {
  if (integrator.system.failed_evaluations() != failed_evaluations_) pieces_.back().has_failures = true;
  pieces_.back().kept.add(tried_, tried_points_);
  ++pieces_.back().count;
  ++kept_points_;
  times_.push_back(tried_.t);
  last_ = tried_;
  note(AttemptEnd::taken);
}

// The point gets its own piece, which is never repeated.
void DiscreteAdjoint::end_within(const Integrator& integrator, double t,
                                 const std::function<const double*(double)>& move_to) {
  const StepState state = integrator.stepper->state();
  StepPiece piece;
  piece.first = times_.size();
  piece.origin = origin_;
  piece.count = 1;
  KeptStep step;
  tried_points_.clear();
  if (last_.method != nullptr) {
    const double from = state.t - state.last.h;
    step.t = t;
    step.h = t - from;
    step.method = last_.method;
    step.is_within = true;
    for (int i = 0; i < step.method->s; ++i)
      tried_points_.push_back(
          system_->point(move_to(i + 1 == step.method->s ? t : from + step.method->c[index(i)] * step.h)));
  } else {
    const int points = static_cast<int>(times_.size() - origin_);
    step = interpolation_at(t, std::min(last_.order, points - 1), &times_.back());
  }
  piece.kept.make_room();
  piece.kept.add(step, tried_points_);
  make_room_for_one(times_);
  pieces_.push_back(std::move(piece));
  times_.push_back(t);
}

void DiscreteAdjoint::drop_all() {
  for (; next_to_drop_ < pieces_.size() && !keeps_all(); ++next_to_drop_) close(pieces_[next_to_drop_]);
}

TangentSpace DiscreteAdjoint::tangent_space() {
  const KeptPoint here = system_->point(nullptr);
  TangentSpace space;
  const PointStatus status = system_->find_tangent_space(here, space);
  demand(status, here.jet.t);
  if (space.inconsistency > contradiction_of_derivatives)
    throw Failure(
        SFDAE_INCONSISTENT_EQUATIONS,
        format("redundant equations contradict each other at t = %.15g once a parameter is changed: relative "
               "residual %.3g of their derivatives by parameters. Gradients do not exist.",
               here.jet.t, space.inconsistency));
  return space;
}

void DiscreteAdjoint::demand(PointStatus status, double t) const {
  if (status == PointStatus::callback_error) system_->callback_error().raise();
  if (status != PointStatus::ok)
    throw Failure(SFDAE_SINGULAR, format("the equations of the sensitivities at t = %.15g are singular: the "
                                         "characteristic values that are known do not hold there.",
                                         t));
}

AdjointWork DiscreteAdjoint::work() const {
  AdjointWork work;
  for (const StepPiece& piece : pieces_) {
    work.kept_steps += static_cast<long>(piece.kept.count());
    work.checkpoints += piece.checkpoint.empty() ? 0 : 1;
    work.bytes += sizeof(StepPiece) + piece.bytes();
  }
  work.kept_steps -= pieces_.front().kept.count() > 0 ? 1 : 0;
  work.bytes += sizeof(double) * times_.capacity();
  work.repeated_steps = repeated_steps_;
  return work;
}

// ---- Backward --------------------------------------------------------------------------------------------------

std::optional<DiscreteAdjoint::Place> DiscreteAdjoint::place_of(double t) const {
  for (std::size_t k = times_.size(); k-- > 0;)
    if (times_[k] == t) return Place{k, false, t};
  // An integration that ends within its last step has one more point there.
  const KeptSteps& last = pieces_.back().kept;
  const bool ends_within = last.count() == 1 && last.step(0).is_within;
  for (std::size_t k = times_.size() - (ends_within ? 1 : 0); k-- > 1;)
    if (is_between(times_[k - 1], t, times_[k])) return Place{k, true, t};
  return std::nullopt;
}

struct DiscreteAdjoint::Backward {
  Backward(AdjointSystem& its_system, const Functionals& its_functionals, const Surroundings& its_surroundings,
           View its_gradient)
      : system(its_system),
        functionals(its_functionals),
        surroundings(its_surroundings),
        gradient(its_gradient),
        weights(window, Matrix(its_system.unknowns(), its_functionals.count)),
        order(its_functionals.places.size()) {
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [this](std::size_t a, std::size_t b) { return point(a) < point(b); });
  }
  std::size_t point(std::size_t place) const { return functionals.places[place].point; }
  // Places within the step to point k, or at its end.
  template <class Action>
  void for_places(std::size_t k, bool are_within, Action action) const {
    const auto is_before = [this](std::size_t place, std::size_t wanted) { return point(place) < wanted; };
    for (auto place = std::lower_bound(order.begin(), order.end(), k, is_before);
         place != order.end() && point(*place) == k; ++place)
      if (functionals.places[*place].is_within == are_within) action(*place);
  }
  // Adds the weights of the functionals at that point.
  void add_weights(std::size_t k) {
    for_places(k, false, [&](std::size_t place) { add_weights_of(place, weights[k % window]); });
  }
  void add_weights_of(std::size_t place, View here) const {
    const std::size_t size = index(here.rows), places = functionals.places.size();
    for (int q = 0; q < functionals.count; ++q)
      for (int i = 0; i < here.rows; ++i)
        here(i, q) += functionals.weights[index(i) + size * (place + places * index(q))];
  }
  // False if points from the first one on, and earlier points by the steps already read, have only zero weights.
  bool has_anything(std::size_t first) const {
    return (!order.empty() && point(order.back()) >= first) ||
           !std::all_of(weights.begin(), weights.end(), [](const Matrix& at) { return is_zero(at); });
  }
  void keep_to_piece(double t) const { surroundings.keep_to_piece(system.system(), t); }
  PointsWithin& points_within() {
    if (!within) within.emplace(system, surroundings.tolerances, surroundings.keep_to_piece);
    return *within;
  }

  AdjointSystem& system;
  const Functionals& functionals;
  const Surroundings& surroundings;
  View gradient;
  std::vector<Matrix> weights;     // of the last points
  std::vector<std::size_t> order;  // places sorted by their points
  std::optional<PointsWithin> within;
};

// Transforms weights of point k into weights of the points before it.
void DiscreteAdjoint::read_back(const KeptStep& step, const KeptPoint* points, std::size_t k, Backward& backward) {
  const View here = backward.weights[k % window];
  const AdjointValues values{here, backward.gradient};
  PointStatus status = PointStatus::ok;
  if (step.method != nullptr) status = system_->step_back(*step.method, step.h, points, values);
  else if (step.is_interpolated()) status = PointStatus::ok;
  else if (step.order > 0) status = system_->step_back(*points, step.c, values);
  else status = system_->restore_back(*points, values);
  demand(status, step.t);
  hand_on(step, k, backward);
}

void DiscreteAdjoint::hand_on(const KeptStep& step, std::size_t k, Backward& backward) {
  const View here = backward.weights[k % window];
  for (int i = 0; i < step.num_before(); ++i) {
    const View before = backward.weights[(k - 1 - index(step.num_skipped() + i)) % window];
    const double part = step.order > 0 ? step.rest[index(i)] : 1.0;
    for (int q = 0; q < here.cols; ++q)
      for (int r = 0; r < here.rows; ++r) before(r, q) += part * here(r, q);
  }
  fill(here, 0.0);
}

// Functionals at points within step i of a piece. Their weights are stored as those of a point after its end.
void DiscreteAdjoint::read_within(const StepPiece& piece, const KeptSteps& steps, std::size_t i, Backward& backward) {
  const std::size_t k = piece.first + i;
  const View here = backward.weights[(k + 1) % window];
  const AdjointValues values{here, backward.gradient};
  backward.for_places(k, true, [&](std::size_t place) {
    const Place& at = backward.functionals.places[place];
    backward.add_weights_of(place, here);
    if (is_zero(here)) return;
    const KeptStep& step = steps.step(i);
    const KeptSurroundings given{step, steps.points(i), points_before(piece, steps, i), &times_[k]};
    backward.keep_to_piece(times_[k - 1]);
    if (step.method != nullptr) {
      std::vector<ShorterStep> shorter = backward.points_within().steps_to(at.t, given);
      for (auto part = shorter.rbegin(); part != shorter.rend(); ++part)
        demand(system_->step_back(*step.method, part->h, part->stages.data(), values), at.t);
      KeptStep within;
      within.method = step.method;
      within.is_within = true;
      hand_on(within, k + 1, backward);
    } else {
      const KeptStep within = interpolation_at(at.t, step.order, &times_[k]);
      if (system_->has_constraints())
        demand(system_->restore_back(backward.points_within().interpolated(given, within), values), at.t);
      hand_on(within, k + 1, backward);
    }
  });
}

void DiscreteAdjoint::read_piece(const StepPiece& piece, const KeptSteps& steps, Backward& backward) {
  for (std::size_t i = piece.count; i-- > 0;) {
    const std::size_t k = piece.first + i;
    read_within(piece, steps, i, backward);
    backward.add_weights(k);
    // Earlier points do not affect the functionals by this step.
    if (k == 0 || is_zero(backward.weights[k % window])) continue;
    backward.keep_to_piece(times_[k - 1 - index(steps.step(i).num_skipped())]);
    read_back(steps.step(i), steps.points(i), k, backward);
  }
}

void DiscreteAdjoint::gradient(const Functionals& functionals, const Surroundings& surroundings, double* gradient) {
  const int n = unknowns();
  Matrix sum(std::max(count(), 1), functionals.count);
  const View result = sum.view().top(count());
  Backward backward(*system_, functionals, surroundings, result);
  std::unique_ptr<SystemTwin> twin;
  for (auto piece = pieces_.rbegin(); piece != pieces_.rend(); ++piece) {
    if (!backward.has_anything(piece->first)) continue;
    if (!piece->is_dropped()) {
      read_piece(*piece, piece->kept, backward);
      continue;
    }
    if (!twin) twin = system_->twin();
    repeated_steps_ += static_cast<long>(piece->count);
    read_piece(*piece, steps_made_again(*piece, times_, *twin), backward);
  }
  system_->forget_work();
  const ConstView start{S_.data(), n, count(), std::max(n, 1)};
  multiply(1.0, Op::transposed, start, Op::plain, backward.weights[0], 1.0, result);
  for (int q = 0; q < functionals.count; ++q) {
    if (!all_finite(result.column(q), index(count())))
      throw Failure(SFDAE_NOT_FINITE, "the gradient overflows: rescale the problem or the weights.");
  }
  for (int q = 0; q < functionals.count; ++q)
    std::copy_n(result.column(q), count(), gradient + static_cast<std::ptrdiff_t>(q) * count());
}

}  // namespace sfdae::core
