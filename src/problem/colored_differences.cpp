// Jacobian entries by finite differences.
// SPDX-License-Identifier: BSD-3-Clause
#include "problem/colored_differences.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "linalg/rank.h"

namespace sfdae::core {

namespace {

// An increment is too small if rounding errors of the terms of a row exceed this part of the difference in all rows. It
// is enlarged by this factor at least, at most so many times, up to that of an unknown of this size. This size is for
// x', of which nothing else is known; F may overflow sooner for x. (Chosen: central differences have errors of 1e-10 as
// a rule.)
constexpr double rounding_part = 1e-7, larger = 1e3, longest_of_xdot = 1e12, longest_of_zeros = 1e3,
                 longest_of_x = 1.0;
constexpr int most_larger = 8;
// An increment is too large if F bends by this part of the difference, or if the size of the unknown is unknown and a
// smaller increment gives another difference. Smaller ones are tried, by that factor, at most so many times, until both
// differences agree to that accuracy, or differ by more than those before, and by less than this part, as rounding
// errors do. (The error of a central difference is about the square of the part.)
constexpr double bent = 3e-5, smaller = 1.0 / 16.0, agreement = noise_of_differences, resolved = 0.1;
constexpr int most_smaller = 8, most_smaller_of_zeros = 24;
// Rounding errors in a value of F.
constexpr double roundings_of_F = 64.0;

}  // namespace

void ChangeSizes::note(const double* values, int n) {
  seen_.resize(index(n), 0.0);
  is_absent_.resize(index(n), 0);
  double largest = 0.0;
  for (int j = 0; j < n; ++j) {
    seen_[index(j)] = std::max(seen_[index(j)], std::fabs(values[j]));
    largest = std::max(largest, seen_[index(j)]);
  }
  size_of_zeros_ = largest > 0.0 ? std::min(largest, 1.0) : 1.0;
}

GroupedPattern full_pattern(int rows, int columns) {
  GroupedPattern full;
  for (int j = 0; j < columns; ++j) {
    for (int i = 0; i < rows; ++i) full.pattern.row.push_back(i);
    full.pattern.start.push_back(full.pattern.entries());
    full.groups.push_back({j});
  }
  return full;
}

ColoredDifferences::ColoredDifferences(const FunctionOfJet& evaluate, const ChangingJet& jet, ChangeSizes& sizes,
                                       const std::vector<double>& F)
    : evaluate_(evaluate),
      jet_(jet),
      sizes_(sizes),
      F_(F),
      before_(jet.derivatives),
      above_(F.size()),
      below_(F.size()) {}

// Calls entry(k, e, c) for entry e of the pattern, which is the kth of the group and in its column c.
template <class Visit>
void ColoredDifferences::visit(const GroupedPattern& grouped, const Group& group, Visit entry) {
  std::size_t k = 0;
  for (std::size_t c = 0; c < group.columns->size(); ++c) {
    const std::size_t j = index((*group.columns)[c]);
    for (int e = grouped.pattern.start[j]; e < grouped.pattern.start[j + 1]; ++e) entry(k++, index(e), c);
  }
}

bool ColoredDifferences::Group::is_zero() const {
  return std::all_of(values.begin(), values.end(), [](double value) { return value == 0.0; });
}

double ColoredDifferences::Group::largest_bend() const {
  return bends.empty() ? 0.0 : *std::max_element(bends.begin(), bends.end());
}

CallbackError ColoredDifferences::move(const Group& group, double side, std::vector<double>& to) {
  // The sum of the errors of truncation and of rounding is least near eps^(1/3).
  const double part = side * std::cbrt(unit_roundoff);
  for (const int j : *group.columns) jet_.unknown(j) += part * std::max(group.factor * sizes_.size(j), group.least);
  return evaluate_(jet_.derivatives.data(), to.data());
}

CallbackError ColoredDifferences::difference(const GroupedPattern& grouped, Group& group) {
  const std::vector<int>& columns = *group.columns;
  group.increments.assign(columns.size(), 0.0);
  // Returns how far unknowns have moved, after all.
  const auto move_back = [&](bool counts, double side) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const double x = before_[index(columns[c] + jet_.level * jet_.n)];
      if (counts) group.increments[c] += side * (jet_.unknown(columns[c]) - x);
      jet_.unknown(columns[c]) = x;
    }
  };
  CallbackError error = move(group, 1.0, above_);
  const bool has_above = error.status == SFDAE_OK;
  move_back(has_above, 1.0);
  if (!has_above && !error.is_recoverable()) return error;
  error = move(group, -1.0, below_);
  const bool has_below = error.status == SFDAE_OK;
  move_back(has_below, -1.0);
  if (!has_below && (!has_above || !error.is_recoverable())) return error;
  group.is_central = has_above && has_below;
  group.values.clear();
  group.bends.clear();
  group.sided.clear();
  visit(grouped, group, [&](std::size_t, std::size_t e, std::size_t c) {
    const std::size_t i = index(grouped.pattern.row[e]);
    const double above = has_above ? above_[i] : F_[i], below = has_below ? below_[i] : F_[i];
    group.values.push_back((above - below) / group.increments[c]);
    group.bends.push_back(std::fabs(above - 2.0 * F_[i] + below));
    const double up = above - F_[i], down = F_[i] - below;
    group.sided.push_back(2.0 * (std::fabs(up) < std::fabs(down) ? up : down) / group.increments[c]);
  });
  return {};
}

bool ColoredDifferences::is_below_rounding(const GroupedPattern& grouped, const std::vector<double>& terms,
                                           const Group& group) const {
  bool is_seen = false;
  visit(grouped, group, [&](std::size_t k, std::size_t e, std::size_t c) {
    const double rounding = unit_roundoff * terms[index(grouped.pattern.row[e])];
    is_seen = is_seen || rounding_part * std::fabs(group.values[k] * group.increments[c]) > rounding;
  });
  return !is_seen;
}

bool ColoredDifferences::bends(const GroupedPattern& grouped, const std::vector<double>& terms,
                               const Group& group) const {
  bool result = false;
  visit(grouped, group, [&](std::size_t k, std::size_t e, std::size_t c) {
    const double least = roundings_of_F / bent * unit_roundoff * terms[index(grouped.pattern.row[e])];
    result = result || group.bends[k] > std::max(least, bent * std::fabs(group.values[k] * group.increments[c]));
  });
  return result && group.is_central;
}

bool ColoredDifferences::is_straight(const GroupedPattern& grouped, const std::vector<double>& terms,
                                     const Group& group) const {
  bool result = true;
  visit(grouped, group, [&](std::size_t k, std::size_t e, std::size_t c) {
    const double size = terms[index(grouped.pattern.row[e])] + std::fabs(group.values[k] * group.increments[c]);
    result = result && group.bends[k] <= roundings_of_F * unit_roundoff * size;
  });
  return result && group.is_central;
}

// Returns the largest relative difference between entries of a and b beyond rounding errors. b has the smaller
// increments.
double ColoredDifferences::disagreement(const GroupedPattern& grouped, const std::vector<double>& terms,
                                        const Group& a, const Group& b) const {
  double result = 0.0;
  visit(grouped, a, [&](std::size_t k, std::size_t e, std::size_t c) {
    const double rounding =
        roundings_of_F * unit_roundoff * terms[index(grouped.pattern.row[e])] / std::fabs(b.increments[c]);
    const double size = std::max(std::fabs(a.values[k]), std::fabs(b.values[k]));
    const double beyond = std::fabs(a.values[k] - b.values[k]) - rounding;
    // Differences that overflow count as a disagreement.
    if (!(beyond <= 0.0)) result = std::max(result, std::isfinite(beyond) ? beyond / size : HUGE_VAL);
  });
  return result;
}

bool ColoredDifferences::are_zero(const std::vector<int>& columns) const {
  return std::all_of(columns.begin(), columns.end(), [this](int j) { return sizes_.is_zero(j); });
}

double ColoredDifferences::longest_increment(const std::vector<int>& columns) const {
  if (jet_.level > 0) return longest_of_xdot;
  return are_zero(columns) ? longest_of_zeros : longest_of_x;
}

CallbackError ColoredDifferences::increase(const GroupedPattern& grouped, const std::vector<double>& terms,
                                           Group& group) {
  if (group.least > 0.0) return {};  // with the largest increments already
  const std::vector<int>& columns = *group.columns;
  const double limit = longest_increment(columns);
  double least = limit;
  for (const int j : columns) least = std::min(least, sizes_.size(j));
  const double by = std::max(larger, std::pow(limit, 1.0 / most_larger) / std::pow(least, 1.0 / most_larger));
  while (least < limit && is_below_rounding(grouped, terms, group)) {
    least = std::min(limit, by * least);
    Group other(columns, group.factor, least);
    const CallbackError error = difference(grouped, other);
    if (error.status != SFDAE_OK && !error.is_recoverable()) return error;
    if (error.status != SFDAE_OK || bends(grouped, terms, other)) return {};
    group = std::move(other);
  }
  for (const int j : columns) sizes_.note_absence(j, group.is_zero());
  return {};
}

// For F linear in x', differences over increments as large as x' itself have rounding errors only.
CallbackError ColoredDifferences::lengthen(const GroupedPattern& grouped, const std::vector<double>& terms,
                                           Group& group, bool& is_linear) {
  double by = 1.0 / std::cbrt(unit_roundoff);
  visit(grouped, group, [&](std::size_t k, std::size_t e, std::size_t c) {
    const double change = std::fabs(group.values[k] * group.increments[c]);
    if (change > 0.0) by = std::max(by, terms[index(grouped.pattern.row[e])] / change);
  });
  Group longer = group.scaled(std::min(by, longest_of_xdot));
  const CallbackError error = difference(grouped, longer);
  if (error.status != SFDAE_OK) return error.is_recoverable() ? CallbackError() : error;
  is_linear = is_straight(grouped, terms, longer) && disagreement(grouped, terms, longer, group) <= agreement;
  if (is_linear) group = std::move(longer);
  return {};
}

CallbackError ColoredDifferences::improve(const GroupedPattern& grouped, const std::vector<double>& terms,
                                          Group& group) {
  if (CallbackError error = increase(grouped, terms, group); error.status != SFDAE_OK) return error;
  if (jet_.level == 1 && !group.is_zero()) {
    bool is_linear = false;
    const CallbackError error = lengthen(grouped, terms, group, is_linear);
    if (error.status != SFDAE_OK || is_linear) return error;
    is_linear_ = false;
  }
  const bool has_no_size = are_zero(*group.columns) && !group.is_zero();
  const int most = has_no_size ? most_smaller_of_zeros : most_smaller;
  double before = 1.0;
  Group larger_one = group;
  for (int tries = 0; tries < most && (has_no_size || bends(grouped, terms, group)); ++tries) {
    Group other = group.scaled(smaller);
    const CallbackError error = difference(grouped, other);
    if (error.status != SFDAE_OK) return error.is_recoverable() ? CallbackError() : error;
    const double apart = disagreement(grouped, terms, group, other);
    if (apart <= agreement) break;
    // Terms that cancel within F have larger rounding errors than those that are visible.
    if (apart >= before && before < resolved) {
      group = std::move(larger_one);
      break;
    }
    before = apart;
    // F bends as much for smaller increments, as at a jump.
    if (bends(grouped, terms, group) && other.largest_bend() > 0.5 * group.largest_bend()) {
      group.values = group.sided;
      break;
    }
    larger_one = std::exchange(group, std::move(other));
  }
  return {};
}

// Columns that F did not depend on before start with the largest increments.
CallbackError ColoredDifferences::first_difference(const GroupedPattern& grouped, Group& group) {
  const std::vector<int>& columns = *group.columns;
  if (std::all_of(columns.begin(), columns.end(), [this](int j) { return sizes_.is_absent(j); })) {
    Group largest(columns, 1.0, longest_increment(columns));
    const CallbackError error = difference(grouped, largest);
    if (error.status != SFDAE_OK && !error.is_recoverable()) return error;
    if (error.status == SFDAE_OK && largest.is_zero()) {
      group = std::move(largest);
      return {};
    }
  }
  CallbackError error = difference(grouped, group);
  const int most = are_zero(columns) ? most_smaller_of_zeros : most_smaller;
  for (int tries = 0; tries < most && error.status != SFDAE_OK && error.is_recoverable(); ++tries) {
    group.factor *= smaller;
    error = difference(grouped, group);
  }
  return error;
}

CallbackError ColoredDifferences::find(const GroupedPattern& grouped, std::vector<double>& terms, double* values) {
  std::vector<Group> groups;
  is_linear_ = true;
  for (const std::vector<int>& columns : grouped.groups) {
    groups.emplace_back(columns, 1.0, 0.0);
    const CallbackError error = first_difference(grouped, groups.back());
    if (error.status != SFDAE_OK) return error;
  }
  for (const Group& group : groups)
    visit(grouped, group, [&](std::size_t k, std::size_t e, std::size_t c) {
      const double x = before_[index((*group.columns)[c] + jet_.level * jet_.n)];
      terms[index(grouped.pattern.row[e])] += std::fabs(group.values[k] * x);
    });
  for (Group& group : groups) {
    const CallbackError error = improve(grouped, terms, group);
    if (error.status != SFDAE_OK) return error;
    visit(grouped, group, [&](std::size_t k, std::size_t e, std::size_t) { values[e] = group.values[k]; });
  }
  return {};
}

}  // namespace sfdae::core
