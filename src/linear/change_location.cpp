// Location of changes of the characteristic values of a linear problem between two points.
// SPDX-License-Identifier: BSD-3-Clause
#include "linear/change_location.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "problem/failure.h"
#include "system/location_accuracy.h"

namespace sfdae::core {

namespace {

// A kept value that falls by this factor at a point inside a step has vanished there.
constexpr double dip_within_step = 1e-3;
// A value that falls by this factor has vanished, whatever the unit of time.
constexpr double vanished = 1e-6;

// Narrows changes down with a system of its own, so that the integration's points stay.
class Probe {
 public:
  Probe(LinearSystem& system, double left, double right)
      : system_(system.problem(), system.settings(), system.analysis(), system.leading_term()),
        resolution_(std::max(location_resolution * std::fabs(right - left),
                             location_roundings * unit_roundoff * std::max(std::fabs(left), std::fabs(right)))) {
    // A row that vanishes must not be scaled up again.
    if (system.reduction().row_ratio(system.point()) <= moderate_row_ratio) rows_ = RowScaling::common;
    system_.reduction().set_rows(rows_);
  }

  bool holds_at(double t) {
    PointStatus status = system_.move_to(t);
    if (status == PointStatus::changed && rows_ == RowScaling::common) {
      // Rows may have changed size by very different factors on the way: they need factors of their own.
      system_.reduction().set_rows(RowScaling::each);
      status = system_.move_to(t);
      system_.reduction().set_rows(rows_);
    }
    if (status == PointStatus::callback_error && !system_.callback_error().is_recoverable())
      system_.callback_error().raise();
    // A point that cannot be evaluated proves nothing: changes found with it do not count.
    if (status == PointStatus::callback_error) has_failed_ = true;
    return status != PointStatus::changed;
  }
  // Values kept in E T2 are relative to E: if all of E vanishes, its size shows it.
  double kept() const {
    const LinearPoint& point = system_.point();
    if (system_.differential() == 0) return point.kept_constraints;
    return std::min(point.kept_constraints, point.kept_differential * max_abs(point.data.E(0)));
  }
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
    return {left, right, find_local_values(system_.problem(), right, system_.settings(), arena), 0.0};
  }

  // Values at a point where kept() nearly vanishes: vanishing values count as zero there.
  LocatedChange isolated(double before, double t) {
    AnalysisSettings settings = system_.settings();
    settings.rank_tol = std::max(settings.rank_tol, std::min(vanishing_factor * kept_at(t), largest_rank_tolerance));
    settings.rows = rows_;
    return {before, t, find_local_values(system_.problem(), t, settings, system_.arena()), 0.0};
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
    // Bases that turned far within a step mimic a change; over shorter distances it disappears.
    if (!probe.holds_at(right)) return probe.bisect_failure(left, right);
    if (probe.system().orientation_kept()) return std::nullopt;
  }
  if (probe.kept_at(left) > dip_within_step * kept_left) return std::nullopt;
  LocatedChange change = probe.isolated(left, 0.5 * (left + right));
  // A value that changed its sign has vanished, however large the remainder is in other units of time.
  if (change.new_values == probe.system().analysis().values) change.new_values = {};
  return change;
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
  const double kept = std::min(k1, k2);
  if (kept > dip_within_step * level) return std::nullopt;
  LocatedChange change = probe.isolated(a, k1 < k2 ? t1 : t2);
  if (kept <= vanished * level && change.new_values == probe.system().analysis().values) change.new_values = {};
  return change;
}

// Nothing is found with a point that could not be evaluated, or if the values are the same on closer inspection.
StepSearch confirmed(const Probe& probe, std::optional<LocatedChange> change, const CharacteristicValues& known) {
  if (probe.has_failed() || (change && change->new_values == known)) change.reset();
  return {std::move(change), !probe.has_failed()};
}

}  // namespace

std::optional<LocatedChange> locate_change(LinearSystem& system, double left, double right) {
  Probe probe(system, left, right);
  if (probe.holds_at(right)) return std::nullopt;
  return confirmed(probe, probe.bisect_failure(left, right), system.analysis().values).change;
}

StepSearch locate_isolated_change(LinearSystem& system, double left, double right) {
  Probe probe(system, left, right);
  // The orientation is that of the point accepted last, `left`.
  std::optional<LocatedChange> change = follow_orientation(probe, left, right);
  if (!change) change = follow_dip(probe, left, right);
  return confirmed(probe, change, system.analysis().values);
}

}  // namespace sfdae::core
