// SPDX-License-Identifier: BSD-3-Clause
// Random linear equations E x' = A x + b u of index 0 to 4 with an input u that steps, bends or is a pulse where a
// condition holds: u as a function of unknowns (a clock, an oscillator, a decay) has to lead to the same solution as u
// as a function of t, whose switching times are found otherwise. The solution also has to be the same where u is a
// callback, of which the library does not know when it switches.
//
// SFDAE_TEST_SCALE scales the number of problems.
#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

#include "family_run.h"
#include "random.h"

namespace sfdae_test {

namespace {

namespace switched {

using sfdae::ConstExpressions;
using sfdae::Expression;
using sfdae::Expressions;
using Vector = std::vector<double>;
using Table = std::vector<Vector>;

constexpr double end = 2.0;
std::size_t at(int i) { return static_cast<std::size_t>(i); }

enum class Clock { time, oscillator, decay };
enum class Input { step, ramp, kink, sign, largest, pulse };

Table random_matrix(Random& random, int n) {
  Table matrix(at(n));
  for (int i = 0; i < n; ++i) {
    matrix[at(i)] = random.reals(n, -1.0, 1.0);
    matrix[at(i)][at(i)] += random.integer(0, 1) == 0 ? 2.0 : -2.0;
  }
  return matrix;
}

Table product(const Table& a, const Table& b) {
  const std::size_t n = a.size();
  Table c(n, Vector(n, 0.0));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t j = 0; j < n; ++j) c[i][j] += a[i][k] * b[k][j];
  return c;
}

// P diag(I, N) Q x' = P diag(J, I) Q x + P b u, N nilpotent: [KM06], Weierstrass' form.
class SwitchedProblem {
 public:
  explicit SwitchedProblem(unsigned seed) : random_(7919u * seed + 3u) {
    const int differential = random_.integer(1, 3), block = random_.integer(1, 4);
    n_ = differential + block + random_.integer(0, 2);
    Table E(at(n_), Vector(at(n_), 0.0)), A = E;
    for (int i = 0; i < n_; ++i) {
      if (i < differential) {
        E[at(i)][at(i)] = 1.0;
        for (int j = 0; j < differential; ++j) A[at(i)][at(j)] = random_.real(-1.0, 1.0) - (i == j ? 1.5 : 0.0);
      } else {
        A[at(i)][at(i)] = 1.0;
        if (i + 1 < differential + block) E[at(i)][at(i + 1)] = random_.real(0.5, 2.0);
      }
    }
    const Table P = random_matrix(random_, n_), Q = random_matrix(random_, n_);
    E_ = product(product(P, E), Q);
    A_ = product(product(P, A), Q);
    b_ = random_.reals(n_, -1.0, 1.0);
    index_ = block - 1;
    clock_ = static_cast<Clock>(random_.integer(0, 2));
    input_ = static_cast<Input>(random_.integer(0, 5));
    frequency_ = random_.real(2.0, 6.0);
    phase_ = random_.real(0.0, 6.0);
    limit_ = clock_ == Clock::time         ? random_.real(0.3, 1.7)
             : clock_ == Clock::oscillator ? random_.real(-0.7, 0.7)
                                           : random_.real(0.2, 0.8);
    width_ = std::pow(10.0, random_.real(-3.0, -1.0));
  }

  int n() const { return n_; }
  std::string text() const {
    return "index " + std::to_string(index_) + ", clock " + std::to_string(static_cast<int>(clock_)) + ", input " +
           std::to_string(static_cast<int>(input_));
  }

  // Both have the same unknowns; z is one of them, and the last one but one.
  sfdae::NonlinearProblem problem(bool is_of_time) const {
    sfdae::NonlinearProblem problem(n_ + 2, n_ + 2);
    problem.equations = [this, is_of_time](const Expression& t, ConstExpressions x, ConstExpressions xdot,
                                           Expressions F) {
      const Expression u = input(is_of_time ? clock(t) : x[n_]);
      for (int i = 0; i < n_; ++i) {
        F[i] = -b_[at(i)] * u;
        for (int j = 0; j < n_; ++j) F[i] = F[i] + E_[at(i)][at(j)] * xdot[j] - A_[at(i)][at(j)] * x[j];
      }
      F[n_] = xdot[n_] - (clock_ == Clock::time         ? Expression(1.0)
                          : clock_ == Clock::oscillator ? frequency_ * x[n_ + 1]
                                                        : -x[n_]);
      F[n_ + 1] = xdot[n_ + 1] + frequency_ * x[n_];
    };
    return problem;
  }
  // u by a function. The equations of the clock are the same.
  sfdae::LinearProblem callbacks() const {
    sfdae::LinearProblem problem(n_ + 2, n_ + 2);
    problem.constant_E = problem.constant_A = true;
    problem.E = [this](double, int order, sfdae::MatrixRef E) {
      if (order > 0) return;
      for (int i = 0; i < n_; ++i)
        for (int j = 0; j < n_; ++j) E(i, j) = E_[at(i)][at(j)];
      E(n_, n_) = E(n_ + 1, n_ + 1) = 1.0;
    };
    problem.A = [this](double, int order, sfdae::MatrixRef A) {
      if (order > 0) return;
      for (int i = 0; i < n_; ++i)
        for (int j = 0; j < n_; ++j) A(i, j) = A_[at(i)][at(j)];
      A(n_, n_) = clock_ == Clock::decay ? -1.0 : 0.0;
      A(n_, n_ + 1) = clock_ == Clock::oscillator ? frequency_ : 0.0;
      A(n_ + 1, n_) = -frequency_;
    };
    problem.f = [this](double t, int order, sfdae::VectorRef f) {
      for (int i = 0; i < n_; ++i) f[i] = b_[at(i)] * input_at(t, order);
      if (order == 0 && clock_ == Clock::time) f[n_] = 1.0;
    };
    return problem;
  }
  bool has_pulse() const { return input_ == Input::pulse; }
  Vector start() const {
    Vector x(at(n_ + 2), 0.0);
    x[at(n_)] = clock_ == Clock::time ? 0.0 : clock_ == Clock::decay ? 1.0 : std::sin(phase_);
    x[at(n_ + 1)] = std::cos(phase_);
    return x;
  }

 private:
  double clock_at(double t, int order) const {
    if (clock_ == Clock::time) return order == 0 ? t : order == 1 ? 1.0 : 0.0;
    if (clock_ == Clock::decay) return (order % 2 == 0 ? 1.0 : -1.0) * std::exp(-t);
    return std::pow(frequency_, order) * std::sin(frequency_ * t + phase_ + order * std::acos(0.0));
  }
  double input_at(double t, int order) const {
    const double beyond = clock_at(t, 0) - limit_;
    const double z = order == 0 ? beyond : clock_at(t, order);
    switch (input_) {
      case Input::step: return order == 0 && beyond > 0.0 ? 1.0 : 0.0;
      case Input::ramp: return beyond > 0.0 ? z : 0.0;
      case Input::kink: return beyond > 0.0 ? z : -z;
      case Input::sign: return order > 0 ? 0.0 : beyond > 0.0 ? 1.0 : -1.0;
      case Input::largest: return (beyond > 0.0 ? z : 0.0) + (order == 0 ? limit_ : 0.0);
      default: return 0.0;
    }
  }
  Expression clock(const Expression& t) const {
    if (clock_ == Clock::time) return t;
    return clock_ == Clock::decay ? exp(-t) : sin(frequency_ * t + phase_);
  }
  Expression input(const Expression& z) const {
    switch (input_) {
      case Input::step: return choose(z > limit_, 1.0, 0.0);
      case Input::ramp: return choose(z > limit_, z - limit_, 0.0);
      case Input::kink: return abs(z - limit_);
      case Input::sign: return sign(z - limit_);
      case Input::largest: return max(z, limit_);
      default: return choose(z > limit_ && z < limit_ + width_, 1.0, 0.0);
    }
  }

  Random random_;
  int n_ = 0, index_ = 0;
  Table E_, A_;
  Vector b_;
  Clock clock_ = Clock::time;
  Input input_ = Input::step;
  double frequency_ = 1.0, phase_ = 0.0, limit_ = 0.0, width_ = 0.0;
};

// From x at the start on, which becomes consistent.
template <class Problem>
Vector solution(const Problem& problem, const sfdae::Options& options, Vector& x) {
  sfdae::Solver solver(problem, options);
  sfdae::Point point{0.0, x, {}};
  solver.start(point, end);
  x = point.x;
  solver.advance(end, point);
  return point.x;
}

TEST(Conditions, OnUnknownsAndOnTimeAgree) {
  const int count = scaled_count(600);
  int named = 0;
  for (int seed = 0; seed < count; ++seed) {
    const SwitchedProblem given(static_cast<unsigned>(seed));
    sfdae::Options exact;
    exact.rtol = exact.atol = 1e-10;
    sfdae::Options options;
    options.method = seed % 2 == 0 ? SFDAE_METHOD_BDF : SFDAE_METHOD_RADAU;
    options.structure = seed / 2 % 2 == 0 ? SFDAE_STRUCTURE_OFF : SFDAE_STRUCTURE_AUTOMATIC;
    options.rtol = options.atol = std::pow(10.0, -4 - 2 * (seed % 3));
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + given.text());
    Vector reference, start = given.start();
    ASSERT_NO_THROW(reference = solution(given.problem(true), exact, start));
    try {
      const Vector x = solution(given.problem(false), options, start);
      for (int i = 0; i < given.n(); ++i) {
        const double size = std::max(1.0, std::fabs(reference[at(i)]));
        EXPECT_NEAR(x[at(i)], reference[at(i)], 300.0 * options.rtol * size);
      }
    } catch (const sfdae::Error& error) {
      ++named;
      std::printf("seed %d, %s: %s\n", seed, given.text().c_str(), error.what());
    }
  }
  std::printf("%d problems, %d ended by name\n", count, named);
  EXPECT_LE(named, count / 20);
}

TEST(Conditions, OfFunctionsAgreeWithThoseOfEquations) {
  const int count = scaled_count(400);
  int named = 0, solved = 0;
  for (int seed = 1000; seed < 1000 + count; ++seed) {
    const SwitchedProblem given(static_cast<unsigned>(seed));
    if (given.has_pulse()) continue;  // shorter than a step, it has to be declared
    sfdae::Options exact;
    exact.rtol = exact.atol = 1e-10;
    sfdae::Options options;
    options.method = seed % 2 == 0 ? SFDAE_METHOD_BDF : SFDAE_METHOD_RADAU;
    options.rtol = options.atol = std::pow(10.0, -4 - 2 * (seed % 3));
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + given.text());
    Vector reference, start = given.start();
    ASSERT_NO_THROW(reference = solution(given.problem(true), exact, start));
    try {
      const Vector x = solution(given.callbacks(), options, start);
      ++solved;
      for (int i = 0; i < given.n(); ++i) {
        const double size = std::max(1.0, std::fabs(reference[at(i)]));
        EXPECT_NEAR(x[at(i)], reference[at(i)], 300.0 * options.rtol * size);
      }
    } catch (const sfdae::Error& error) {
      ++named;
      std::printf("seed %d, %s: %s\n", seed, given.text().c_str(), error.what());
    }
  }
  std::printf("%d problems solved, %d ended by name\n", solved, named);
  EXPECT_LE(named, count / 20);
}

}  // namespace switched

}  // namespace

}  // namespace sfdae_test
