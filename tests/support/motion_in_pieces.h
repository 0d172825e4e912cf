// SPDX-License-Identifier: BSD-3-Clause
// References for equations that are smooth in pieces, by classical Runge-Kutta steps.
#ifndef SFDAE_TESTS_MOTION_IN_PIECES_H
#define SFDAE_TESTS_MOTION_IN_PIECES_H

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace sfdae_test {

// slopes(t, x) returns x'.
template <class Slopes>
std::vector<double> runge_kutta_step(const Slopes& slopes, double t, std::vector<double> x, double h) {
  const auto moved = [&](const std::vector<double>& by, double part) {
    std::vector<double> y = x;
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += part * h * by[i];
    return y;
  };
  const std::vector<double> a = slopes(t, x), b = slopes(t + 0.5 * h, moved(a, 0.5)),
                            c = slopes(t + 0.5 * h, moved(b, 0.5)), d = slopes(t + h, moved(c, 1.0));
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
  return x;
}

template <class Slopes>
std::vector<double> runge_kutta(const Slopes& slopes, std::vector<double> x, double end, int steps) {
  for (int i = 0; i < steps; ++i) x = runge_kutta_step(slopes, i * end / steps, std::move(x), end / steps);
  return x;
}

// From time 0 on. The motion has parts, each with modes: slopes(t, x) are those of the modes that parts have, which are
// over where is_over(i, t, x); change(i, t, x) gives part i its next mode, and may correct x by what the time is
// located to.
template <class Motion>
std::vector<double> move_in_pieces(Motion& motion, std::vector<double> x, double end) {
  constexpr double longest = 1e-3;
  constexpr int bisections = 60;
  double t = 0.0;
  const auto step = [&](double h) {
    return runge_kutta_step([&](double at, const std::vector<double>& y) { return motion.slopes(at, y); }, t, x, h);
  };
  const auto is_over = [&](double h) {
    const std::vector<double> next = step(h);
    for (std::size_t i = 0; i < motion.parts(); ++i)
      if (motion.is_over(i, t + h, next)) return true;
    return false;
  };
  while (t < end) {
    const double h = std::min(longest, end - t);
    double low = 0.0, high = h;
    if (is_over(h)) {
      for (int k = 0; k < bisections; ++k) {
        const double middle = 0.5 * (low + high);
        (is_over(middle) ? high : low) = middle;
      }
    }
    x = step(high);
    t += high;
    for (std::size_t i = 0; i < motion.parts(); ++i)
      if (motion.is_over(i, t, x)) motion.change(i, t, x);
  }
  return x;
}

}  // namespace sfdae_test

#endif
