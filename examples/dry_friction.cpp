// SPDX-License-Identifier: BSD-3-Clause
//
// A block of 2 kg slides over a floor with the friction 0.3 N, N being the force of the floor, an unknown:
//     x' = u,  y' = v,  2 u' = F(t) - 0.3 N sign(u),  2 v' = N - 2 g,  y = 0.
// It is thrown at 1.5 m/s, comes to rest, and is pulled with the force F = 2 t newtons. The switch at u = 0 finds the
// motion along it, at rest: there the friction is what keeps it there, at most 0.3 N.
//
// Check: position and times in closed form.
#include <cmath>
#include <cstdio>
#include <sfdae/hybrid.hpp>

int main() {
  const double g = 9.81, friction = 0.3, mass = 2, pull = 2, speed = 1.5, end = 5;
  const auto block = [=](double sign) {
    sfdae::NonlinearProblem problem(5, 5);
    problem.equations = [=](const auto& t, auto x, auto xdot, auto F) {
      F[0] = xdot[0] - x[2];
      F[1] = xdot[1] - x[3];
      F[2] = mass * xdot[2] - pull * t + sign * friction * x[4];
      F[3] = mass * xdot[3] - x[4] + mass * g;
      F[4] = x[1];
    };
    sfdae::Options options;
    options.rtol = options.atol = 1e-8;
    return sfdae::Solver(problem, options);
  };
  sfdae::Solver backward = block(-1), forward = block(1);
  sfdae::Hybrid hybrid;
  const int below = hybrid.add_mode(backward, "backward"), above = hybrid.add_mode(forward, "forward");
  hybrid.add_switch(
      below, above, [](const auto&, auto x) { return x[2]; }, "rest");

  sfdae::Point point{0, {0, 0, speed, 0, 0}, {}};
  hybrid.start(above, point, end);
  hybrid.advance(end, point);
  std::printf("%s", hybrid.report().c_str());

  // u = speed - a t + k t^2 / 2 until it is 0; u = k (t - loose)^2 / 2 from then on, when k t exceeds a.
  const double a = friction * g, k = pull / mass, loose = a / k;
  const double rest = (a - std::sqrt(a * a - 2 * k * speed)) / k;
  const double x = speed * rest - a * rest * rest / 2 + k * std::pow(rest, 3) / 6 + k * std::pow(end - loose, 3) / 6;
  std::printf("x(%g) = %.8f m, exactly %.8f\n", end, point.x[0], x);
  return std::fabs(point.x[0] - x) > 1e-6 || std::fabs(hybrid.passage(1).t - loose) > 1e-5;
}
