// SPDX-License-Identifier: BSD-3-Clause
//
// Two modes with a switch between them, whose sensitivities, or gradients of all unknowns by the adjoint, are
// compared with formulas.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sfdae/hybrid.hpp"
#include "solver_options.h"

namespace sfdae_test {

using sfdae::Expression;
using Values = std::vector<double>;
using Equations = std::function<void(const Expression& t, sfdae::ConstExpressions x, sfdae::ConstExpressions xdot,
                                     sfdae::Expressions F)>;
using Formula = std::function<Values(double t, const Values& p)>;

// By p[j], of fourth order.
inline Values derivative(const Formula& formula, double t, const Values& p, std::size_t j) {
  const double step = 1e-3 * (1.0 + std::fabs(p[j]));
  const auto moved = [&](double by) {
    Values values(p);
    values[j] += by * step;
    return formula(t, values);
  };
  const Values a = moved(1), b = moved(-1), c = moved(2), d = moved(-2);
  Values result;
  for (std::size_t i = 0; i < a.size(); ++i) result.push_back((8 * (a[i] - b[i]) - (c[i] - d[i])) / (12 * step));
  return result;
}

// Two modes, 0 below and 1 above, and 2 along the surface.
struct SlidingSystem {
  SlidingSystem(int n, const std::function<Equations(int above)>& equations, const sfdae::SurfaceFunction& surface,
                const sfdae::Options& options, bool wants_gradients = false)
      : by_adjoint(wants_gradients) {
    for (int above : {0, 1}) {
      sfdae::NonlinearProblem problem(n, n);
      problem.equations = [each = equations(above)](const auto& t, auto x, auto xdot, auto F) {
        each(t, x, xdot, F);
      };
      solvers.push_back(std::make_unique<sfdae::Solver>(problem, options));
      hybrid.add_mode(*solvers.back(), above == 1 ? "above" : "below");
    }
    EXPECT_EQ(hybrid.add_switch(0, 1, surface, "along"), 2);
  }
  // unknowns[j]: the one whose start value column j is the derivative by; -1: none.
  void ask(const std::vector<std::string>& names, const std::vector<int>& unknowns = {}) {
    sfdae::Sensitivities wanted;
    wanted.parameters = names;
    wanted.adjoint = by_adjoint;
    if (!unknowns.empty()) {
      wanted.directions = sfdae::Matrix(static_cast<int>(point.x.size()), static_cast<int>(names.size()));
      for (std::size_t j = 0; j < names.size(); ++j)
        if (unknowns[j] >= 0) wanted.directions(unknowns[j], static_cast<int>(j)) = 1.0;
    }
    hybrid.set_sensitivities(wanted);
  }
  void start(int mode, double toward) { hybrid.start(mode, point, toward); }
  std::string modes() const {
    std::string text;
    for (long k = 0; k < hybrid.num_passages(); ++k) text += std::to_string(hybrid.passage(k).to);
    return text;
  }
  // At t: S of x as far as the formula has it.
  void compare(double t, const Values& p, const Formula& formula, double allowed) {
    if (point.t != t) hybrid.advance(t, point);
    const Values x = formula(t, p);
    const sfdae::Matrix S = by_adjoint ? gradients(t) : hybrid.sensitivities(t).S;
    ASSERT_EQ(S.rows(), static_cast<int>(point.x.size()));
    for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(point.x[i], x[i], allowed) << "x" << i << " at " << t;
    for (std::size_t j = 0; j < p.size(); ++j) {
      const Values exact = derivative(formula, t, p, j);
      for (std::size_t i = 0; i < x.size(); ++i)
        EXPECT_NEAR(S(static_cast<int>(i), static_cast<int>(j)), exact[i], allowed)
            << "x" << i << " by parameter " << j << " at " << t;
    }
  }
  // S at t, one gradient for each unknown.
  sfdae::Matrix gradients(double t) {
    const int n = static_cast<int>(point.x.size());
    sfdae::Matrix weights(n, n);
    for (int i = 0; i < n; ++i) weights(i, i) = 1.0;
    const sfdae::Matrix found = hybrid.gradient({t}, weights);
    sfdae::Matrix S(n, found.rows());
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < S.columns(); ++j) S(i, j) = found(j, i);
    return S;
  }
  // The last transition, and forward its dt/dp.
  void compare_time(const Values& p, const std::function<double(const Values&)>& time, double allowed) {
    const Formula formula = [&](double, const Values& values) { return Values{time(values)}; };
    EXPECT_NEAR(hybrid.passage(hybrid.num_passages() - 1).t, time(p), allowed);
    if (by_adjoint) return;
    const Values found = hybrid.passage_sensitivities();
    for (std::size_t j = 0; j < p.size(); ++j)
      EXPECT_NEAR(found[j], derivative(formula, 0.0, p, j)[0], allowed) << "time by parameter " << j;
  }
  bool by_adjoint;
  std::vector<std::unique_ptr<sfdae::Solver>> solvers;
  sfdae::Hybrid hybrid;
  sfdae::Point point;
};

}  // namespace sfdae_test
