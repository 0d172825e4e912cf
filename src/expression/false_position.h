// Zero of a function between two points at which its values differ in sign.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

namespace sfdae::core {

struct Bracket {
  double a, b, at_a, at_b;  // places, and values there, of which one is positive and the other is not
};

// The rule of false position, where the value at an end that stays again counts half (Illinois), with bisection in each
// fourth step, until both ends are closer than `near`, or no number is left between them. Returns b.
// [Dow71] M. Dowell, P. Jarratt: A modified regula falsi method for computing the root of an equation. BIT 11
//         (1971), 168-174.
template <class Function>
double zero_between(Function function, Bracket in, double near = 0.0) {
  constexpr int bisects_every = 4;
  bool was_a = false, was_b = false;
  for (int k = 1;; ++k) {
    const double middle = in.a + 0.5 * (in.b - in.a);
    if (!(middle > std::min(in.a, in.b) && middle < std::max(in.a, in.b)) || std::fabs(in.b - in.a) <= near)
      return in.b;
    double c = k % bisects_every == 0 ? middle : (in.at_a * in.b - in.at_b * in.a) / (in.at_a - in.at_b);
    if (!std::isfinite(c)) c = middle;
    // Stays away from an end that is next to the zero, so that the other end gets there, too.
    const double least = 0.5 * near;
    const double low = std::max(std::nextafter(in.a, in.b), in.a + least);
    const double high = std::min(std::nextafter(in.b, in.a), in.b - least);
    c = std::clamp(c, std::min(low, high), std::max(low, high));
    const double at_c = function(c);
    const bool is_a = (at_c > 0.0) == (in.at_a > 0.0);
    if (is_a && was_a) in.at_b *= 0.5;
    if (!is_a && was_b) in.at_a *= 0.5;
    (is_a ? in.a : in.b) = c;
    (is_a ? in.at_a : in.at_b) = at_c;
    was_a = is_a;
    was_b = !is_a;
  }
}

}  // namespace sfdae::core
