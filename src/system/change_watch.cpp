// Changes of the characteristic values along the way.
// SPDX-License-Identifier: BSD-3-Clause
#include "system/change_watch.h"

#include <algorithm>
#include <cmath>

#include "linalg/index.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

// A kept value that falls by this factor at a point inside a step has vanished there.
constexpr double dip = 1e-3;

// Would -next continue the line through older and last more smoothly than +next does?
bool runs_through_zero(double t0, double k0, double t1, double k1, double t2, double k2) {
  const double slope = (k1 - k0) / (t1 - t0);
  const double kept = (k2 - k1) / (t2 - t1), flipped = (-k2 - k1) / (t2 - t1);
  return std::fabs(flipped - slope) < std::fabs(kept - slope);
}

// Narrows changes down with a system of its own, so that the integration's points stay.
class Probe {
 public:
  Probe(LinearSystem& system, double left, double right)
      : system_(system.problem(), system.settings(), system.analysis(), system.leading_term()),
        resolution_(std::max(1e-9 * std::fabs(right - left),
                             8.0 * unit_roundoff * std::max(std::fabs(left), std::fabs(right)))) {
    // A row that vanishes must not be scaled up again.
    if (system.row_ratio() <= moderate_row_ratio) rows_ = RowScaling::common;
    system_.set_row_scaling(rows_);
  }

  bool holds_at(double t) {
    PointStatus status = system_.move_to(t);
    if (status == PointStatus::changed && rows_ == RowScaling::common) {
      // Rows may have become very different on the way: they need factors of their own.
      system_.set_row_scaling(RowScaling::each);
      status = system_.move_to(t);
      system_.set_row_scaling(rows_);
    }
    if (status == PointStatus::callback_error && !system_.callback_error().is_recoverable())
      throw Failure(system_.callback_error().status, system_.callback_error().message());
    // A point that cannot be evaluated says nothing: what is found with it does not count.
    if (status == PointStatus::callback_error) has_failed_ = true;
    return status != PointStatus::changed;
  }
  double kept() const { return std::min(system_.kept_constraints(), system_.kept_differential()); }
  double kept_at(double t) { return holds_at(t) ? kept() : 0.0; }
  bool has_failed() const { return has_failed_; }
  bool is_resolved(double left, double right) const { return std::fabs(right - left) <= resolution_; }
  LinearSystem& system() { return system_; }

  // left holds, right does not.
  LocatedChange bisect_failure(double left, double right) {
    while (!is_resolved(left, right)) {
      const double middle = left + 0.5 * (right - left);
      (holds_at(middle) ? left : right) = middle;
    }
    Arena& arena = system_.arena();
    return {left, right, find_local_values(system_.problem(), right, system_.settings(), arena)};
  }

  // Values at a point where kept() nearly vanishes: what vanishes there counts as zero.
  LocatedChange isolated(double before, double t) {
    AnalysisSettings settings = system_.settings();
    settings.rank_tol = std::max(settings.rank_tol, std::min(30.0 * kept_at(t), 0.1));
    settings.rows = rows_;
    return {before, t, find_local_values(system_.problem(), t, settings, system_.arena())};
  }

 private:
  LinearSystem system_;
  RowScaling rows_ = RowScaling::each;
  bool has_failed_ = false;
  double resolution_;
};

std::optional<LocatedChange> follow_orientation(Probe& probe, double left, double right) {
  if (!probe.holds_at(left)) return std::nullopt;
  const double kept_left = probe.kept();
  probe.system().accept();
  while (!probe.is_resolved(left, right)) {
    const double middle = left + 0.5 * (right - left);
    if (!probe.holds_at(middle)) return probe.bisect_failure(left, middle);
    if (!probe.system().orientation_kept()) {
      right = middle;
      continue;
    }
    probe.system().accept();
    left = middle;
    // Bases that turned far within a step feign a change; over shorter distances it disappears.
    if (!probe.holds_at(right)) return probe.bisect_failure(left, right);
    if (probe.system().orientation_kept()) return std::nullopt;
  }
  if (probe.kept_at(left) > dip * kept_left) return std::nullopt;
  return probe.isolated(left, 0.5 * (left + right));
}

// Minimum of the smallest kept value by golden section.
std::optional<LocatedChange> follow_dip(Probe& probe, double left, double right) {
  const double kept_left = probe.kept_at(left), kept_right = probe.kept_at(right);
  const double level = std::min(kept_left, kept_right);
  const double crossing = left + (right - left) * kept_left / (kept_left + kept_right);
  if (probe.kept_at(crossing) > 0.5 * level) return std::nullopt;
  constexpr double golden = 0.6180339887498949;
  double a = left, b = right;
  double t1 = b - golden * (b - a), t2 = a + golden * (b - a);
  double k1 = probe.kept_at(t1), k2 = probe.kept_at(t2);
  while (!probe.is_resolved(a, b)) {
    if (k1 < k2) {
      b = t2, t2 = t1, k2 = k1;
      k1 = probe.kept_at(t1 = b - golden * (b - a));
    } else {
      a = t1, t1 = t2, k1 = k2;
      k2 = probe.kept_at(t2 = a + golden * (b - a));
    }
  }
  if (std::min(k1, k2) > dip * level) return std::nullopt;
  return probe.isolated(a, k1 < k2 ? t1 : t2);
}

}  // namespace

void ChangeWatch::start(double direction) {
  samples_ = 0;
  accept();
  if (system_.differential() > 0 || system_.is_constant()) return;
  // With d = 0 steps go anywhere at once: the trend at the start comes from a point beside it.
  const double t = system_.t();
  const double distance =
      std::min(0.7e-3 * std::min(system_.data().time_scale, 1.0), system_.problem().room(t, direction));
  system_.accept();
  if (distance <= 0.0) return;
  const PointStatus status = system_.move_to(t + direction * distance);
  if (status == PointStatus::callback_error && !system_.callback_error().is_recoverable())
    throw Failure(system_.callback_error().status, system_.callback_error().message());
  if (status == PointStatus::ok) accept();
}

bool ChangeWatch::breaks_trend(const Sample& older, const Sample& last, const LinearSystem::Trace& now) {
  const auto breaks = [&](std::size_t i, double value) {
    return runs_through_zero(older.t, older.values[i], last.t, last.values[i], now.t, value);
  };
  if (breaks(0, now.kept_constraints) || breaks(1, now.kept_differential)) return true;
  for (std::size_t i = 0; i < now.row_norms.size(); ++i)
    if (breaks(i + 2, now.row_norms[i])) return true;
  return false;
}

std::optional<LocatedChange> ChangeWatch::find(double t_last) {
  if (system_.is_constant()) return std::nullopt;
  system_.trace(now_);
  const Sample* older = samples_ < 2 ? nullptr : &older_;
  const Sample* last = samples_ < 1 ? nullptr : &last_;
  bool orientation_kept = true;
  for (int i = 0; i <= system_.num_stage_traces(); ++i) {
    const LinearSystem::Trace& now = i < system_.num_stage_traces() ? system_.stage_trace(i) : now_;
    const bool has_turned = now.orientation_kept != orientation_kept;
    orientation_kept = now.orientation_kept;
    if (last != nullptr && now.t == last->t) continue;
    if (has_turned || (older != nullptr && breaks_trend(*older, *last, now))) {
      auto change = locate(t_last, now.t, false);
      if (change) return change;
    }
    Sample& sample = trend_[i % 2];
    keep(now, sample);
    older = last;
    last = &sample;
  }
  return std::nullopt;
}

void ChangeWatch::accept() {
  if (samples_ > 0 && last_.t == system_.t()) samples_ = 0;
  // The last two points that the step went through.
  const int traces = system_.num_stage_traces();
  if (traces > 0) {
    keep(system_.stage_trace(traces - 1), older_);
    samples_ = 1;
  } else {
    std::swap(older_, last_);
  }
  last_.t = system_.t();
  last_.values.resize(system_.row_norms().size() + 2);
  last_.values[0] = system_.kept_constraints();
  last_.values[1] = system_.kept_differential();
  std::copy(system_.row_norms().begin(), system_.row_norms().end(), last_.values.begin() + 2);
  samples_ = std::min(samples_ + 1, 2);
}

void ChangeWatch::keep(const LinearSystem::Trace& trace, Sample& sample) {
  sample.t = trace.t;
  sample.values.resize(trace.row_norms.size() + 2);
  sample.values[0] = trace.kept_constraints;
  sample.values[1] = trace.kept_differential;
  std::copy(trace.row_norms.begin(), trace.row_norms.end(), sample.values.begin() + 2);
}

void ChangeWatch::archive(Archive& archive) {
  if (system_.is_constant()) return;
  archive.small(samples_);
  if (archive.is_reading() && (samples_ < 0 || samples_ > 2)) throw DamagedArchive();
  const std::size_t count = index(system_.equations()) + 2;
  Sample* const newest_first[] = {&last_, &older_};
  for (int i = 0; i < samples_; ++i) {
    archive.real(newest_first[i]->t);
    archive.reals(newest_first[i]->values, count);
  }
}

std::optional<LocatedChange> ChangeWatch::locate(double left, double right, bool right_fails) {
  Probe probe(system_, left, right);
  std::optional<LocatedChange> change;
  if (right_fails) {
    if (!probe.holds_at(right)) change = probe.bisect_failure(left, right);
  } else {
    // The orientation is that of the point accepted last, `left`.
    change = follow_orientation(probe, left, right);
    if (!change) change = follow_dip(probe, left, right);
  }
  // The same values on closer inspection: no change.
  if (probe.has_failed() || (change && change->new_values == system_.analysis().values)) change.reset();
  return change;
}

}  // namespace sfdae::core
