// Bracket of the first lost sign of several functions.
// SPDX-License-Identifier: BSD-3-Clause
#include "watch/zero_bracket.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "linalg/index.h"

namespace sfdae::core {

namespace {

using Vector = std::vector<double>;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

}  // namespace

void ZeroBracket::resize(int count) {
  const std::size_t size = index(count);
  signs_.resize(size);
  g_before_.resize(size);
  g_after_.resize(size);
}

void ZeroBracket::start(const std::vector<int>& signs, double before, const Vector& g_before, double after,
                        const Vector& g_after) {
  signs_ = signs;
  before_ = before, after_ = after;
  g_before_ = g_before, g_after_ = g_after;
  // A zero at t = 0 has no relative accuracy; this is far below the rounding errors of either end.
  floor_ = 1e-6 * epsilon * std::fabs(after - before);
  factor_ = 1.0;
  last_side_ = 0;
  old_width_ = std::fabs(after - before);
  steps_ = 0;
  slow_rounds_ = 0;
}

bool ZeroBracket::is_lost(const Vector& g) const {
  for (std::size_t i = 0; i < g.size(); ++i)
    if (is_lost(signs_[i], g[i])) return true;
  return false;
}

double ZeroBracket::resolution() const {
  return std::max(2.0 * epsilon * std::max(std::fabs(before_), std::fabs(after_)), floor_);
}

bool ZeroBracket::is_resolved() const { return std::fabs(after_ - before_) <= resolution(); }

// The earliest zero of the chords of all functions that lose their signs.
double ZeroBracket::secant() const {
  double earliest = 1.0;
  for (std::size_t i = 0; i < signs_.size(); ++i) {
    if (!is_lost(signs_[i], g_after_[i])) continue;
    const double before = factor_ * std::fabs(g_before_[i]), after = std::fabs(g_after_[i]);
    earliest = std::min(earliest, before / (before + after));
  }
  return before_ + earliest * (after_ - before_);
}

double ZeroBracket::next() {
  // A round of three steps should halve the width; three bisections do much more. After three slow rounds the chords
  // are useless, as for functions that jump, and bisection follows. (Chosen; the cost is at most nine steps.)
  constexpr int patience = 3, given_up = 3;
  const double width = after_ - before_;
  double t = secant();
  const bool round_is_over = steps_ >= patience;
  const bool is_slow = round_is_over && std::fabs(width) > 0.5 * old_width_;
  if (is_slow) ++slow_rounds_;
  if (is_slow || slow_rounds_ >= given_up) t = before_ + 0.5 * width;
  if (round_is_over) {
    steps_ = 0;
    old_width_ = std::fabs(width);
  }
  // Keep away from the ends: a point next to an end that is on the zero closes the bracket.
  const double margin = std::copysign(std::min(0.5 * resolution(), 0.5 * std::fabs(width)), width);
  const double first = before_ + margin, last = after_ - margin;
  if (!((t - first) * width > 0.0)) t = first;
  if (!((last - t) * width > 0.0)) t = last;
  return t;
}

bool ZeroBracket::place(double t, const Vector& g) {
  const bool lost = is_lost(g);
  const int side = lost ? 1 : -1;
  factor_ = side != last_side_ ? 1.0 : lost ? 0.5 * factor_ : 2.0 * factor_;
  last_side_ = side;
  ++steps_;
  (lost ? after_ : before_) = t;
  (lost ? g_after_ : g_before_) = g;
  return lost;
}

}  // namespace sfdae::core
