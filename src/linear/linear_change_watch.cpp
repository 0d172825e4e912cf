// Changes of the characteristic values of a linear problem during an integration.
// SPDX-License-Identifier: BSD-3-Clause
#include "linear/linear_change_watch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

struct Value {
  double t, value;
};

// Would -next continue the line through older and last more smoothly than +next does?
bool runs_through_zero(Value older, Value last, Value next) {
  const double slope = (last.value - older.value) / (last.t - older.t);
  const double kept = (next.value - last.value) / (next.t - last.t);
  const double flipped = (-next.value - last.value) / (next.t - last.t);
  return std::fabs(flipped - slope) < std::fabs(kept - slope);
}

// Position of the first row norm among the values of a sample.
constexpr int first_row = 2;

// Relative to the time scale (or to 1): near enough to be on the same smooth piece, and no simple fraction of a period.
constexpr double distance_beside_start = 0.7e-3;

}  // namespace

// All memory at once: samples in use must never lack values.
LinearChangeWatch::LinearChangeWatch(LinearSystem& system) : system_(system) {
  const std::size_t rows = index(system.equations());
  for (Sample* sample : {&older_, &last_, &trend_[0], &trend_[1]}) sample->values.resize(first_row + rows);
  now_.row_norms.resize(rows);
  now_.t = std::numeric_limits<double>::quiet_NaN();  // of no point yet
}

void LinearChangeWatch::start(double direction) {
  samples_ = 0;
  accept();
  if (system_.differential() > 0 || system_.is_constant()) return;
  // With d = 0 the first step may be of any size: a point near the start provides the initial trend.
  const double t = system_.t();
  const double distance = std::min(distance_beside_start * std::min(system_.point().data.time_scale, 1.0),
                                   system_.problem().room(t, direction));
  system_.accept();
  if (distance <= 0.0) return;
  const PointStatus status = system_.move_to(t + direction * distance);
  if (status == PointStatus::callback_error && !system_.callback_error().is_recoverable())
    system_.callback_error().raise();
  if (status == PointStatus::ok) accept();
}

bool LinearChangeWatch::breaks_trend(const Sample& older, const Sample& last, const ChangeTrace& now) {
  const auto breaks = [&](std::size_t i, double value) {
    return runs_through_zero({older.t, older.values[i]}, {last.t, last.values[i]}, {now.t, value});
  };
  if (breaks(0, now.kept_constraints) || breaks(1, now.kept_differential)) return true;
  for (std::size_t i = 0; i < now.row_norms.size(); ++i)
    if (breaks(first_row + i, now.row_norms[i])) return true;
  return false;
}

StepSearch LinearChangeWatch::find(double t_last) {
  if (system_.is_constant()) return {};
  now_.take(system_.point(), system_.orientation_kept());
  const Sample* older = samples_ < 2 ? nullptr : &older_;
  const Sample* last = samples_ < 1 ? nullptr : &last_;
  bool orientation_kept = true;
  const StageTraces& stages = system_.stage_traces();
  for (int i = 0; i <= stages.count; ++i) {
    const ChangeTrace& now = i < stages.count ? stages[i] : now_;
    const bool has_turned = now.orientation_kept != orientation_kept;
    orientation_kept = now.orientation_kept;
    if (last != nullptr && now.t == last->t) continue;
    if (has_turned || (older != nullptr && breaks_trend(*older, *last, now))) {
      StepSearch search = locate_isolated_change(system_, t_last, now.t);
      if (search.change || !search.is_complete) return search;
    }
    Sample& sample = trend_[i % 2];
    keep(now, sample);
    older = last;
    last = &sample;
  }
  return {};
}

void LinearChangeWatch::accept() {
  if (samples_ > 0 && last_.t == system_.t()) samples_ = 0;
  // The last two points that the step went through.
  const StageTraces& stages = system_.stage_traces();
  if (stages.count > 0) {
    keep(stages[stages.count - 1], older_);
    samples_ = 1;
  } else {
    std::swap(older_, last_);
  }
  const LinearPoint& point = system_.point();
  const std::vector<double>& row_norms = point.data.row_norm;
  last_.t = point.t;
  last_.values.resize(first_row + row_norms.size());
  last_.values[0] = point.kept_constraints;
  // find() has looked at most points before.
  last_.values[1] = now_.t == point.t ? now_.kept_differential : point.kept_of_rows();
  std::copy(row_norms.begin(), row_norms.end(), last_.values.begin() + first_row);
  samples_ = std::min(samples_ + 1, 2);
}

void LinearChangeWatch::keep(const ChangeTrace& trace, Sample& sample) {
  sample.t = trace.t;
  sample.values.resize(first_row + trace.row_norms.size());
  sample.values[0] = trace.kept_constraints;
  sample.values[1] = trace.kept_differential;
  std::copy(trace.row_norms.begin(), trace.row_norms.end(), sample.values.begin() + first_row);
}

void LinearChangeWatch::archive(Archive& archive, double) {
  if (system_.is_constant()) return;
  archive.small(samples_);
  if (archive.is_reading() && (samples_ < 0 || samples_ > 2)) throw DamagedArchive();
  const std::size_t count = index(system_.equations()) + first_row;
  Sample* const newest_first[] = {&last_, &older_};
  for (int i = 0; i < samples_; ++i) {
    archive.real(newest_first[i]->t);
    archive.reals(newest_first[i]->values, count);
  }
}

}  // namespace sfdae::core
