// Entries that patterns lack.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/pattern_probe.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "linalg/random.h"
#include "linalg/rank.h"

namespace sfdae::core {

namespace {

// Relative move of an unknown; rounding errors allowed in a sum of terms. Chosen, not measured.
constexpr double part = 0x1p-10, few_roundings = 4096.0;

// Entries may vanish at the first point, where a search for consistent values begins.
constexpr int complete_probes = 3;

// An equation is tested by the groups that contain none of its unknowns. With g random groups an unknown shares its own
// with one of r others with a probability of about r / g, in all divisions with its third power: 1.6 % with g = 4 r. Up
// to few_unknowns unknowns, each is a group by itself, and the test is complete.
constexpr int divisions = 3, few_unknowns = 64, groups_an_entry = 4, longest_row = 30;

std::size_t groups_of(const ColumnPattern& pattern, int rows) {
  if (pattern.columns() <= few_unknowns) return index(pattern.columns());
  std::vector<int> entries(index(rows), 0);
  for (int i : pattern.row) ++entries[index(i)];
  int longest = 0;
  for (int count : entries)
    if (count <= longest_row) longest = std::max(longest, count);
  return index(std::clamp(groups_an_entry * longest, 4, pattern.columns()));
}

}  // namespace

PatternProbe::PatternProbe(const JacobianPatterns& patterns, int num_equations)
    : m_(num_equations),
      n_(patterns.F_x.columns()),
      levels_{{patterns.F_x, groups_of(patterns.F_x, num_equations), {}},
              {patterns.F_xdot, groups_of(patterns.F_xdot, num_equations), {}}},
      contains_(index(num_equations), 0) {}

// Divides all unknowns into random groups; only once if each is a group by itself.
void PatternProbe::divide() {
  std::minstd_rand generator(seed_++);
  for (int level : {0, 1}) {
    const std::size_t count = levels_[level].number_of_groups, first = groups_.size();
    const bool is_single = count == index(n_);
    for (int division = 0; division < (is_single ? 1 : divisions); ++division) {
      const std::size_t own = first + index(division) * count;
      groups_.resize(own + count, {level, {}});
      for (int j = 0; j < n_; ++j) {
        const double at = 0.5 * (1.0 + symmetric_random(generator)) * static_cast<double>(count);
        const std::size_t group = is_single ? index(j) : std::min(static_cast<std::size_t>(at), count - 1);
        groups_[own + group].unknowns.push_back(j);
      }
    }
  }
}

bool PatternProbe::finds(const FunctionOfJet& evaluate, std::vector<double> derivatives, const Equations& equations,
                         Missing& missing, CallbackError& error) {
  evaluate_ = &evaluate;
  derivatives_ = std::move(derivatives);
  F_ = &equations.F;
  moved_.resize(index(m_));
  noise_.resize(index(m_));
  for (std::size_t i = 0; i < noise_.size(); ++i)
    noise_[i] = few_roundings * unit_roundoff * (std::fabs(equations.F[i]) + equations.terms[i]);
  for (int level : {0, 1}) levels_[level].sizes.note(derivatives_.data() + level * n_, n_);
  error_ = {};
  bool found = false;
  const bool takes_all = passed_ < complete_probes;
  if (takes_all) groups_.clear();
  if (groups_.empty()) divide();
  do {
    const Group group = std::move(groups_.back());
    groups_.pop_back();
    found = !group.unknowns.empty() && probe(group.level, group.unknowns, missing);
  } while (takes_all && !found && error_.status == SFDAE_OK && !groups_.empty());
  passed_ = found || error_.status != SFDAE_OK ? 0 : std::min(passed_ + 1, complete_probes);
  error = error_;
  return found && error_.status == SFDAE_OK;
}

// Returns false if F cannot be evaluated there.
bool PatternProbe::evaluate_moved(int level, const std::vector<int>& group, double side) {
  const std::vector<double> before(derivatives_);
  std::minstd_rand generator(1);
  for (int j : group) {
    const double way = symmetric_random(generator) < 0.0 ? -side : side;
    derivatives_[index(j + level * n_)] += way * part * levels_[level].sizes.size(j);
  }
  ++evaluations_;
  const CallbackError error = (*evaluate_)(derivatives_.data(), moved_.data());
  derivatives_ = before;
  if (error.status != SFDAE_OK && !error.is_recoverable()) error_ = error;
  return error.status == SFDAE_OK;
}

bool PatternProbe::probe(int level, const std::vector<int>& group, Missing& missing) {
  if (!evaluate_moved(level, group, 1.0) && (error_.status != SFDAE_OK || !evaluate_moved(level, group, -1.0)))
    return false;
  const ColumnPattern& pattern = levels_[level].pattern;
  std::fill(contains_.begin(), contains_.end(), 0);
  for (int j : group)
    for (int e = pattern.start[index(j)]; e < pattern.start[index(j + 1)]; ++e)
      contains_[index(pattern.row[index(e)])] = 1;
  for (int i = 0; i < m_; ++i) {
    const double change = std::fabs(moved_[index(i)] - (*F_)[index(i)]);
    if (contains_[index(i)] != 0 || !(change > noise_[index(i)])) continue;
    missing = {level, i, -1, 0.0};
    narrow(level, group, missing);
    return missing.column >= 0;
  }
  return false;
}

bool PatternProbe::moves(int level, const std::vector<int>& group, int row, double& change) {
  for (double side : {1.0, -1.0}) {
    if (!evaluate_moved(level, group, side)) continue;
    change = moved_[index(row)] - (*F_)[index(row)];
    if (std::fabs(change) > noise_[index(row)]) return true;
  }
  return false;
}

// Bisects the group: one half changes the equation, too, unless changes cancel.
void PatternProbe::narrow(int level, std::vector<int> group, Missing& missing) {
  double change = 0.0;
  while (group.size() > 1) {
    const auto middle = group.begin() + static_cast<std::ptrdiff_t>(group.size() / 2);
    const std::vector<int> first(group.begin(), middle), second(middle, group.end());
    if (moves(level, first, missing.row, change)) group = first;
    else if (moves(level, second, missing.row, change)) group = second;
    else return;
  }
  const int j = group[0];
  std::vector<double>& x = derivatives_;
  const std::size_t place = index(j + level * n_);
  const double before = x[place];
  for (double side : {1.0, -1.0}) {
    x[place] = before + side * part * levels_[level].sizes.size(j);
    const double distance = x[place] - before;
    ++evaluations_;
    const CallbackError error = (*evaluate_)(x.data(), moved_.data());
    x[place] = before;
    change = moved_[index(missing.row)] - (*F_)[index(missing.row)];
    if (error.status != SFDAE_OK || !(std::fabs(change) > noise_[index(missing.row)])) continue;
    missing.column = j;
    missing.value = change / distance;
    return;
  }
}

}  // namespace sfdae::core
