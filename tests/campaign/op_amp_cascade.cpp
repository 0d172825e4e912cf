// SPDX-License-Identifier: BSD-3-Clause
#include "op_amp_cascade.h"

#include <complex>

namespace campaign {

namespace {

constexpr int v0 = 0, i0 = 1;
int g(int stage) { return 3 * stage - 1; }
int o(int stage) { return 3 * stage; }
int i(int stage) { return 3 * stage + 1; }
int input(int stage) { return stage == 1 ? v0 : o(stage - 1); }

}  // namespace

LinearProblem op_amp_problem(const OpAmpCascade& cascade) {
  const int k = cascade.stages, n = 2 + 3 * k;
  LinearProblem problem;
  problem.m = problem.n = n;
  problem.values = cascade.ideal ? CharacteristicValues{k, 0, n, 0, 0} : CharacteristicValues{0, k, n - k, 0, 0};
  problem.units = Units(n, n);
  problem.constant = true;
  problem.coefficients = [cascade](double, int, TaylorMatrix& E, TaylorMatrix& A) {
    A(0, v0)[0] = -1.0;
    E(1, v0)[0] = 1.0;
    E(1, g(1))[0] = -1.0;
    A(1, i0)[0] = -1.0;
    for (int stage = 1; stage <= cascade.stages; ++stage) {
      const int row = 3 * stage - 1;
      E(row, g(stage))[0] = 1.0;
      E(row, input(stage))[0] = -1.0;
      A(row, g(stage))[0] = -1.0;
      A(row, o(stage))[0] = 1.0;
      A(row + 1, g(stage))[0] = 1.0;
      if (!cascade.ideal) A(row + 1, o(stage))[0] = 1.0 / cascade.gain;
      A(row + 2, o(stage))[0] = -1.0;
      A(row + 2, g(stage))[0] = 1.0;
      A(row + 2, i(stage))[0] = -1.0;
      if (stage == cascade.stages) continue;
      E(row + 2, o(stage))[0] = 1.0;
      E(row + 2, g(stage + 1))[0] = -1.0;
    }
  };
  problem.inhomogeneity = [](double t, int, std::vector<TaylorSeries>& f) { f[0] = sine(1.0, 1.0, 0.0, t); };
  return problem;
}

// x = Im(X exp(i t)): derivatives are products with i.
std::vector<double> op_amp_solution(const OpAmpCascade& cascade, double t) {
  using namespace std::complex_literals;
  const int n = 2 + 3 * cascade.stages;
  const double inverse_gain = cascade.ideal ? 0.0 : 1.0 / cascade.gain;
  std::vector<std::complex<double>> X(static_cast<std::size_t>(n));
  const auto at = [&X](int j) -> std::complex<double>& { return X[static_cast<std::size_t>(j)]; };
  at(v0) = 1.0;
  for (int stage = 1; stage <= cascade.stages; ++stage) {
    at(o(stage)) = -1i * at(input(stage)) / (1.0 + (1.0 + 1i) * inverse_gain);
    at(g(stage)) = -at(o(stage)) * inverse_gain;
  }
  at(i0) = 1i * (at(g(1)) - at(v0));
  for (int stage = 1; stage <= cascade.stages; ++stage) {
    at(i(stage)) = at(g(stage)) - at(o(stage));
    if (stage < cascade.stages) at(i(stage)) -= 1i * (at(o(stage)) - at(g(stage + 1)));
  }
  std::vector<double> x;
  for (const std::complex<double>& amplitude : X) x.push_back((amplitude * std::exp(1i * t)).imag());
  return x;
}

}  // namespace campaign
