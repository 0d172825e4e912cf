// SPDX-License-Identifier: BSD-3-Clause
//
// A room with a thermostat: the heating q is switched off when the temperature has risen to 22 and on when it has
// fallen to 20.
//
//     T' = -k (T - 5) + q,   0 = q - (on ? p : 0)         strangeness index 0, d = 1, a = 1
//
// Events: T - 22 rising, T - 20 falling. Check: from T = 20, heated, T approaches 5 + p / k exponentially, else 5, so
// that heating takes log((p / k - 15) / (p / k - 17)) / k, and cooling log(17 / 15) / k.

#include <algorithm>
#include <cmath>
#include <iostream>

#include <sfdae/sfdae.hpp>

int main() try {
  constexpr double k = 0.5, p = 12, tend = 10;
  bool on = true;
  sfdae::LinearProblem problem(2, 2);
  problem.E = [](double, int, sfdae::MatrixRef E) { E(0, 0) = 1; };
  problem.A = [](double, int, sfdae::MatrixRef A) { A(0, 0) = -k, A(0, 1) = 1, A(1, 1) = 1; };
  problem.f = [&on](double, int order, sfdae::VectorRef f) {
    if (order == 0) f[0] = 5 * k, f[1] = on ? -p : 0;
  };
  problem.constant_E = problem.constant_A = true;

  sfdae::Options options;
  options.rtol = options.atol = 1e-9;
  sfdae::Solver solver(problem, options);
  solver.set_events(2,
                    [](double, sfdae::ConstVectorRef x, sfdae::ConstVectorRef, sfdae::VectorRef g) {
                      g[0] = x[0] - 22;
                      g[1] = x[0] - 20;
                    },
                    {+1, -1});

  sfdae::Point point{0.0, {20.0, p}, {}};
  solver.start(point, tend);
  const double heating = std::log((p / k - 15) / (p / k - 17)) / k, cooling = std::log(17.0 / 15.0) / k;
  double expected = heating, error = 0;
  int switches = 0;
  while (solver.advance(tend, point) == SFDAE_EVENT) {
    on = solver.events()[0] == 0;
    std::cout << "t = " << point.t << ": T = " << point.x[0] << ", heating " << (on ? "on" : "off") << '\n';
    error = std::max(error, std::abs(point.t - expected));
    expected += on ? heating : cooling;
    ++switches;
    solver.start(point, tend);  // with the new q
  }
  const int cycles = static_cast<int>(tend / (heating + cooling));
  const int exact = 2 * cycles + (tend - cycles * (heating + cooling) >= heating ? 1 : 0);
  std::cout << switches << " switches, error of their times " << error << '\n';
  return !(switches == exact && error <= 1e-6 && point.t == tend);
} catch (const sfdae::Error& error) {
  std::cerr << sfdae::status_name(error.status()) << ": " << error.what() << '\n';
  return 1;
}
