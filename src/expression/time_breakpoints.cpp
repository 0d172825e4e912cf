// Times at which data have kinks or jumps.
// SPDX-License-Identifier: BSD-3-Clause
#include "expression/time_breakpoints.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

// Fraction of half a gap: ends of gaps that are nearer to each other count as one.
constexpr double same_end = 0.25;

}  // namespace

// The result of a search from t on.
struct TimeBreakpoints::Search {
  double t, direction;
  std::optional<End> end = {};     // of a step
  std::optional<Gap> gap = {};     // that holds t
  std::optional<Gap> smooth = {};  // likewise, of no kink

  void note_time(double time, double size, bool is_jump) {
    const double half = half_of_gap(time, size);
    note_gap({time - half, time + half, is_jump});
  }
  void note_gap(const Gap& here) {
    const double slack = same_end * 0.5 * (here.end - here.start);
    note_end(here.far_end(-direction), slack);
    note_end(here.far_end(direction), slack);
    if (t < here.start - slack || t > here.end + slack) return;
    if (gap) {
      gap = Gap{std::min(gap->start, here.start), std::max(gap->end, here.end), gap->is_jump || here.is_jump};
    } else gap = here;
  }
  void note_smooth(const Gap& here) {
    const double width = here.end - here.start;
    note_end(0.5 * (here.start + here.end), width, width);
    if (here.start <= t && t <= here.end) smooth = here;
  }
  void note_end(double time, double near, double slack = 0.0) {
    if ((time - t) * direction <= near) return;
    if (!end || (end->t - time) * direction > 0.0) end = End{time, slack};
  }
};

TimeBreakpoints::TimeBreakpoints(const std::vector<const TaylorEvaluator*>& evaluators)
    : inputs_(evaluators), switches_(evaluators) {}

TimeBreakpoints::Search TimeBreakpoints::search(double t, double toward) {
  Search found{.t = t, .direction = toward < t ? -1.0 : 1.0};
  if (!are_smooth_ && !inputs_.empty()) search_inputs(found, toward);
  search_times(found);
  return found;
}

void TimeBreakpoints::search_inputs(Search& search_for, double toward) {
  for (const SwitchingGap& gap : inputs_.find(search_for.t, toward)) {
    if (gap.jumping_order <= std::max(differentiations_, 1)) search_for.note_gap({gap.start, gap.end});
    else search_for.note_smooth({gap.start, gap.end});
  }
  const double known = inputs_.known_to(), direction = search_for.direction;
  const bool is_beyond_end = search_for.end && (known - search_for.end->t) * direction >= 0.0;
  if ((toward - known) * direction > 0.0 && !is_beyond_end) search_for.end = End{known};
}

void TimeBreakpoints::set_size(double size) {
  size_of_times_ = size;
  inputs_.set_size(size);
}

void TimeBreakpoints::set_times(std::vector<double> times, std::vector<char> jumps) {
  times_ = std::move(times);
  jumps_ = std::move(jumps);
}

void TimeBreakpoints::add_times(const TimeBreakpoints& other) {
  std::map<double, char> jumps;
  for (const TimeBreakpoints* given : {static_cast<const TimeBreakpoints*>(this), &other})
    for (std::size_t k = 0; k < given->times_.size(); ++k) {
      char& is_jump = jumps[given->times_[k]];
      if (given->jumps_[k] != 0) is_jump = 1;
    }
  std::vector<double> times;
  std::vector<char> flags;
  for (const auto& [t, is_jump] : jumps) {
    times.push_back(t);
    flags.push_back(is_jump);
  }
  set_times(std::move(times), std::move(flags));
}

double TimeBreakpoints::size() const {
  const double largest = times_.empty() ? 0.0 : std::max(std::fabs(times_.front()), std::fabs(times_.back()));
  return largest > 0.0 ? largest : size_of_times_;
}

// Searches two times on each side, as gaps may contain each other's times.
void TimeBreakpoints::search_times(Search& search_for) const {
  const auto place = std::lower_bound(times_.begin(), times_.end(), search_for.t) - times_.begin();
  const auto last = std::min<std::ptrdiff_t>(place + 2, static_cast<std::ptrdiff_t>(times_.size()));
  for (auto k = std::max<std::ptrdiff_t>(place - 2, 0); k < last; ++k)
    search_for.note_time(times_[static_cast<std::size_t>(k)], size(), jumps_[static_cast<std::size_t>(k)] != 0);
}

double TimeBreakpoints::end_of_piece(double t, double direction) const {
  const auto count = static_cast<std::ptrdiff_t>(times_.size());
  const auto above = std::upper_bound(times_.begin(), times_.end(), t) - times_.begin();
  const std::ptrdiff_t step = direction > 0.0 ? 1 : -1;
  for (std::ptrdiff_t k = direction > 0.0 ? above : above - 1; k >= 0 && k < count; k += step) {
    const double time = times_[static_cast<std::size_t>(k)], half = half_of_gap(time, size());
    if ((time - t) * direction > (1.0 + same_end) * half) return time - direction * half;
  }
  return direction * infinity;
}

std::optional<TimeBreakpoints::End> TimeBreakpoints::next(double t, double toward) { return search(t, toward).end; }

bool TimeBreakpoints::Gap::ends_at(double t) const {
  const double near = same_end * 0.5 * (end - start);
  return std::fabs(t - start) <= near || std::fabs(t - end) <= near;
}

bool TimeBreakpoints::Gap::begins_at(double t, double direction) const {
  return std::fabs(t - far_end(-direction)) <= same_end * 0.5 * (end - start);
}

std::optional<TimeBreakpoints::Gap> TimeBreakpoints::gap_at(double t) {
  return search(t, t + 4.0 * inputs_.half_gap(t)).gap;
}

bool TimeBreakpoints::are_one(double t, double other) {
  const auto gap = search(t, t + 4.0 * inputs_.half_gap(t)).smooth;
  return gap && gap->start <= other && other <= gap->end;
}

}  // namespace sfdae::core
