// Families of sparse problems of any size: a reaction with diffusion, circuits, chains of links and of pendula.
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "ida_sparse.h"
#include "sfdae/expression.hpp"

namespace sfdae_bench {

using sfdae::Expression;

struct SparseProblem {
  std::function<void(const Expression& t, const Expression* x, const Expression* xdot, Expression* F)> record;
  std::vector<double> x0;
  double tf = 0.0;
};

constexpr double pi = 3.14159265358979323846;

// u' = 1 + u^2 v - 4 u + a u_xx, v' = 3 u - u^2 v + a v_xx, a = 1/50, u = 1, v = 3 at both ends, by lines [HW96,
// IV.10].
//
// [HW96] E. Hairer, G. Wanner: Solving Ordinary Differential Equations II. Springer, 2nd ed. 1996.
template <class V>
void brusselator(int cells, const V* x, const V* xdot, V* F) {
  const double a = 0.02 * (cells + 1.0) * (cells + 1.0);
  const V border_u(1.0), border_v(3.0);
  for (int i = 0; i < cells; ++i) {
    const auto at = [&](int k, int which) -> const V& {
      return k < 0 || k >= cells ? (which == 0 ? border_u : border_v) : x[2 * k + which];
    };
    const V &u = x[2 * i], &v = x[2 * i + 1];
    const V square = u * u * v;
    F[2 * i] = xdot[2 * i] - (1.0 + square - 4.0 * u + a * (at(i - 1, 0) - 2.0 * u + at(i + 1, 0)));
    F[2 * i + 1] = xdot[2 * i + 1] - (3.0 * u - square + a * (at(i - 1, 1) - 2.0 * v + at(i + 1, 1)));
  }
}

inline SparseProblem brusselator_problem(int cells) {
  SparseProblem problem;
  problem.record = [cells](const Expression&, const Expression* x, const Expression* xdot, Expression* F) {
    brusselator(cells, x, xdot, F);
  };
  for (int i = 0; i < cells; ++i) {
    problem.x0.push_back(1.0 + std::sin(2.0 * pi * (i + 1) / (cells + 1)));
    problem.x0.push_back(3.0);
  }
  problem.tf = 10.0;
  return problem;
}

inline SparsePeer brusselator_peer(int cells) {
  SparsePeer peer;
  const SparseProblem problem = brusselator_problem(cells);
  peer.x0 = problem.x0;
  peer.tf = problem.tf;
  peer.residual = [cells](double, const double* x, const double* xdot, double* F) { brusselator(cells, x, xdot, F); };
  const std::vector<double> zeros(peer.x0.size());
  peer.xdot0 = zeros;
  peer.residual(0.0, peer.x0.data(), zeros.data(), peer.xdot0.data());
  for (double& slope : peer.xdot0) slope = -slope;
  peer.first.push_back(0);
  for (int j = 0; j < 2 * cells; ++j) {
    if (j >= 2) peer.row.push_back(j - 2);
    peer.row.push_back(j - j % 2);
    peer.row.push_back(j - j % 2 + 1);
    if (j + 2 < 2 * cells) peer.row.push_back(j + 2);
    peer.first.push_back(static_cast<int>(peer.row.size()));
  }
  peer.jacobian = [cells](double c, const double* x, double* values) {
    const double a = 0.02 * (cells + 1.0) * (cells + 1.0);
    for (int j = 0; j < 2 * cells; ++j) {
      const double u = x[j - j % 2], v = x[j - j % 2 + 1];
      const bool by_u = j % 2 == 0;
      if (j >= 2) *values++ = -a;
      *values++ = by_u ? c - 2.0 * u * v + 4.0 + 2.0 * a : -u * u;
      *values++ = by_u ? -3.0 + 2.0 * u * v : c + u * u + 2.0 * a;
      if (j + 2 < 2 * cells) *values++ = -a;
    }
  };
  return peer;
}

// Modified nodal analysis: a source of voltage with a capacitor across (its current is of index 2), sections of an
// inductor, a resistor in line and a capacitor to ground, and at the end an inductor in series with a source of
// current (the voltage between them is of index 2). The time constant R C of the whole line is 1; R^2 = L / C of a
// section. Unknowns: v_0, the current of the source, i, m, v of each section, m between L and R, and i, v of the end.
inline SparseProblem ladder_problem(int sections) {
  SparseProblem problem;
  problem.record = [sections](const Expression& t, const Expression* x, const Expression* xdot, Expression* F) {
    const double R = 1.0 / sections, C = R, L = R * R * C;
    F[0] = x[0] - pow(sin(t), 2);
    const Expression* before = &x[0];
    F[1] = C * xdot[0] + x[2] - x[1];
    for (int k = 0; k < sections; ++k) {
      const Expression *s = x + 2 + 3 * k, *slope = xdot + 2 + 3 * k;
      Expression* f = F + 2 + 3 * k;
      f[0] = L * slope[0] - (*before - s[1]);
      f[1] = R * s[0] - (s[1] - s[2]);
      f[2] = C * slope[2] - (s[0] - s[3]);
      before = &s[2];
    }
    const int end = 2 + 3 * sections;
    F[end] = L * xdot[end] - (*before - x[end + 1]);
    F[end + 1] = x[end] - 0.1 * pow(sin(2.0 * t), 2);
  };
  problem.x0.assign(static_cast<std::size_t>(3 * sections + 4), 0.0);
  problem.tf = 10.0;
  return problem;
}

// Two-stage transistor amplifiers [HW96, VII.1], driven by the same signal and, a little, by the output before:
// more of it would sharpen edges from stage to stage, without end. Nodal equations: three capacitors are between
// nodes that are dynamic unknowns for the structure and not for numbers.
inline void amplifier(const Expression& source, const Expression* x, const Expression* xdot, Expression* F) {
  constexpr double Ub = 6.0, alpha = 0.99, R0 = 1000.0, R = 9000.0;
  const auto diode = [](const Expression& voltage) { return 1e-6 * (exp(voltage / 0.026) - 1.0); };
  const Expression first = diode(x[1] - x[2]), second = diode(x[4] - x[5]);
  const auto capacitor = [&](double C, int from, int to) { return C * (xdot[from] - xdot[to]); };
  F[0] = capacitor(1e-6, 1, 0) + (source - x[0]) / R0;
  F[1] = -capacitor(1e-6, 1, 0) + Ub / R - x[1] * (2.0 / R) - (1.0 - alpha) * first;
  F[2] = -2e-6 * xdot[2] + first - x[2] / R;
  F[3] = capacitor(3e-6, 4, 3) + (Ub - x[3]) / R - alpha * first;
  F[4] = -capacitor(3e-6, 4, 3) + Ub / R - x[4] * (2.0 / R) - (1.0 - alpha) * second;
  F[5] = -4e-6 * xdot[5] + second - x[5] / R;
  F[6] = capacitor(5e-6, 7, 6) + (Ub - x[6]) / R - alpha * second;
  F[7] = -capacitor(5e-6, 7, 6) - x[7] / R;
}

// The same with the currents of these three as unknowns, too (x[8], x[9], x[10]), which structure sees through.
inline void amplifier_with_currents(const Expression& source, const Expression* x, const Expression* xdot,
                                    Expression* F) {
  constexpr double Ub = 6.0, alpha = 0.99, R0 = 1000.0, R = 9000.0;
  const auto diode = [](const Expression& voltage) { return 1e-6 * (exp(voltage / 0.026) - 1.0); };
  const Expression first = diode(x[1] - x[2]), second = diode(x[4] - x[5]);
  F[0] = x[8] + (source - x[0]) / R0;
  F[1] = -x[8] + Ub / R - x[1] * (2.0 / R) - (1.0 - alpha) * first;
  F[2] = -2e-6 * xdot[2] + first - x[2] / R;
  F[3] = x[9] + (Ub - x[3]) / R - alpha * first;
  F[4] = -x[9] + Ub / R - x[4] * (2.0 / R) - (1.0 - alpha) * second;
  F[5] = -4e-6 * xdot[5] + second - x[5] / R;
  F[6] = x[10] + (Ub - x[6]) / R - alpha * second;
  F[7] = -x[10] - x[7] / R;
  F[8] = x[8] - 1e-6 * (xdot[1] - xdot[0]);
  F[9] = x[9] - 3e-6 * (xdot[4] - xdot[3]);
  F[10] = x[10] - 5e-6 * (xdot[7] - xdot[6]);
}

inline SparseProblem amplifiers(int count, int unknowns,
                                void (*one)(const Expression&, const Expression*, const Expression*, Expression*)) {
  SparseProblem problem;
  problem.record = [=](const Expression& t, const Expression* x, const Expression* xdot, Expression* F) {
    const Expression signal = 0.1 * sin(200.0 * pi * t);
    Expression source = signal;
    for (int k = 0; k < count; ++k, x += unknowns, xdot += unknowns, F += unknowns) {
      one(source, x, xdot, F);
      source = signal + 1e-5 * x[7];
    }
  };
  for (int k = 0; k < count; ++k) {
    for (const double value : {0.0, 3.0, 3.0, 6.0, 3.0, 3.0, 6.0, 0.0}) problem.x0.push_back(value);
    problem.x0.resize(problem.x0.size() + static_cast<std::size_t>(unknowns - 8), 0.0);
  }
  problem.tf = 0.05;
  return problem;
}
inline SparseProblem amplifier_problem(int count) { return amplifiers(count, 8, amplifier); }
inline SparseProblem amplifier_problem_with_currents(int count) {
  return amplifiers(count, 11, amplifier_with_currents);
}

// Masses 1/N at the ends of rigid links of length 1/N that hang from the origin, in absolute coordinates; T_k:
// tensions. Unknowns of a link: x, y, their velocities, T. It starts from rest at 0.5 rad from the vertical.
inline SparseProblem link_problem(int links) {
  SparseProblem problem;
  problem.record = [links](const Expression&, const Expression* x, const Expression* xdot, Expression* F) {
    const double N = links;
    const auto direction = [&](int k, int axis) {
      return k == 0 ? N * x[axis] : N * (x[5 * k + axis] - x[5 * k - 5 + axis]);
    };
    for (int k = 0; k < links; ++k) {
      for (int axis = 0; axis < 2; ++axis) {
        Expression force = -(x[5 * k + 4] * direction(k, axis));
        if (k + 1 < links) force = force + x[5 * k + 9] * direction(k + 1, axis);
        F[5 * k + axis] = xdot[5 * k + axis] - x[5 * k + 2 + axis];
        F[5 * k + 2 + axis] = xdot[5 * k + 2 + axis] - N * force + (axis == 1 ? 1.0 : 0.0);
      }
      F[5 * k + 4] = 0.5 * (pow(direction(k, 0), 2) + pow(direction(k, 1), 2) - 1.0);
    }
  };
  for (int k = 1; k <= links; ++k)
    for (const double value :
         {std::sin(0.5) * k / links, -std::cos(0.5) * k / links, 0.0, 0.0, std::cos(0.5) * (links - k + 1.0) / links})
      problem.x0.push_back(value);
  problem.tf = 1.0;
  return problem;
}

// Pendula, the tension of each of which is what the next one's length depends on: index 2 P + 1. Unknowns of one: x,
// y, u, v, l. The first starts from the horizontal; the values of the others are found near the same.
inline SparseProblem pendula_problem(int pendula) {
  SparseProblem problem;
  problem.record = [pendula](const Expression&, const Expression* x, const Expression* xdot, Expression* F) {
    for (int k = 0; k < pendula; ++k, x += 5, xdot += 5, F += 5) {
      F[0] = xdot[0] - x[2];
      F[1] = xdot[1] - x[3];
      F[2] = xdot[2] + x[4] * x[0];
      F[3] = xdot[3] + x[4] * x[1] + 1.0;
      const Expression radius = k == 0 ? Expression(1.0) : 1.0 + 0.1 * x[-1];
      F[4] = x[0] * x[0] + x[1] * x[1] - radius * radius;
    }
  };
  for (int k = 0; k < pendula; ++k)
    for (const double value : {1.0, 0.0, 0.0, 0.0, 0.0}) problem.x0.push_back(value);
  problem.tf = 10.0;
  return problem;
}

}  // namespace sfdae_bench
