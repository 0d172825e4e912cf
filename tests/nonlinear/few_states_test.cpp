// SPDX-License-Identifier: BSD-3-Clause
// Radau on raw equations with few states, whose stages are linearized one by one: random systems like those of
// mechanics with known solutions, in any order of equations and unknowns.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <random>
#include <vector>

#include "checkpoint_of.h"
#include "family_run.h"
#include "nonlinear_run.h"
#include "sparse_run.h"
#include "test_set/andrews.h"

namespace sfdae_test {

namespace {

// What a system has beside M(q) v' = f + C^T lambda, 0 = g(q, t).
enum class Oddity {
  none,
  other_force_directions,
  velocities_in_constraints,
  squares_of_forces,
  masses_by_forces,
  count
};

// x = (q, v, [w,] lambda), each equation minus what it is at the exact solution.
class Mechanism {
 public:
  Mechanism(unsigned seed, Oddity oddity) : generator_(seed), oddity_(oddity) {
    np_ = 3 + static_cast<int>(seed % 4);
    nl_ = np_ - 1 - static_cast<int>(seed / 4 % 2);
    has_accelerations_ = seed % 3 != 0;
    for (std::vector<double>* v : {&a_, &b_, &phase_})
      for (int i = 0; i < np_ + nl_; ++i) v->push_back(uniform());
    for (std::vector<double>* v : {&A_, &B_, &C_})
      for (int i = 0; i < np_ * nl_; ++i) v->push_back(uniform());
    // Independent constraints.
    for (int k = 0; k < nl_; ++k) A_[static_cast<std::size_t>(k * np_ + k)] += 4.0;
    for (int i = 0; i < n(); ++i) factors_.push_back(std::exp(4.0 * uniform()));
    for (std::vector<int>* order : {&place_of_equation_, &place_of_unknown_}) {
      order->resize(static_cast<std::size_t>(n()));
      std::iota(order->begin(), order->end(), 0);
      std::shuffle(order->begin(), order->end(), generator_);
    }
    sign_ = uniform() < 0.0 ? -1.0 : 1.0;
  }

  int n() const { return (has_accelerations_ ? 3 : 2) * np_ + nl_; }

  std::vector<double> exact(double t) const {
    std::vector<double> natural = solution(t, [](double y) { return std::sin(y); });
    if (!has_accelerations_) natural.erase(natural.begin() + 2 * np_, natural.begin() + 3 * np_);
    std::vector<double> x(natural.size());
    for (std::size_t j = 0; j < x.size(); ++j) x[static_cast<std::size_t>(place_of_unknown_[j])] = natural[j];
    return x;
  }

  void write(const Expression& t, const Expression* x, const Expression* xdot, Expression* F) const {
    const auto np = static_cast<std::size_t>(np_);
    const auto at = [this](const Expression* from, std::size_t j) { return from[place_of_unknown_[j]]; };
    std::vector<Expression> z, residuals;
    for (std::size_t j = 0; j < 2 * np; ++j) z.push_back(at(x, j));
    for (std::size_t i = 0; i < np; ++i) z.push_back(has_accelerations_ ? at(x, 2 * np + i) : at(xdot, np + i));
    for (std::size_t k = 0; k < static_cast<std::size_t>(nl_); ++k)
      z.push_back(at(x, (has_accelerations_ ? 3 : 2) * np + k));
    for (std::size_t j = 0; j < (has_accelerations_ ? 2 : 1) * np; ++j) residuals.push_back(at(xdot, j) - z[np + j]);
    const std::vector<Expression> known = solution(t, [](const Expression& y) { return sin(y); });
    const std::vector<Expression> here = terms(z), there = terms(known);
    for (std::size_t i = 0; i < here.size(); ++i) residuals.push_back(here[i] - there[i]);
    for (std::size_t i = 0; i < residuals.size(); ++i) F[place_of_equation_[i]] = residuals[i] * factors_[i];
  }

 private:
  double uniform() { return std::uniform_real_distribution<double>(-1.0, 1.0)(generator_); }
  double entry(const std::vector<double>& M, int k, int i) const { return M[static_cast<std::size_t>(k * np_ + i)]; }

  // (q, v, w, lambda); cosines are sines, as derivatives of sines.
  template <class V, class Sine>
  std::vector<V> solution(const V& t, Sine sine) const {
    constexpr double quarter = 1.5707963267948966;
    std::vector<V> z;
    for (int order = 0; order < 3; ++order)
      for (std::size_t i = 0; i < static_cast<std::size_t>(np_); ++i) {
        const double omega = 1.0 + b_[i] * b_[i];
        const V wave = 0.5 * std::pow(omega, order) * sine(omega * t + (phase_[i] + order * quarter));
        z.push_back(order == 0 ? a_[i] + wave : wave);
      }
    for (std::size_t k = static_cast<std::size_t>(np_); k < a_.size(); ++k)
      z.push_back(1.5 + a_[k] * sine(b_[k] * t + phase_[k]));
    return z;
  }

  // Balances, then constraints.
  std::vector<Expression> terms(const std::vector<Expression>& z) const {
    const Expression *q = z.data(), *v = q + np_, *w = v + np_, *l = w + np_;
    std::vector<Expression> result;
    for (int i = 0; i < np_; ++i) {
      Expression sum = (2.0 + 0.3 * sin(q[0] + q[i])) * w[i] + 0.2 * cos(q[0] - q[i]) * w[(i + 1) % np_] + v[i] +
                       0.3 * v[0] * v[i] + sin(q[i]);
      for (int k = 0; k < nl_; ++k) sum = sum + sign_ * force_direction(q, k, i) * l[k];
      if (oddity_ == Oddity::squares_of_forces) sum = sum + 0.05 * l[0] * l[0];
      if (oddity_ == Oddity::masses_by_forces) sum = sum + 0.05 * l[nl_ - 1] * w[i];
      result.push_back(sum);
    }
    for (int k = 0; k < nl_; ++k) {
      Expression linear = entry(A_, k, 0) * q[0], angle = entry(B_, k, 0) * q[0];
      for (int i = 1; i < np_; ++i) {
        linear = linear + entry(A_, k, i) * q[i];
        angle = angle + entry(B_, k, i) * q[i];
      }
      Expression g = linear + 0.5 * sin(angle);
      if (oddity_ == Oddity::velocities_in_constraints && k == 0) g = A_[0] * v[0] + 0.3 * q[0] * v[np_ - 1];
      result.push_back(g);
    }
    return result;
  }

  // d g_k / d q_i, but for an oddity.
  Expression force_direction(const Expression* q, int k, int i) const {
    Expression angle = entry(B_, k, 0) * q[0];
    for (int j = 1; j < np_; ++j) angle = angle + entry(B_, k, j) * q[j];
    const Expression direction = entry(A_, k, i) + 0.5 * entry(B_, k, i) * cos(angle);
    return oddity_ == Oddity::other_force_directions ? direction + 0.3 * entry(C_, k, i) : direction;
  }

  std::mt19937 generator_;
  Oddity oddity_;
  int np_, nl_;
  bool has_accelerations_;
  double sign_ = 1.0;
  std::vector<double> a_, b_, phase_, A_, B_, C_, factors_;
  std::vector<int> place_of_equation_, place_of_unknown_;
};

NonlinearEquations equations_of(const Mechanism& system) {
  return {system.n(), system.n(),
          [&system](sfdae_record*, const Expression& t, const Expression* x, const Expression* xdot, Expression* F) {
            system.write(t, x, xdot, F);
          }};
}

sfdae_options by_structure(double tolerance, int method = SFDAE_METHOD_RADAU) {
  sfdae_options options = options_with(tolerance, method);
  options.structure = SFDAE_STRUCTURE_REQUIRED;
  return options;
}

void andrews_equations(sfdae_record*, const Expression& t, const Expression* x, const Expression* xdot,
                       Expression* F) {
  andrews_residual(t, x, xdot, F);
}

}  // namespace

TEST(FewStates, SolutionsAreThoseKnown) {
  const int count = scaled_count(400);
  int solved = 0, one_by_one = 0;
  for (int trial = 0; trial < count; ++trial) {
    const auto oddity = static_cast<Oddity>(trial % static_cast<int>(Oddity::count));
    const Mechanism system(static_cast<unsigned>(trial + 1), oddity);
    for (const double tolerance : {1e-4, 1e-6, 1e-9}) {
      SCOPED_TRACE(testing::Message() << "trial " << trial << ", tolerance " << tolerance);
      NonlinearRun run(equations_of(system), by_structure(tolerance));
      if (run.integrate(0.0, 1.0, system.exact(0.0)) != SFDAE_OK) {
        EXPECT_NE(run.message(), "");
        continue;
      }
      ++solved;
      const std::vector<double> exact = system.exact(1.0);
      double error = 0.0;
      for (std::size_t j = 0; j < exact.size(); ++j)
        error = std::max(error, std::fabs(run.x[j] - exact[j]) / (tolerance * (1.0 + std::fabs(exact[j]))));
      EXPECT_LT(error, 30.0);
      // One for each stage of a step.
      const sfdae_statistics statistics = run.statistics();
      if (statistics.linearizations >= 3 * statistics.steps) ++one_by_one;
    }
  }
  EXPECT_GT(solved, 3 * count * 9 / 10);
  EXPECT_GT(one_by_one, solved / 2);
}

// Andrews' squeezer turns its eliminations over several times; pivots are older than the linearization.
TEST(FewStates, GoesOnFromCheckpointsInEveryBit) {
  const TestProblem p = andrews();
  for (const int method : {SFDAE_METHOD_RADAU, SFDAE_METHOD_BDF}) {
    NonlinearRun first({27, 27, andrews_equations}, by_structure(1e-5, method)),
        second({27, 27, andrews_equations}, by_structure(1e-5, method));
    ASSERT_GE(first.start(0.0, 0.03, p.x0), 0);
    for (const double t : {0.004, 0.0065, 0.011, 0.0145, 0.018, 0.021, 0.024}) {
      SCOPED_TRACE(testing::Message() << "method " << method << ", t = " << t);
      ASSERT_GE(first.advance(t), 0) << first.message();
      const std::vector<double> checkpoint = checkpoint_of(first.solver());
      ASSERT_EQ(sfdae_restore_checkpoint(second.solver(), checkpoint.data(), checkpoint.size()), SFDAE_OK)
          << second.message();
      second.x.resize(27);
      ASSERT_GE(first.advance(t + 0.005), 0) << first.message();
      ASSERT_GE(second.advance(t + 0.005), 0) << second.message();
      EXPECT_EQ(std::memcmp(first.x.data(), second.x.data(), 27 * sizeof(double)), 0);
      EXPECT_EQ(first.statistics().steps, second.statistics().steps);
      ASSERT_EQ(sfdae_restore_checkpoint(first.solver(), checkpoint.data(), checkpoint.size()), SFDAE_OK)
          << first.message();
    }
  }
}

TEST(FewStates, AndrewsHasItsDigitsWithEveryPart) {
  const TestProblem p = andrews();
  for (const double tolerance : {1e-3, 1e-5, 1e-7, 1e-9}) {
    NonlinearRun run({27, 27, andrews_equations}, by_structure(tolerance));
    ASSERT_EQ(run.integrate(0.0, 0.03, p.x0), SFDAE_OK) << run.message();
    EXPECT_GE(correct_digits(p, p.references.back(), run.x.data()), -std::log10(tolerance)) << tolerance;
    EXPECT_EQ(run.values(), (CharacteristicValues{2, 2, 25, 0, 0}));
    // Iterations are quadratic, about: three a stage, and the matrices of each.
    const sfdae_statistics statistics = run.statistics();
    EXPECT_LE(statistics.evaluations_F, 60 * (statistics.steps + 5));
  }
}

}  // namespace sfdae_test
