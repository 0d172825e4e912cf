// SPDX-License-Identifier: BSD-3-Clause
//
// Sensitivities of random linear hybrid systems that are known piece by piece. The modes are those of
// weierstrass_modes.h with a parameter p in all their parts, the consistency projector as well:
//
//     x = Q (I + p u v^T) (y1, y2),  y1_i' = (1 + p/2) lambda_i y1_i + (1 + p/3) g1_i,  N y2' = y2 + (1 + p/3) g2
//
// They follow one another at zeros of  t - t_k + weight sin(c x),  which pass with rates of about 1.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sfdae/hybrid.hpp"
#include "solver_options.h"
#include "weierstrass_solvers.h"

namespace {

using sfdae::Expression;
using sfdae_test::Mode;
using sfdae_test::Random;
using sfdae_test::Values;

constexpr double p_in_use = 0.2;

double product(const Values& a, const Values& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

class ModeWithParameter {
 public:
  ModeWithParameter(Random& random, const Mode& mode)
      : mode_(mode), u_(random.reals(mode.n(), -0.4, 0.4)), v_(random.reals(mode.n(), -0.4, 0.4)) {}

  int n() const { return mode_.n(); }
  int mu() const { return mode_.mu; }
  // The solution with y1 given at `start`, by those of a mode with other numbers.
  Values solution(double p, double t, double start, const Values& y1) const {
    const Mode mode = at(p);
    return from_coordinates(p, mode.Q.inverse * mode.solution(t, start, y1));
  }
  Values differential_part(double p, const Values& x) const {
    Values y = mode_.Q.inverse * x;
    const double along = p * product(v_, y) / (1.0 + p * product(v_, u_));
    for (std::size_t i = 0; i < y.size(); ++i) y[i] -= along * u_[i];
    y.resize(static_cast<std::size_t>(mode_.d));
    return y;
  }
  sfdae::NonlinearProblem problem() const {
    sfdae::NonlinearProblem problem(n(), n());
    problem.equations = [this](const Expression& t, auto x, auto xdot, auto F) {
      const Expression p = sfdae::parameter(t, "p", p_in_use);
      std::vector<Expression> values, slopes, residual;
      for (int i = 0; i < n(); ++i) values.push_back(x[i]), slopes.push_back(xdot[i]);
      const std::vector<Expression> y = in_coordinates(p, values), ydot = in_coordinates(p, slopes);
      for (int i = 0; i < n(); ++i) {
        const auto& wave = mode_.waves[std::size_t(i)];
        const Expression g = (1.0 + p / 3.0) * (wave.c * cos(wave.w * t + wave.p));
        if (i < mode_.d) {
          residual.push_back(ydot[std::size_t(i)] -
                             (1.0 + 0.5 * p) * mode_.lambda[std::size_t(i)] * y[std::size_t(i)] - g);
          continue;
        }
        Expression row = -y[std::size_t(i)] - g;
        for (int j = 0; j < mode_.a; ++j)
          if (mode_.N(i - mode_.d, j) != 0.0) row = row + mode_.N(i - mode_.d, j) * ydot[std::size_t(mode_.d + j)];
        residual.push_back(row);
      }
      for (int i = 0; i < n(); ++i) {
        F[i] = 0.0 * t;
        for (int j = 0; j < n(); ++j) F[i] = F[i] + mode_.P.inverse(i, j) * residual[std::size_t(j)];
      }
    };
    return problem;
  }

 private:
  Mode at(double p) const {
    Mode mode = mode_;
    for (double& lambda : mode.lambda) lambda *= 1.0 + 0.5 * p;
    for (auto& wave : mode.waves) wave.c *= 1.0 + p / 3.0;
    return mode;
  }
  Values from_coordinates(double p, Values y) const {
    const double along = p * product(v_, y);
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += along * u_[i];
    return mode_.Q.matrix * y;
  }
  std::vector<Expression> in_coordinates(const Expression& p, const std::vector<Expression>& x) const {
    std::vector<Expression> y;
    Expression along = 0.0 * p;
    for (int i = 0; i < n(); ++i) {
      Expression sum = 0.0 * p;
      for (int j = 0; j < n(); ++j) sum = sum + mode_.Q.inverse(i, j) * x[std::size_t(j)];
      along = along + v_[std::size_t(i)] * sum;
      y.push_back(sum);
    }
    const Expression factor = p / (1.0 + p * product(v_, u_)) * along;
    for (int i = 0; i < n(); ++i) y[std::size_t(i)] = y[std::size_t(i)] - factor * u_[std::size_t(i)];
    return y;
  }

  Mode mode_;
  Values u_, v_;
};

constexpr std::array<double, 3> changes = {0.3, 0.55, 0.8};

class RandomHybrid {
 public:
  explicit RandomHybrid(Random& random) {
    for (const Mode& mode : sfdae_test::random_modes(random)) modes.emplace_back(random, mode);
    c = random.reals(modes[0].n(), -1.0, 1.0);
    y_at_start.assign(modes[0].differential_part(0.0, Values(c.size(), 0.0)).size(), 0.0);
    for (std::size_t i = 0; i < y_at_start.size(); ++i) y_at_start[i] = std::cos(1.0 + static_cast<double>(i));
    limit_weight();
  }
  // x at t and the times of the transitions before.
  Values exact(double p, double t, Values* times = nullptr) const {
    Values y = y_at_start;
    double start = 0.0;
    for (std::size_t k = 0;; ++k) {
      const ModeWithParameter& mode = modes[k % 2];
      const double end = k < changes.size() ? time_of_change(k, p, start, y) : 2.0;
      if (t < end) return mode.solution(p, t, start, y);
      if (times != nullptr) times->push_back(end);
      y = modes[(k + 1) % 2].differential_part(p, mode.solution(p, end, start, y));
      start = end;
    }
  }
  double function(std::size_t k, double t, const double* x) const {
    double along = 0.0;
    for (std::size_t i = 0; i < c.size(); ++i) along += c[i] * x[i];
    return t - changes[k] + weight * std::sin(along);
  }

  std::vector<ModeWithParameter> modes;
  Values c, y_at_start;
  double weight = 0.0;

 private:
  double time_of_change(std::size_t k, double p, double start, const Values& y) const {
    double t = changes[k];
    for (int iteration = 0; iteration < 18; ++iteration) {  // which contract by 0.1
      const Values x = modes[k % 2].solution(p, t, start, y);
      t -= function(k, t, x.data());
    }
    return t;
  }
  // The part of x in the function changes it by some 0.1 of t, and by 0.05 in all.
  void limit_weight() {
    constexpr double step = 1e-3;
    double fastest = 0.0;
    weight = 0.05;
    for (double t = 0.0; t < 1.0; t += 50.0 * step) {
      const Values here = exact(p_in_use, t), next = exact(p_in_use, t + step);
      fastest = std::max(fastest, std::fabs(product(c, next) - product(c, here)) / step);
    }
    weight = std::min(weight, 0.1 / std::max(fastest, 1e-3));
  }
};

// Of the closed form, by differences of fourth order.
Values derivative(const std::function<Values(double)>& value) {
  constexpr double step = 1e-3;
  const Values a = value(p_in_use + step), b = value(p_in_use - step), c = value(p_in_use + 2.0 * step),
               d = value(p_in_use - 2.0 * step);
  Values result;
  for (std::size_t i = 0; i < a.size(); ++i) result.push_back((8.0 * (a[i] - b[i]) - (c[i] - d[i])) / (12.0 * step));
  return result;
}

// Errors relative to the largest derivative, or to 1, in tolerances.
double error_of(const Values& found, const Values& exact, double tolerance) {
  double size = 1.0, error = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    size = std::max(size, std::fabs(exact[i]));
    error = std::max(error, std::fabs(found[i] - exact[i]));
  }
  return error / (size * tolerance);
}

// Solvers of the modes and the hybrid system, destroyed first.
struct Solved {
  std::vector<std::unique_ptr<sfdae::Solver>> solvers;
  sfdae::Hybrid hybrid;
  Solved(const RandomHybrid& system, const sfdae::Options& options) {
    for (const ModeWithParameter& mode : system.modes) {
      solvers.push_back(std::make_unique<sfdae::Solver>(mode.problem(), options));
      hybrid.add_mode(*solvers.back());
    }
    for (std::size_t k = 0; k < changes.size(); ++k) {
      sfdae::Transition transition;
      transition.from = k % 2;
      transition.to = 1 - k % 2;
      transition.kind = SFDAE_TRANSITION_ZERO;
      transition.direction = 1;
      transition.function = [&system, k](double t, auto x, auto) { return system.function(k, t, x.data()); };
      hybrid.add_transition(transition);
    }
  }
};

sfdae_test::Outcome run(const RandomHybrid& system, int method, double tolerance) {
  sfdae_test::Outcome outcome;
  Solved solved(system, sfdae_test::solver_options(tolerance, method));
  sfdae::Hybrid& hybrid = solved.hybrid;
  const auto at = [&](double t) { return [&system, t](double p) { return system.exact(p, t); }; };
  sfdae::Sensitivities wanted;
  wanted.parameters = {"p"};
  wanted.directions = sfdae::Matrix(system.modes[0].n(), 1);
  const Values at_start = derivative(at(0.0));
  std::copy(at_start.begin(), at_start.end(), wanted.directions.data());
  try {
    hybrid.set_sensitivities(wanted);
    sfdae::Point point{0.0, system.exact(p_in_use, 0.0), {}};
    hybrid.start(0, point, 1.0);
    for (double t : {0.2, 0.42, 0.68, 1.0}) {
      hybrid.advance(t, point);
      const sfdae::Matrix S = hybrid.sensitivities(t, false).S;
      const Values found(S.data(), S.data() + S.rows());
      outcome.error = std::max(outcome.error, error_of(found, derivative(at(t)), tolerance));
      if (hybrid.num_passages() == 0) continue;
      const Values dt = derivative([&](double p) {
        Values times;
        system.exact(p, t, &times);
        return Values{times.back()};
      });
      outcome.error = std::max(outcome.error, error_of(hybrid.passage_sensitivities(), dt, tolerance));
    }
    EXPECT_EQ(hybrid.num_passages(), 3);
  } catch (const sfdae::Error& error) {
    outcome.status = error.status();
    outcome.message = error.what();
  }
  return outcome;
}

class RandomHybridSensitivities : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Methods, RandomHybridSensitivities, ::testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

// 500 systems, at two tolerances. Measured: 0.8 and 3.3 tolerances at most with BDF, 0.007 and 0.11 with Radau.
TEST_P(RandomHybridSensitivities, AreThoseOfTheClosedForm) {
  constexpr double allowed = 10.0;
  for (double tolerance : {1e-6, 1e-9}) {
    Random random(71);
    sfdae_test::Tally tally;
    const int count = sfdae_test::scaled(500);
    for (int k = 0; k < count; ++k) {
      const RandomHybrid system(random);
      const sfdae_test::Outcome outcome = run(system, GetParam(), tolerance);
      if (outcome.status < 0 || outcome.error > allowed)
        std::printf("%d: mu %d, %d; error %.3g %s\n", k, system.modes[0].mu(), system.modes[1].mu(), outcome.error,
                    outcome.message.c_str());
      tally.add(outcome, allowed);
    }
    std::printf("tolerance %.0e, ", tolerance);
    tally.print(GetParam() == SFDAE_METHOD_BDF ? "BDF" : "Radau");
    EXPECT_EQ(tally.wrong, 0);
    EXPECT_GE(tally.right, count - count / 50);
  }
}

// ---- Gradients ---------------------------------------------------------------------------------------------------

// By p and the start values of all differential parts, of two functionals at the end; forward by S.
Values gradient(const RandomHybrid& system, const sfdae::Options& options, bool by_adjoint, Random random) {
  const int n = system.modes[0].n();
  Solved solved(system, options);
  sfdae::Hybrid& hybrid = solved.hybrid;
  sfdae::Sensitivities wanted;
  wanted.parameters = {"p", "", ""};
  wanted.directions = sfdae::Matrix(n, 3);
  const Values directions = random.reals(3 * n, -1.0, 1.0), some = random.reals(2 * n, -1.0, 1.0);
  std::copy(directions.begin(), directions.end(), wanted.directions.data());
  sfdae::Matrix weights(n, 2);
  std::copy(some.begin(), some.end(), weights.data());
  wanted.adjoint = by_adjoint;
  hybrid.set_sensitivities(wanted);
  sfdae::Point point{0.0, system.exact(p_in_use, 0.0), {}};
  hybrid.start(0, point, 1.0);
  hybrid.advance(1.0, point);
  EXPECT_EQ(hybrid.num_passages(), 3);
  Values found;
  const sfdae::Matrix result = by_adjoint ? hybrid.gradient({1.0}, weights) : hybrid.sensitivities(1.0, false).S;
  for (int q = 0; q < 2; ++q)
    for (int j = 0; j < 3; ++j) {
      double sum = by_adjoint ? result(j, q) : 0.0;
      for (int i = 0; i < n && !by_adjoint; ++i) sum += weights(i, q) * result(i, j);
      found.push_back(sum);
    }
  return found;
}

// The same steps: they end at the end of the run, and BDF takes its states from the array. Measured: 2e-11 at most.
TEST_P(RandomHybridSensitivities, AreThoseOfGradients) {
  constexpr double agreement = 1e-10;
  sfdae::Options options = sfdae_test::solver_options(1e-7, GetParam());
  options.structure = SFDAE_STRUCTURE_OFF;
  options.use_stop_time = 1;
  options.stop_time = 1.0;
  Random random(77);
  double largest = 0.0;
  const int count = sfdae_test::scaled(110);
  for (int k = 0; k < count; ++k) {
    const RandomHybrid system(random);
    const Values forward = gradient(system, options, false, random),
                 adjoint = gradient(system, options, true, random);
    const double error = error_of(adjoint, forward, 1.0);
    EXPECT_LE(error, agreement) << k << ": mu " << system.modes[0].mu() << ", " << system.modes[1].mu();
    largest = std::max(largest, error);
  }
  std::printf("largest difference of the gradient and W^T S %.2g\n", largest);
}

}  // namespace
