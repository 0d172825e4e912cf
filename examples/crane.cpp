// SPDX-License-Identifier: BSD-3-Clause
// A crane: a trolley of mass M at s, pushed by a force u, and a load of mass m at (p, q) on a rope of length l.
//
//     s' = a, p' = b, q' = c,   M a' = u + (p - s) r,   m b' = -(p - s) r,   m c' = -q r - m g,   (p - s)^2 + q^2 = l^2
//
// r is the force of the rope by its length. Strangeness index 2, at rest with the load hanging below: what of u
// becomes s?
//
//     s / u = (s^2 + g / l) / (M s^2 (s^2 + (1 + m / M) g / l)):   poles 0, 0, +-i w1,   zeros +-i w0
#include <sfdae/sfdae.hpp>

#include <cmath>
#include <complex>
#include <cstdio>

int main() {
  const double M = 5000, m = 10000, l = 20, g = 9.81;  // kg, m, m / s^2
  sfdae::NonlinearProblem problem(7, 7);
  problem.equations = [&](const auto& t, auto x, auto xdot, auto F) {
    const sfdae::Expression u = sfdae::parameter(t, "u", 0.0), across = x[1] - x[0], r = x[6];
    for (int i = 0; i < 3; ++i) F[i] = xdot[i] - x[3 + i];
    F[3] = M * xdot[3] - u - across * r;
    F[4] = m * xdot[4] + across * r;
    F[5] = m * xdot[5] + x[2] * r + m * g;
    F[6] = across * across + x[2] * x[2] - l * l;
  };
  sfdae::Solver solver(problem);
  sfdae::Point at_rest{0.0, {0, 0, -l, 0, 0, 0, m * g / l}, {}};
  solver.start(at_rest, 1.0);

  sfdae::Linearization choice;
  choice.input_parameters = {"u"};
  choice.output_unknowns = {0};
  sfdae::Descriptor descriptor = solver.linearize(choice);

  const double w0 = std::sqrt(g / l), w1 = std::sqrt((1 + m / M) * g / l);
  const sfdae::Spectrum poles = descriptor.poles(), zeros = descriptor.zeros();
  std::printf("mu = %d, %d poles, %d at infinity\n", poles.summary.strangeness_index, poles.summary.num_finite,
              poles.summary.num_infinite);
  for (const auto& pole : poles.values) std::printf("  pole  %+.6f %+.6f i\n", pole.real(), pole.imag());
  for (const auto& zero : zeros.values) std::printf("  zero  %+.6f %+.6f i\n", zero.real(), zero.imag());
  const std::complex<double> s(0.0, 0.1), ss = s * s, H = descriptor.transfer(s)[0];
  std::printf("a force of 1 kN with 0.1 rad / s moves the trolley by %.4f m\n", 1000 * std::abs(H));

  bool right = poles.values.size() == 4 && zeros.values.size() == 2;
  right = right && std::abs(poles.values[2] - std::complex<double>(0, w1)) < 1e-12 * w1;
  right = right && std::abs(poles.values[1]) < 1e-6;  // a double pole: the square root of rounding errors
  right = right && std::abs(zeros.values[0] - std::complex<double>(0, w0)) < 1e-12 * w0;
  right = right && std::abs(H - (ss + w0 * w0) / (M * ss * (ss + w1 * w1))) < 1e-12 * std::abs(H);
  std::printf("%s\n", right ? "as by hand" : "WRONG");
  return right ? 0 : 1;
}
