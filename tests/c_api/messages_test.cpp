// SPDX-License-Identifier: BSD-3-Clause
// What messages name is what is wrong: equations that contradict each other, alternatives of unclear ranks, the check
// that helps.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "sfdae/sfdae.h"

namespace {

// E x' = A x + f with constant E and A, f = f0 + f1 t + f2 t^2, some of the equations.
struct Polynomial {
  int n = 0;
  std::vector<std::vector<double>> E, A;  // by rows
  std::vector<std::vector<double>> f;     // coefficients, by rows
  int m() const { return static_cast<int>(E.size()); }

  Polynomial only(const std::vector<int>& rows) const {
    Polynomial result{n, {}, {}, {}};
    for (const int row : rows) result.add(E[at(row)], A[at(row)], f[at(row)]);
    return result;
  }
  void add(std::vector<double> E_row, std::vector<double> A_row, std::vector<double> f_row) {
    E.push_back(std::move(E_row));
    A.push_back(std::move(A_row));
    f.push_back(std::move(f_row));
  }
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
};

template <bool is_E>
int matrix(double, int order, double* values, void* user) {
  const auto& p = *static_cast<const Polynomial*>(user);
  for (int i = 0; i < p.m() && order == 0; ++i)
    for (int j = 0; j < p.n; ++j) values[i + j * p.m()] = (is_E ? p.E : p.A)[p.at(i)][p.at(j)];
  return 0;
}

int vector(double t, int order, double* values, void* user) {
  const auto& p = *static_cast<const Polynomial*>(user);
  for (int i = 0; i < p.m(); ++i) {
    const std::vector<double>& c = p.f[p.at(i)];
    values[i] = order == 0   ? c[0] + t * (c[1] + t * c[2])
                : order == 1 ? c[1] + 2.0 * c[2] * t
                : order == 2 ? 2.0 * c[2]
                             : 0.0;
  }
  return 0;
}

struct Answer {
  int status;
  std::string message;
};

Answer start(Polynomial p, std::vector<double> x, const std::vector<int>& fixed = {}) {
  if (p.m() == 0) return {SFDAE_OK, ""};
  sfdae_linear_problem problem;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = p.m();
  problem.num_unknowns = p.n;
  problem.E = matrix<true>;
  problem.A = matrix<false>;
  problem.f = vector;
  problem.user = &p;
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  if (!fixed.empty()) {
    options.initial_values = SFDAE_INITIAL_FIXED;
    options.fixed = fixed.data();
  }
  sfdae_solver* solver = nullptr;
  EXPECT_EQ(sfdae_create_linear(&solver, &problem, &options), SFDAE_OK);
  Answer answer;
  answer.status = sfdae_start(solver, 0.5, 2.0, x.data(), nullptr);
  answer.message = sfdae_message(solver);
  sfdae_destroy(&solver);
  return answer;
}

// Of "It is equations 0, 1 (differentiated once) and 4 that cannot hold".
std::vector<int> named(const std::string& message) {
  std::vector<int> result;
  std::size_t at = message.find("It is equation");
  if (at == std::string::npos) return result;
  const std::size_t end = message.find(" that cannot hold", at);
  bool in_parentheses = false;
  for (; at < end; ++at) {
    in_parentheses = message[at] == '(' || (in_parentheses && message[at] != ')');
    if (in_parentheses || message[at] < '0' || message[at] > '9') continue;
    result.push_back(std::atoi(message.c_str() + at));
    while (message[at] >= '0' && message[at] <= '9') ++at;
  }
  return result;
}

// Those named have the failure by themselves, and without any one of them they have it no more.
void expect_truth(const Polynomial& p, const std::vector<double>& x, const std::vector<int>& fixed, int status) {
  const Answer answer = start(p, x, fixed);
  ASSERT_EQ(answer.status, status) << answer.message;
  const std::vector<int> set = named(answer.message);
  ASSERT_FALSE(set.empty()) << answer.message;
  EXPECT_EQ(start(p.only(set), x, fixed).status, status) << answer.message;
  for (std::size_t out = 0; out < set.size(); ++out) {
    std::vector<int> rest;
    for (std::size_t i = 0; i < set.size(); ++i)
      if (i != out) rest.push_back(set[i]);
    EXPECT_NE(start(p.only(rest), x, fixed).status, status) << answer.message << " without " << set[out];
  }
}

std::vector<double> random_row(std::mt19937& generator, int count) {
  std::uniform_int_distribution<int> digit(-3, 3);
  std::vector<double> row;
  for (int j = 0; j < count; ++j) row.push_back(digit(generator));
  return row;
}

void shuffle(Polynomial& p, std::mt19937& generator) {
  std::vector<int> order;
  for (int i = 0; i < p.m(); ++i) order.push_back(i);
  std::shuffle(order.begin(), order.end(), generator);
  p = p.only(order);
}

TEST(Messages, NameContradictingEquations) {
  // x1' = 0, x1 = 1 + t: the second one differentiated contradicts the first one; x2' = x1 does not matter.
  Polynomial p{2, {}, {}, {}};
  p.add({0, 1}, {1, 0}, {0, 0, 0});
  p.add({1, 0}, {0, 0}, {0, 0, 0});
  p.add({0, 0}, {1, 0}, {-1, -1, 0});
  const Answer answer = start(p, {1.5, 0.0});
  EXPECT_EQ(answer.status, SFDAE_INCONSISTENT_EQUATIONS);
  EXPECT_NE(answer.message.find("It is equations 1 and 2 (differentiated once) that cannot hold together."),
            std::string::npos)
      << answer.message;
}

TEST(Messages, NameMinimalSetsOfContradictingEquations) {
  std::mt19937 generator(1);
  for (int k = 0; k < 60; ++k) {
    const int n = 3 + k % 3;
    Polynomial p{n, {}, {}, {}};
    // Algebraic equations and differential ones; the last one follows from two or three of them, but for f.
    for (int i = 0; i < n; ++i)
      p.add(i % 2 == 0 ? random_row(generator, n) : std::vector<double>(Polynomial::at(n), 0.0),
            random_row(generator, n), random_row(generator, 3));
    std::vector<double> E(Polynomial::at(n), 0.0), A(E), f(3, 0.0);
    for (int i = 0; i < 2 + k % 2; ++i) {
      const double c = 1.0 + i;
      for (int j = 0; j < n; ++j) {
        E[p.at(j)] += c * p.E[p.at(i)][p.at(j)];
        A[p.at(j)] += c * p.A[p.at(i)][p.at(j)];
      }
      for (std::size_t j = 0; j < 3; ++j) f[j] += c * p.f[p.at(i)][j];
    }
    f[k % 3 == 0 ? 1 : 0] += 0.25;
    p.add(E, A, f);
    shuffle(p, generator);
    SCOPED_TRACE(k);
    expect_truth(p, std::vector<double>(Polynomial::at(n), 0.0), {}, SFDAE_INCONSISTENT_EQUATIONS);
  }
}

TEST(Messages, NameEquationsThatFixedComponentsViolate) {
  std::mt19937 generator(2);
  int refused = 0;
  for (int k = 0; k < 60; ++k) {
    const int n = 4;
    Polynomial p{n, {}, {}, {}};
    for (int i = 0; i < n; ++i)
      p.add(i == 0 ? random_row(generator, n) : std::vector<double>(Polynomial::at(n), 0.0), random_row(generator, n),
            random_row(generator, 3));
    shuffle(p, generator);
    const std::vector<double> x{0.3, -1.7, 2.1, 0.9};
    const std::vector<int> fixed{1, k % 2, 1, 0};
    SCOPED_TRACE(k);
    if (start(p, x, fixed).status != SFDAE_FIXED_VALUES) continue;
    ++refused;
    expect_truth(p, x, fixed, SFDAE_FIXED_VALUES);
  }
  EXPECT_GE(refused, 20);
}

// x1' = -x1 + x2, eps x2' = -x2 + x1, for eps where that is not clear: alternatives that differ, and tolerances that
// give them.
TEST(Messages, NameDifferentAlternativesOfUnclearRanks) {
  int unclear = 0;
  for (double eps = 1e-17; eps < 1e-7; eps *= 1.7)
    for (const double other : {0.0, 1.0}) {
      Polynomial p{2, {}, {}, {}};
      p.add({1, other}, {-1, 1}, {0, 0, 0});
      p.add({other, other * other + eps}, {1, -1}, {1, 1, 0});
      const Answer answer = start(p, {1.0, 1.0});
      if (answer.status != SFDAE_RANK_UNCLEAR) continue;
      ++unclear;
      std::vector<std::string> values;
      for (std::size_t at = answer.message.find("mu = "); at != std::string::npos;
           at = answer.message.find("mu = ", at + 1))
        values.push_back(answer.message.substr(at, answer.message.find_first_of(".)", at) - at));
      ASSERT_GE(values.size(), 2u) << answer.message;
      bool differ = false;
      for (const std::string& v : values) differ = differ || v != values.front();
      EXPECT_TRUE(differ) << answer.message;
    }
  RecordProperty("unclear", unclear);
}

// x' = 1, x^2 = (t + max(t - 1, 0)^3)^2: they contradict each other from t = 1 on; y = x x does not matter.
int later_contradiction(sfdae_record*, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                        sfdae_expression* F, void*) {
  const sfdae_expression late = sfdae_max(sfdae_subtract(t, sfdae_number(1)), sfdae_number(0));
  const sfdae_expression law = sfdae_add(t, sfdae_multiply(late, sfdae_multiply(late, late)));
  F[0] = sfdae_subtract(xdot[0], sfdae_number(1));
  F[1] = sfdae_subtract(x[1], sfdae_multiply(x[0], x[0]));
  F[2] = sfdae_subtract(sfdae_multiply(x[0], x[0]), sfdae_multiply(law, law));
  return 0;
}

TEST(Messages, NameContradictingNonlinearEquations) {
  sfdae_nonlinear_problem problem;
  sfdae_nonlinear_problem_init(&problem, sizeof problem);
  problem.num_equations = 3;
  problem.num_unknowns = 2;
  problem.equations = later_contradiction;
  sfdae_solver* solver = nullptr;
  ASSERT_EQ(sfdae_create_nonlinear(&solver, &problem, nullptr), SFDAE_OK);
  double x[2] = {0.5, 0.25}, t = 0.0;
  ASSERT_GE(sfdae_start(solver, 0.5, 3.0, x, nullptr), 0) << sfdae_message(solver);
  EXPECT_EQ(sfdae_advance(solver, 3.0, &t, x, nullptr), SFDAE_INCONSISTENT_EQUATIONS) << sfdae_message(solver);
  const std::string message = sfdae_message(solver);
  EXPECT_NE(message.find("It is equations 0 and 2 (differentiated once) that cannot hold together."),
            std::string::npos)
      << message;
  sfdae_destroy(&solver);
}

// ---- Multibody systems ---------------------------------------------------------------------------------------

struct Lines {
  double offset = 0.0;
};

int forces(double, const double*, const double*, double*, void*) { return 0; }
// q1 = 0, q2 = 1, q1 + q2 = 1 + offset.
int g(double, const double* q, double* result, void* user) {
  result[0] = q[0];
  result[1] = q[1] - 1.0;
  result[2] = q[0] + q[1] - 1.0 - static_cast<const Lines*>(user)->offset;
  return 0;
}
int g_q(double, const double*, double* result, void*) {
  result[0] = result[2] = result[1 + 3] = result[2 + 3] = 1.0;
  return 0;
}

Answer start_lines(double offset, const int* fixed, sfdae_position_function gradient = g_q) {
  Lines lines{offset};
  sfdae_multibody_problem problem;
  sfdae_multibody_problem_init(&problem, sizeof problem);
  problem.num_positions = 3;
  problem.num_constraints = 3;
  problem.forces = forces;
  problem.constraints = g;
  problem.constraint_jacobian = gradient;
  problem.user = &lines;
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  if (fixed != nullptr) {
    options.initial_values = SFDAE_INITIAL_FIXED;
    options.fixed = fixed;
  }
  sfdae_solver* solver = nullptr;
  EXPECT_EQ(sfdae_create_multibody(&solver, &problem, &options), SFDAE_OK);
  double x[9] = {0.0, 0.7, 0.0, 0, 0, 0, 0, 0, 0};
  Answer answer;
  answer.status = sfdae_start(solver, 0.0, 1.0, x, nullptr);
  answer.message = sfdae_message(solver);
  sfdae_destroy(&solver);
  return answer;
}

TEST(Messages, NameConstraintsOfMultibodySystems) {
  EXPECT_GE(start_lines(0.0, nullptr).status, 0);
  // All three contradict each other.
  const Answer contradiction = start_lines(0.5, nullptr);
  EXPECT_EQ(contradiction.status, SFDAE_INCONSISTENT_EQUATIONS) << contradiction.message;
  EXPECT_NE(contradiction.message.find("holonomic constraint "), std::string::npos) << contradiction.message;
  // q2 = 0.7 is fixed, which violates the constraint with number 1 alone (q1 adapts to the third).
  const int fixed[9] = {0, 1, 0, 0, 0, 0, 0, 0, 0};
  const Answer violation = start_lines(0.0, fixed);
  EXPECT_EQ(violation.status, SFDAE_FIXED_VALUES) << violation.message;
  EXPECT_NE(violation.message.find("holonomic constraint "), std::string::npos) << violation.message;
}

// A gradient that is singular where g is not.
int singular_gradient(double, const double* q, double* result, void*) {
  const double factor = (q[1] - 1.0) * (q[1] - 1.0) + q[0] * q[0];
  result[0] = result[2] = result[1 + 3] = result[2 + 3] = factor;
  return 0;
}

TEST(Messages, SuggestTheCheckOfMultibodyDerivatives) {
  const Answer failure = start_lines(0.0, nullptr, singular_gradient);
  ASSERT_LT(failure.status, 0);
  EXPECT_TRUE(failure.status == SFDAE_WRONG_DERIVATIVES ||
              failure.message.find("sfdae_check_multibody_derivatives") != std::string::npos)
      << failure.status << failure.message;
}

}  // namespace
