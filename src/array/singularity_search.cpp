// Search for singular points of a nonlinear system between two points.
// SPDX-License-Identifier: BSD-3-Clause
#include "array/singularity_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "linalg/matrix.h"
#include "linalg/quiet_arithmetic.h"
#include "problem/failure.h"
#include "reduction/elimination.h"
#include "reduction/rank_sequence.h"
#include "starts/consistent_jets.h"
#include "system/location_accuracy.h"

namespace sfdae::core {

namespace {

// Consistent values that differ from the interpolated ones by more, relative, are those of another point.
constexpr double nearness = 1e-3;
// Limit where no step succeeds. Consistent values can only show there that nothing has vanished, even if the errors of
// loose tolerances have led away from them.
constexpr double nearness_at_end = 1e-2;
// Corrections of interpolated values that are larger, relative, lead elsewhere.
constexpr double largest_correction = 1e-2;
// Corrections of converged points: two reach machine precision.
constexpr int corrections = 2;

// Extrapolated values of x that exceed those of points by more than this factor are not credible. Chosen; wrong ones
// usually exceed them by 1e12 to 1e15.
constexpr double credible_growth = 1e6;

double size_of(const Jet& jet, const Units& units) { return units.largest(jet.x.data(), jet.n); }

bool is_near(const std::vector<double>& x, const Jet& consistent, const Units& units, double within) {
  double largest = 0.0, distance = 0.0;
  for (int i = 0; i < consistent.n; ++i) {
    largest = std::max(largest, std::fabs(x[index(i)]) / units[i]);
    distance = std::max(distance, std::fabs(x[index(i)] - consistent.x[index(i)]) / units[i]);
  }
  return distance <= within * largest;
}

}  // namespace

bool SingularitySearch::reduce(const Jet& jet, const std::vector<double>* rows, RowScaling scaling) {
  const PointStatus status = problem_.linearize(jet, rows, data_, scaling);
  if (status == PointStatus::callback_error && !callback_error_.is_recoverable()) callback_error_.raise();
  range_.has_failed |= status != PointStatus::ok;
  if (status != PointStatus::ok) return false;
  const IndexAnalysis& known = problem_.analysis();
  const int mu = problem_.mu();
  const NoiseModel noise = known.noise == NoiseModel::data ? NoiseModel::data : NoiseModel::pivots;
  const Judge::Settings judging{problem_.settings().rank_tol, false, noise, &linearization_.ranks()};
  Judge judge(data_, mu, judging, nullptr);
  const Arena::Frame frame(arena_);
  const QuietArithmetic quiet;  // at a singular point pivots of the known ranks may be zero
  const Carried carried = eliminate(data_, mu, data_.f_stack(mu), 1, judge, arena_, &elimination_);
  form_.resize(data_.m, data_.n, static_cast<int>(problem_.prescribed().size()), carried.rows);
  const Prescription inputs{&problem_.prescribed(), problem_.input_values().data()};
  const PointRanks ranks = form_.build(data_, carried, inputs, LeadingTerm::identity, judge, arena_);
  return judge.fits_known_ranks() && ranks.a == known.values.a && ranks.d == known.values.d &&
         ranks.prescription_fits;
}

bool SingularitySearch::measure(const Jet& jet, SingularitySample& sample) {
  if (!reduce(jet, linearization_.preferred_rows(), RowScaling::each)) return false;
  sample.take(jet.t, data_, problem_.mu(), form_);
  return true;
}

bool SingularitySearch::measure_at(double t, SingularitySample& sample) {
  course_.interpolate(t, jet_);
  return measure(jet_, sample);
}

// One step of Newton's method from the jet that has been reduced, by the smallest change of x. False if that change is
// large, as it is near singular points: it leads elsewhere.
bool SingularitySearch::correct(Jet& jet) {
  const std::size_t n = index(problem_.n()), levels = index(problem_.mu() + 1);
  transformed_.resize(index(problem_.array_rows()) + 1);
  dy_.resize(n * levels);
  const double size = size_of(jet, problem_.units());
  if (!(max_abs(form_.xp(), problem_.n()) <= largest_correction * size)) return false;
  elimination_.transform(data_.f(0), transformed_.data(), arena_);
  elimination_.recover(data_, {data_.f(0), transformed_.data()}, form_.xp(), dy_.data(), arena_);
  if (!all_finite(dy_.data(), dy_.size())) return false;
  jet.add_scaled(form_.xp(), dy_.data(), problem_.jet_order(), data_.time_scale, problem_.units());
  return true;
}

// Iterations for steps leave residuals, which look like nonzero values.
void SingularitySearch::improve_course() {
  if (!problem_.prescribed().empty()) return;
  course_.improve_nodes([this](Jet& jet) {
    for (int k = 0; k < corrections; ++k)
      if (!reduce(jet, linearization_.preferred_rows(), RowScaling::each) || !correct(jet)) return;
  });
}

// Sets the reference of kept values. Rows are scaled by E, so that stiff components do not hide others.
bool SingularitySearch::set_reference(const Jet& jet) {
  reference_.kept = {};
  if (!reduce(jet, linearization_.preferred_rows(), RowScaling::each)) return false;
  reference_.rows = data_.row_scale;
  for (std::size_t i = 0; i < reference_.rows.size(); ++i) {
    double row = 0.0;
    for (int j = 0; j < data_.n; ++j) row = std::max(row, std::fabs(data_.E(0)(static_cast<int>(i), j)));
    if (row > 0.0) reference_.rows[i] = std::ldexp(reference_.rows[i], std::clamp(-std::ilogb(row), -60, 60));
  }
  if (!reduce(jet, &reference_.rows, RowScaling::given)) return false;
  reference_.rows = data_.row_scale;
  reference_.kept = {form_.rank_of_constraints() > 0 ? form_.smallest_constraint() : 1.0,
                     form_.d > 0 ? form_.smallest_of_G() : 1.0};
  return reference_.kept.constraints > 0.0 && reference_.kept.differential > 0.0;
}

// Values kept with the rows of the reference, relative to those kept there. They are 0 if the known ranks do not fit.
SingularitySearch::Kept SingularitySearch::relative(const Jet& jet) {
  if (!reduce(jet, &reference_.rows, RowScaling::given)) return {0.0, 0.0};
  const double factor = reference_.rows[0] / data_.row_scale[0];  // of all rows, where data are tiny
  Kept kept;
  if (form_.rank_of_constraints() > 0)
    kept.constraints = factor * form_.smallest_constraint() / reference_.kept.constraints;
  if (form_.d > 0) kept.differential = factor * form_.smallest_of_G() / reference_.kept.differential;
  return kept;
}

SingularPart SingularitySearch::fallen_part(const Jet& jet) {
  // Chosen: at about a hundredth of the distance over which they were measured values have fallen to a hundredth, or to
  // less if they vanish like a square root.
  constexpr double fallen = 0.3, less = 3.0;
  const Kept kept = relative(jet);
  const double least = std::min(kept.constraints, kept.differential);
  if (!(least < fallen) || least == 0.0) return SingularPart::unknown;
  if (kept.differential > less * kept.constraints) return SingularPart::constraints;
  if (kept.constraints > less * kept.differential) return SingularPart::differential;
  return SingularPart::both;
}

double SingularitySearch::kept_of(const Jet& jet) {
  const Kept kept = relative(jet);
  return std::min(kept.constraints, kept.differential);
}

const Jet& SingularitySearch::interpolated(double t) {
  course_.interpolate(t, jet_);
  return jet_;
}

// Extrapolated values that are not credible count as not fallen.
double SingularitySearch::kept_at(double t) {
  return size_of(interpolated(t), problem_.units()) <= range_.credible_size ? kept_of(jet_) : 1.0;
}

double SingularitySearch::kept(const Jet& reference, const Jet& jet) {
  return set_reference(reference) ? kept_of(jet) : 1.0;
}

bool SingularitySearch::is_resolved(double left, double right) const {
  return std::fabs(right - left) <=
         std::max(location_resolution * range_.span,
                  location_roundings * unit_roundoff * std::max(std::fabs(left), std::fabs(right)));
}

std::optional<double> SingularitySearch::find_turn(double left, double right) {
  range_ = {.span = std::fabs(right - left)};
  if (!measure_at(left, left_) || !measure_at(right, right_) || !right_.is_turned_from(left_, arena_))
    return std::nullopt;
  improve_course();
  if (!measure_at(right, right_) || !measure_at(left, left_) || !set_reference(jet_) ||
      !right_.is_turned_from(left_, arena_))
    return std::nullopt;
  while (!is_resolved(left, right)) {
    const double middle = left + 0.5 * (right - left);
    if (!measure_at(middle, middle_)) {
      if (range_.has_failed) return std::nullopt;
      return middle;
    }
    if (middle_.is_turned_from(left_, arena_)) {
      right = middle;
      std::swap(right_, middle_);
    } else {
      left = middle;
      std::swap(left_, middle_);
      // Bases that turned far within a step feign a change; over shorter distances it disappears.
      if (!right_.is_turned_from(left_, arena_)) return std::nullopt;
    }
  }
  const double t = 0.5 * (left + right);
  return kept_at(t) <= dip_ ? std::optional<double>(t) : std::nullopt;
}

// Golden-section search from a point where less is kept than at both ends.
double SingularitySearch::smallest(double left, double middle, double right, double& kept) {
  constexpr double golden = 0.3819660112501051;
  while (!is_resolved(left, right) && !range_.has_failed) {
    const bool is_right_longer = std::fabs(right - middle) > std::fabs(middle - left);
    const double t = middle + golden * ((is_right_longer ? right : left) - middle);
    const double kept_there = kept_at(t);
    double& end_beyond = is_right_longer ? left : right;
    double& end_here = is_right_longer ? right : left;
    if (kept_there < kept) {
      end_beyond = middle, middle = t, kept = kept_there;
    } else {
      end_here = t;
    }
  }
  return middle;
}

// Starts where values that vanish linearly, or like parabolas, would be zero.
std::optional<double> SingularitySearch::find_dip(const Suspicion& suspicion) {
  constexpr double dips = 0.5, falls = 0.7;
  const double left = suspicion.left, right = suspicion.right;
  range_ = {.span = std::fabs(right - left)};
  const double crossing = left + (right - left) * suspicion.before / (suspicion.before + suspicion.after);
  // The sample for another value in the same interval is often sufficient: a value that is zero at the crossing is as
  // large at the sample as its slopes indicate.
  is_measured_ = is_measured_ && measured_from_ == left && measured_to_ == right;
  const auto is_dismissed = [&] {
    const double beside = (suspicion.before + suspicion.after) * std::fabs(middle_.t - crossing) / range_.span;
    return middle_.values[suspicion.number] > beside + falls * std::min(suspicion.before, suspicion.after);
  };
  const double nearby = 0.1 * range_.span;
  if (is_measured_ && std::fabs(middle_.t - crossing) <= nearby && is_dismissed()) return std::nullopt;
  is_measured_ = measure_at(crossing, middle_);
  measured_from_ = left, measured_to_ = right;
  if (is_measured_ && is_dismissed()) return std::nullopt;
  is_measured_ = false;
  course_.interpolate(left, jet_);
  if (!set_reference(jet_)) return std::nullopt;
  double kept = 1.0, middle = left;
  for (const double power : {1.0, 0.5}) {
    const double before = std::pow(suspicion.before, power), after = std::pow(suspicion.after, power);
    const double t = left + (right - left) * before / (before + after), kept_there = kept_at(t);
    if (kept_there < kept) middle = t, kept = kept_there;
  }
  if (kept > dips || range_.has_failed) return std::nullopt;
  const double level = std::min(1.0, kept_at(right));
  if (kept > dips * level) return std::nullopt;
  improve_course();
  course_.interpolate(left, jet_);
  if (!set_reference(jet_)) return std::nullopt;
  kept = kept_at(middle);
  const double t = smallest(left, middle, right, kept);
  if (range_.has_failed || kept > dip_ * level) return std::nullopt;
  return t;
}

bool SingularitySearch::vanishes_at(double t, double before, double after) {
  range_ = {.span = std::fabs(after - before)};
  if (!set_reference(interpolated(before))) return false;
  const double kept = kept_at(t), level = std::min(1.0, kept_at(after));
  return !range_.has_failed && kept <= dip_ * level;
}

// Steps may fail long before a singular point: falling values are compared with points farther and farther back.
std::optional<double> SingularitySearch::find_ahead(double h) {
  constexpr double falls = 2.0, farther = 8.0;
  constexpr int most = 8;
  range_ = {};
  course_.set_landmarks();
  const double t = course_.newest().t;
  range_.credible_size = credible_growth * size_of(course_.newest(), problem_.units());
  if (!set_reference(course_.newest())) return std::nullopt;
  double last = t;
  for (int k = 0; k < most; ++k) {
    const Jet& landmark = course_.landmark(std::fabs(h) * std::pow(farther, k));
    if (landmark.t == last) continue;
    last = landmark.t;
    const Kept before = relative(landmark);
    const double kept_before = std::max(before.constraints, before.differential);
    if (kept_before >= falls) return find_ahead_of(t, last, kept_before);
  }
  return std::nullopt;
}

// Searches where values that vanish linearly, like parabolas or like cubes would be zero.
std::optional<double> SingularitySearch::find_ahead_of(double t, double before, double kept_before) {
  constexpr double fallen = 0.3;
  for (const double power : {1.0, 0.5, 1.0 / 3.0}) {
    const double distance = (t - before) / (std::pow(kept_before, power) - 1.0);
    range_.span = std::fabs(distance);
    double kept = kept_at(t + distance);
    if (kept > fallen) continue;
    improve_course();
    kept = kept_at(t + distance);
    const double found = smallest(t, t + distance, t + 2.0 * distance, kept);
    if (!range_.has_failed && kept <= dip_) return found;
  }
  return std::nullopt;
}

// Calls the function with jets through values near those of a jet and with the consistent jet among them, unless there
// are none or they are not found. within: relative.
template <class Use>
void SingularitySearch::use_consistent(const Jet& jet, double within, Use use) {
  const std::vector<double> x(jet.x.begin(), jet.x.begin() + jet.n);
  try {
    ConsistentJets jets(problem_.problem(), jet.t, x.data(), {});
    jets.set_units(problem_.units());
    const Jet& consistent = jets.jet_at(jet.t, problem_.mu());
    if (is_near(x, consistent, problem_.units(), within)) use(jets, consistent);
  } catch (const Failure& failure) {
    if (ends_everything(failure.status())) throw;
  }
}

std::optional<Jet> SingularitySearch::consistent_near(const Jet& jet, double within) {
  std::optional<Jet> found;
  use_consistent(jet, within, [&](ConsistentJets&, const Jet& consistent) { found = consistent; });
  return found;
}

std::optional<Jet> SingularitySearch::consistent_at(double t) { return consistent_near(interpolated(t), nearness); }

std::optional<double> SingularitySearch::kept_consistently_at_end(const Jet& reference, const Jet& jet) {
  if (!set_reference(reference)) return std::nullopt;
  const std::optional<Jet> found = consistent_near(jet, nearness_at_end);
  if (!found) return std::nullopt;
  return kept_of(*found);
}

CharacteristicValues SingularitySearch::values_at(double t) {
  CharacteristicValues values;
  use_consistent(interpolated(t), nearness, [&](ConsistentJets& jets, const Jet& consistent) {
    AnalysisSettings settings = problem_.settings();
    settings.rank_tol =
        std::max(settings.rank_tol, std::min(vanishing_factor * kept_of(consistent), largest_rank_tolerance));
    // Rows that vanish must not be scaled up, unless they are of very different size anyway.
    const auto [least, most] = std::minmax_element(reference_.rows.begin(), reference_.rows.end());
    if (*most <= moderate_row_ratio * *least) settings.rows = RowScaling::common;
    values = find_local_values(jets, t, settings, arena_);
  });
  return values;
}

}  // namespace sfdae::core
