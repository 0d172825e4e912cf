// SPDX-License-Identifier: BSD-3-Clause
// Derivatives by differences: problems whose rows, blocks and times differ in size by orders of magnitude are solved to
// the tolerances, or it is said that they cannot be.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "sfdae/sfdae.h"

namespace {

using Numbers = std::vector<double>;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(generator_); }
  int integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(generator_); }
  double power_of_ten(double low, double high) { return std::pow(10.0, uniform(low, high)); }

 private:
  std::mt19937 generator_;
};

struct Wave {
  double amplitude, speed, phase, mean;
  double value(double t) const { return mean + amplitude * std::sin(speed * t + phase); }
  double slope(double t) const { return amplitude * speed * std::cos(speed * t + phase); }
};

// A chain y_1' = y_0 + g_0, ..., y_mu' = y_(mu-1) + g_(mu-1), 0 = y_mu + g_mu of index mu and a differential equation
// y' = -rate y + g, in y = R x, rows times P and factors of their own: P E0 R x' = P (A0 R - E0 R') x + P g. All y are
// waves of the size and speed of the block.
class Block {
 public:
  Block(Random& random, int mu, double speed)
      : mu_(mu), size_(random.power_of_ten(-8, 8)), rate_(speed * random.uniform(0.1, 2.0)) {
    for (int i = 0; i < n(); ++i) {
      y_.push_back({size_ * random.uniform(0.5, 2), speed * random.uniform(0.5, 1.5), random.uniform(0, 6),
                    size_ * random.uniform(-1, 1)});
      rows_.push_back(random.power_of_ten(-6, 6));
    }
    // Unit triangular, by entries of moderate size.
    for (auto* matrix : {&R_, &P_})
      for (int e = 0; e < n() * n(); ++e) {
        const bool varies = random.integer(0, 1) == 0;
        matrix->push_back({varies ? random.uniform(-0.3, 0.3) : 0.0, speed * random.uniform(0.3, 1.2),
                           random.uniform(0, 6), random.uniform(-0.5, 0.5)});
      }
  }
  int n() const { return mu_ + 2; }
  double size() const { return size_; }

  // y = R x with R = I + upper triangle.
  Numbers x(double t) const {
    Numbers result;
    for (const Wave& wave : y_) result.push_back(wave.value(t));
    for (int i = n() - 1; i >= 0; --i)
      for (int j = i + 1; j < n(); ++j) result[at(i)] -= wave(R_, i, j).value(t) * result[at(j)];
    return result;
  }
  void add_E(double t, double* to, int ld) const {
    multiply(
        t, [&](int i, int j) { return E0(i) < 0 ? 0.0 : R(t, E0(i), j); }, to, ld);
  }
  void add_A(double t, double* to, int ld) const {
    multiply(
        t,
        [&](int i, int j) {
          const double Rdot = E0(i) >= 0 && j > E0(i) ? wave(R_, E0(i), j).slope(t) : 0.0;
          return (i == n() - 1 ? -rate_ : 1.0) * R(t, i, j) - Rdot;
        },
        to, ld);
  }
  void add_f(double t, double* to) const {
    const auto g = [&](int i, int) {
      const double slope = E0(i) < 0 ? 0.0 : y_[at(E0(i))].slope(t);
      return slope - (i == n() - 1 ? -rate_ : 1.0) * y_[at(i)].value(t);
    };
    for (int i = 0; i < n(); ++i)
      for (int k = 0; k <= i; ++k) to[i] += rows_[at(i)] * P(t, i, k) * g(k, 0);
  }

 private:
  // Row i has y_(i+1)', the last one of the chain none, and that of the differential equation its own.
  int E0(int i) const { return i < mu_ ? i + 1 : i == mu_ ? -1 : i; }
  const Wave& wave(const std::vector<Wave>& matrix, int i, int j) const { return matrix[at(i + n() * j)]; }
  double R(double t, int i, int j) const { return i == j ? 1.0 : i < j ? wave(R_, i, j).value(t) : 0.0; }
  double P(double t, int i, int j) const { return i == j ? 1.0 : wave(P_, i, j).value(t); }
  template <class Entry>
  void multiply(double t, Entry entry, double* to, int ld) const {
    for (int j = 0; j < n(); ++j)
      for (int i = 0; i < n(); ++i)
        for (int k = 0; k <= i; ++k) to[i + j * ld] += rows_[at(i)] * P(t, i, k) * entry(k, j);
  }

  int mu_;
  double size_, rate_;
  std::vector<Wave> y_, R_, P_;
  Numbers rows_;
};

struct Case {
  std::vector<Block> blocks;
  int n = 0;

  template <class Add>
  int write(int order, Add add) const {
    if (order > 0) return SFDAE_ORDER_NOT_AVAILABLE;
    int first = 0;
    for (const Block& block : blocks) {
      add(block, first);
      first += block.n();
    }
    return 0;
  }
  static const Case& of(const void* user) { return *static_cast<const Case*>(user); }
};

int write_E(double t, int order, double* E, void* user) {
  const Case& c = Case::of(user);
  return c.write(order, [&](const Block& block, int first) { block.add_E(t, E + first * (c.n + 1), c.n); });
}
int write_A(double t, int order, double* A, void* user) {
  const Case& c = Case::of(user);
  return c.write(order, [&](const Block& block, int first) { block.add_A(t, A + first * (c.n + 1), c.n); });
}
int write_f(double t, int order, double* f, void* user) {
  return Case::of(user).write(order, [&](const Block& block, int first) { block.add_f(t, f + first); });
}

// 0 or a failure, and the largest error over the tolerance.
struct Outcome {
  int status;
  double error;
};

Outcome solve(const Case& c, double tol, double span, int method) {
  Numbers x, atol;
  for (const Block& block : c.blocks)
    for (const double value : block.x(0.0)) {
      x.push_back(value);
      atol.push_back(tol * block.size());
    }
  sfdae_linear_problem problem;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = c.n;
  problem.E = write_E;
  problem.A = write_A;
  problem.f = write_f;
  problem.user = const_cast<Case*>(&c);
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  options.rtol = tol;
  options.atol_vector = atol.data();
  options.difference_derivatives = 1;
  options.method = method;
  options.max_steps = 20000;
  sfdae_solver* solver = nullptr;
  if (sfdae_create_linear(&solver, &problem, &options) != SFDAE_OK) return {SFDAE_INTERNAL, 0.0};
  Outcome outcome{sfdae_start(solver, 0.0, span, x.data(), nullptr), 0.0};
  for (int output = 1; output <= 3 && outcome.status == SFDAE_OK; ++output) {
    double t = 0.0;
    outcome.status = sfdae_advance(solver, span * output / 3.0, &t, x.data(), nullptr);
    if (outcome.status != SFDAE_OK) break;
    std::size_t i = 0;
    for (const Block& block : c.blocks)
      for (const double exact : block.x(t)) {
        const double error = std::fabs(x[i] - exact) / (tol * std::fabs(exact) + atol[i]);
        outcome.error = std::max(outcome.error, error);
        ++i;
      }
  }
  if (std::getenv("SFDAE_TEST_VERBOSE") != nullptr && outcome.status != 0) printf("%s\n", sfdae_message(solver));
  sfdae_destroy(&solver);
  return outcome;
}

// How many: SFDAE_TEST_PROBLEMS.
int problems() {
  const char* wanted = std::getenv("SFDAE_TEST_PROBLEMS");
  return wanted != nullptr ? std::atoi(wanted) : 48;
}

}  // namespace

TEST(MissingDerivatives, AreRightToTheTolerancesOrItIsSaid) {
  std::map<std::string, std::array<int, 2>> refused;
  int wrong = 0, solved = 0;
  for (int seed = 1; seed <= problems(); ++seed) {
    Random random(static_cast<unsigned>(seed));
    Case c;
    const int highest = 1 + seed % 4, digits = random.integer(4, 9), blocks = random.integer(1, 3);
    const double span = random.power_of_ten(-3, 3);
    for (int b = 0; b < blocks; ++b) {
      // The slowest time is that of the interval; others are up to 30 times faster.
      const double speed = (b == 0 ? 2.0 : random.power_of_ten(0.0, 1.5)) / span;
      c.blocks.emplace_back(random, b == 0 ? highest : random.integer(1, highest), speed);
      c.n += c.blocks.back().n();
    }
    const double tol = std::pow(10.0, -digits);
    const Outcome outcome = solve(c, tol, span, seed % 3 == 0 ? SFDAE_METHOD_BDF : SFDAE_METHOD_RADAU);
    auto& [total, failed] = refused["mu " + std::to_string(highest) + ", 1e-" + std::to_string(digits)];
    ++total;
    if (outcome.status != SFDAE_OK) {
      ++failed;
      ++refused[sfdae_status_name(outcome.status)][1];
    } else {
      ++solved;
    }
    // A tenth of the tolerances is not asked for: errors of integration count, too.
    EXPECT_LE(outcome.error, 100.0) << "seed " << seed << ", mu " << highest << ", tol " << tol << ", span " << span;
    if (outcome.error > 100.0) ++wrong;
  }
  EXPECT_EQ(wrong, 0);
  if (std::getenv("SFDAE_TEST_VERBOSE") != nullptr)
    for (const auto& [what, count] : refused) printf("%s: %d of %d refused\n", what.c_str(), count[1], count[0]);
  EXPECT_GE(4 * solved, problems());
}

namespace {

// x_i = x_(i+1)', ..., 0 = x_n - f_n(t) in chains one after the other; each ends with its own function.
struct Chains {
  int n;
  std::vector<int> ends;  // the last component of each
  double (*last)(int chain, double t);
};

int write_chain_E(double, int order, double* E, void* user) {
  const Chains& c = *static_cast<Chains*>(user);
  for (int i = 0; i + 1 < c.n && order == 0; ++i)
    if (std::find(c.ends.begin(), c.ends.end(), i) == c.ends.end()) E[i + (i + 1) * c.n] = 1.0;
  return 0;
}
int write_chain_A(double, int order, double* A, void* user) {
  const Chains& c = *static_cast<Chains*>(user);
  for (int i = 0; i < c.n && order == 0; ++i) A[i * (c.n + 1)] = 1.0;
  return 0;
}
int write_chain_f(double t, int order, double* f, void* user) {
  const Chains& c = *static_cast<Chains*>(user);
  if (order > 0) return SFDAE_ORDER_NOT_AVAILABLE;
  for (int chain = 0; chain < static_cast<int>(c.ends.size()); ++chain) f[c.ends[at(chain)]] = -c.last(chain, t);
  return 0;
}

// Status of the last call; x at the end.
int solve_chains(Chains c, double tol, bool constant, Numbers& x, std::string& message) {
  sfdae_linear_problem problem;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = c.n;
  problem.E = write_chain_E;
  problem.A = write_chain_A;
  problem.f = write_chain_f;
  problem.constant_E = problem.constant_A = constant ? 1 : 0;
  problem.user = &c;
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  options.rtol = options.atol = tol;
  options.difference_derivatives = 1;
  sfdae_solver* solver = nullptr;
  EXPECT_EQ(sfdae_create_linear(&solver, &problem, &options), SFDAE_OK);
  x.assign(at(c.n), 0.0);
  int status = sfdae_start(solver, 0.0, 1.0, x.data(), nullptr);
  for (int i = 1; i <= 4 && status >= SFDAE_OK; ++i) {
    double t = 0.0;
    status = sfdae_advance(solver, 0.25 * i, &t, x.data(), nullptr);
  }
  message = sfdae_message(solver);
  sfdae_destroy(&solver);
  return status;
}

}  // namespace

// x1 = -sin t beside 1e8 cos 3t: one error for all of f made x1 = 0.
TEST(MissingDerivatives, OfSmallRowsAreNotThoseOfLargeOnes) {
  const Chains chains{
      4, {1, 3}, [](int chain, double t) { return chain == 0 ? std::cos(t) : 1e8 * std::cos(3.0 * t); }};
  for (const bool constant : {false, true}) {
    Numbers x;
    std::string message;
    ASSERT_EQ(solve_chains(chains, 1e-6, constant, x, message), SFDAE_OK) << message;
    EXPECT_NEAR(x[0], -std::sin(1.0), 1e-6);
    EXPECT_NEAR(x[2], -3e8 * std::sin(3.0), 1e-6 * 3e8);
  }
}

// The third derivative of sin 5t; the message names component 0, which it is.
TEST(MissingDerivatives, AreReportedWhereTheyAreTooCoarse) {
  const Chains chain{4, {3}, [](int, double t) { return std::sin(5.0 * t); }};
  for (const bool constant : {false, true}) {
    Numbers x;
    std::string message;
    EXPECT_EQ(solve_chains(chain, 1e-11, constant, x, message), SFDAE_TOLERANCE_TOO_SMALL);
    EXPECT_NE(message.find("component 0 of x"), std::string::npos) << message;
    ASSERT_EQ(solve_chains(chain, 1e-5, constant, x, message), SFDAE_OK) << message;
    EXPECT_NEAR(x[0], -125.0 * std::cos(5.0), 1e-5 * 126.0);
  }
}

namespace {

// x0 = x1', x1 = x2', x2 = x3', x3 = sin 5t, beside x4' = -x4.
int write_chain_and_decay(bool is_E, int order, double* matrix) {
  for (int i = 0; i < 5 && order == 0; ++i)
    if (is_E) matrix[i + 5 * (i < 3 ? i + 1 : i)] = i == 3 ? 0.0 : 1.0;
    else matrix[6 * i] = i == 4 ? -1.0 : 1.0;
  return 0;
}

struct StartedRun {
  int started, advanced;
  double x_start;  // component 0
  std::string message;
};

StartedRun run_chain_and_decay(double tol, int method, int output, double tout) {
  sfdae_linear_problem problem;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = problem.num_unknowns = 5;
  problem.E = [](double, int order, double* E, void*) { return write_chain_and_decay(true, order, E); };
  problem.A = [](double, int order, double* A, void*) { return write_chain_and_decay(false, order, A); };
  problem.f = [](double t, int order, double* f, void*) {
    if (order > 0) return SFDAE_ORDER_NOT_AVAILABLE;
    f[3] = -std::sin(5.0 * t);
    return 0;
  };
  problem.constant_E = problem.constant_A = 1;
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  options.rtol = options.atol = tol;
  options.method = method;
  options.difference_derivatives = 1;
  options.output = output;
  sfdae_solver* solver = nullptr;
  EXPECT_EQ(sfdae_create_linear(&solver, &problem, &options), SFDAE_OK);
  Numbers x{-125.0, 0.0, 5.0, 0.0, 1.0};
  StartedRun run{};
  run.started = sfdae_start(solver, 0.0, 1.0, x.data(), nullptr);
  run.x_start = x[0];
  double t = 0.0;
  run.advanced = run.started < 0 ? run.started : sfdae_advance(solver, tout, &t, x.data(), nullptr);
  run.message = sfdae_message(solver);
  sfdae_destroy(&solver);
  return run;
}

}  // namespace

// Differences are one-sided at the start alone: with some tolerances it is the only point that is not accurate enough.
// Outputs say so, however few steps lead to them, and whether or not they are interpolated.
TEST(MissingDerivatives, AreRightAtTheStartOrItIsSaid) {
  struct Way {
    int output;
    double tout;
  };
  for (const Way way : {Way{SFDAE_OUTPUT_CONSISTENT, 1.0}, Way{SFDAE_OUTPUT_INTERPOLATED, 1.0},
                        Way{SFDAE_OUTPUT_CONSISTENT, 1e-5}, Way{SFDAE_OUTPUT_INTERPOLATED, 1e-5}}) {
    int starts_named = 0, right = 0;
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
      for (double tol = 1e-5; tol > 1e-12; tol /= 2.0) {
        const StartedRun run = run_chain_and_decay(tol, method, way.output, way.tout);
        if (run.advanced == SFDAE_OK) {
          ++right;
          EXPECT_NEAR(run.x_start, -125.0, tol * 126.0) << tol;
        } else {
          EXPECT_EQ(run.advanced, SFDAE_TOLERANCE_TOO_SMALL) << run.message;
          if (run.message.find("at t = 0 they") != std::string::npos) ++starts_named;
        }
      }
    EXPECT_GE(right, 10);
    // Where the output is near the start, the output is named.
    EXPECT_GE(starts_named, way.tout == 1.0 ? 1 : 0);
  }
}
