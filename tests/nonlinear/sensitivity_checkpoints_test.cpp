// SPDX-License-Identifier: BSD-3-Clause
// Integrations with sensitivities that go on from checkpoints: the same in every bit as if nothing had happened.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "family_run.h"
#include "linalg/archive.h"
#include "sensitivity_problems.h"
#include "sfdae/sfdae.hpp"
#include "solver_options.h"
#include "transformed_system.h"

namespace {

using sfdae::Expression;
using sfdae::Matrix;
using sfdae::Point;
using sfdae_test::chain_of_rods;
using sfdae_test::diffusion;
using sfdae_test::driven_by_a_table;
using sfdae_test::pendulum_with_friction;
using sfdae_test::rotation;
using sfdae_test::scaled_count;
using sfdae_test::solver_options;
using sfdae_test::TransformedSystem;
using sfdae_test::van_der_pol;

// A solver that knows what is wanted, and where it starts.
struct Course {
  std::function<sfdae::Solver()> solver;
  std::vector<double> x;
  double from, to;
};

template <class Problem>
Course course_of(Problem problem, const sfdae::Options& options, const sfdae::Sensitivities& wanted,
                 std::vector<double> x, double from, double to) {
  const auto make = [=] {
    sfdae::Solver solver(problem, options);
    solver.set_sensitivities(wanted);
    return solver;
  };
  return {make, std::move(x), from, to};
}

sfdae::Sensitivities by(std::vector<std::string> parameters, bool error_test = false) {
  sfdae::Sensitivities wanted;
  wanted.parameters = std::move(parameters);
  wanted.error_test = error_test;
  return wanted;
}

std::vector<double> entries(const Matrix& matrix) {
  std::vector<double> all;
  for (int j = 0; j < matrix.columns(); ++j)
    for (int i = 0; i < matrix.rows(); ++i) all.push_back(matrix(i, j));
  return all;
}

void expect_same_sensitivities(sfdae::Solver& plain, sfdae::Solver& other, double t, bool slopes) {
  const sfdae::SensitivityValues a = plain.sensitivities(t, slopes), b = other.sensitivities(t, slopes);
  ASSERT_EQ(entries(a.S), entries(b.S)) << "t = " << t;
  ASSERT_EQ(entries(a.Sdot), entries(b.Sdot)) << "t = " << t;
}

void expect_same_work(const sfdae::Solver& plain, const sfdae::Solver& other) {
  const sfdae::Statistics a = plain.statistics(), b = other.statistics();
  ASSERT_EQ(a.steps, b.steps);
  ASSERT_EQ(a.error_failures, b.error_failures);
  ASSERT_EQ(a.next_step, b.next_step);
  const sfdae::SensitivityStatistics s = plain.sensitivity_statistics(), r = other.sensitivity_statistics();
  ASSERT_EQ(s.count, r.count);
  ASSERT_EQ(s.error_test_failures, r.error_test_failures);
  ASSERT_EQ(s.linearizations, r.linearizations);
  ASSERT_EQ(s.factorizations, r.factorizations);
  ASSERT_EQ(s.outputs, r.outputs);
}

// One of two runs has nothing left but a checkpoint, again and again; both are asked for the same.
void compare(const Course& course, int pieces = 24) {
  sfdae::Solver plain = course.solver(), broken = course.solver();
  Point x{course.from, course.x, {}}, y = x;
  plain.start(x, course.to);
  broken.start(y, course.to);
  double before = x.t;
  for (int i = 0; i <= pieces; ++i) {
    const std::vector<double> checkpoint = broken.save_checkpoint();
    broken = course.solver();
    broken.restore_checkpoint(checkpoint);
    ASSERT_NO_FATAL_FAILURE(expect_same_work(plain, broken)) << i;
    if (i % 4 == 0) {
      ASSERT_NO_FATAL_FAILURE(expect_same_sensitivities(plain, broken, x.t, i % 8 == 0)) << i;
    }
    if (i % 3 == 1) {
      const double within = 0.3 * before + 0.7 * x.t;
      ASSERT_NO_FATAL_FAILURE(expect_same_sensitivities(plain, broken, within, i % 2 == 0)) << i;
    }
    if (i == pieces) break;
    const double end = course.from + (course.to - course.from) * (i + 1) / pieces;
    const bool is_behind = (end - x.t) * (course.to - course.from) > 0.0;
    const double tout = is_behind ? end : course.to;
    const bool one_step = i % 3 == 0;
    before = plain.statistics().t_internal;
    const int status = one_step ? plain.step(tout, x) : plain.advance(tout, x);
    ASSERT_EQ(one_step ? broken.step(tout, y) : broken.advance(tout, y), status) << i;
    if (!one_step) before = plain.statistics().t_internal - plain.statistics().last_step;
    if ((before - x.t) * (course.to - course.from) > 0.0) before = x.t;
    ASSERT_EQ(x.t, y.t) << i;
    ASSERT_EQ(x.x, y.x) << i;
    ASSERT_EQ(x.xdot, y.xdot) << i;
  }
}

class SensitivityCheckpoints : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Methods, SensitivityCheckpoints,
                         testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU, SFDAE_METHOD_AUTOMATIC));

TEST_P(SensitivityCheckpoints, ContinueInEveryBitForAnyIndex) {
  const int count = scaled_count(40, 4);
  for (int seed = 1; seed <= count; ++seed) {
    const TransformedSystem system(static_cast<unsigned>(seed));
    SCOPED_TRACE("seed " + std::to_string(seed) + ", mu = " + std::to_string(system.mu()));
    std::vector<double> x;
    Matrix unused;
    system.exact(0.0, x, unused);
    sfdae::Sensitivities wanted = by({"p", "q", ""});
    wanted.directions = Matrix(system.n(), 3);
    wanted.directions(0, 2) = 1.0;
    compare(course_of(system.problem(), solver_options(1e-6, GetParam()), wanted, x, 0.0, 2.0));
  }
}

// Chains are solved by the minimal extension, with states that change.
std::vector<double> start_of_chain(int links) {
  std::vector<double> x(std::size_t(5 * links), 0.0);
  for (int i = 0; i < links; ++i) {
    x[std::size_t(5 * i)] = 1.0 + 0.8 * i;
    x[std::size_t(5 * i + 1)] = 0.6 * i;
  }
  return x;
}

TEST_P(SensitivityCheckpoints, ContinueWithStatesOfTheExtension) {
  for (int links : {3, 12})
    compare(course_of(chain_of_rods(links), solver_options(1e-6, GetParam()), by({"p", "q"}), start_of_chain(links),
                      0.0, 2.0));
}

// As many cells as lists of operations and factors are for.
TEST_P(SensitivityCheckpoints, ContinueWithPivotsOfSparseMatrices) {
  for (int cells : {4, 15, 60})
    compare(course_of(diffusion(cells), solver_options(1e-5, GetParam()), by({"p", "q"}),
                      std::vector<double>(std::size_t(2 * cells), 0.0), 0.0, 3.0));
}

// Every unknown in every equation, no constraints: factors are kept over steps.
TEST_P(SensitivityCheckpoints, ContinueWithFactorsThatAreKept) {
  constexpr int n = 14;
  sfdae::NonlinearProblem problem(n, n);
  problem.equations = [](const Expression& t, auto x, auto xdot, auto F) {
    const Expression p = sfdae::parameter(t, "p", 0.7);
    Expression sum = 0.0 * t;
    for (int i = 0; i < n; ++i) sum = sum + x[i];
    for (int i = 0; i < n; ++i) F[i] = xdot[i] + (1.0 + i) * x[i] + p * sin(0.1 * sum + 0.3 * i) - cos(t);
  };
  std::vector<double> x;
  for (int i = 0; i < n; ++i) x.push_back(1.0 / (1.0 + i));
  compare(course_of(problem, solver_options(1e-7, GetParam()), by({"p"}), x, 0.0, 6.0), 40);
}

TEST_P(SensitivityCheckpoints, ContinueLinearEquations) {
  const sfdae::NonlinearProblem problem = rotation();
  compare(course_of(problem, solver_options(1e-8, GetParam()), by({"p", "c"}), {2.0, 0.0, 0.0}, 4.0, 0.0));
}

TEST_P(SensitivityCheckpoints, ContinueMechanicalSystemsBackwardInTime) {
  const sfdae::MultibodyProblem system = pendulum_with_friction();
  compare(course_of(system, solver_options(1e-6, GetParam()), by({"m", "friction", "length"}),
                    {0.7, 0.0, 0.0, 0.0, 0.0}, 1.0, -2.0));
}

// At each kink integrations start anew.
TEST_P(SensitivityCheckpoints, KeepToTheirSideOfKinks) {
  const sfdae::NonlinearProblem problem = driven_by_a_table();
  compare(course_of(problem, solver_options(1e-7, GetParam()), by({"p", "q"}), {0.5, 0.2, 0.0}, 0.0, 2.0), 32);
}

TEST(ErrorTestOfSensitivities, ContinuesInEveryBit) {
  sfdae::Sensitivities wanted = by({"p"}, true);
  wanted.scales = {0.1};
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU, SFDAE_METHOD_AUTOMATIC}) {
    SCOPED_TRACE(method);
    compare(course_of(van_der_pol(), solver_options(1e-5, method), wanted, {2.0, 0.0, 0.0}, 0.0, 40.0), 60);
  }
}

// ---- What is refused ---------------------------------------------------------------------------------------------

std::string refusal(sfdae::Solver& solver, const std::vector<double>& checkpoint) {
  try {
    solver.restore_checkpoint(checkpoint);
  } catch (const sfdae::Error& error) {
    EXPECT_EQ(error.status(), SFDAE_ILLEGAL_ARGUMENT) << error.what();
    return error.what();
  }
  return "";
}

Course of_van_der_pol(int method, const sfdae::Sensitivities& wanted) {
  return course_of(van_der_pol(), solver_options(1e-5, method), wanted, {2.0, 0.0, 0.0}, 0.0, 40.0);
}

std::vector<double> checkpoint_of(const Course& course) {
  sfdae::Solver solver = course.solver();
  Point point{course.from, course.x, {}};
  solver.start(point, course.to);
  solver.advance(0.3 * course.to, point);
  return solver.save_checkpoint();
}

TEST_P(SensitivityCheckpoints, AreThoseOfTheSameSensitivities) {
  sfdae::NonlinearProblem problem(2, 2);
  problem.equations = [](const Expression& t, auto x, auto xdot, auto F) {
    F[0] = xdot[0] + sfdae::parameter(t, "p", 1.0) * x[0] * x[0];
    F[1] = x[1] - sfdae::parameter(t, "q", 2.0) * x[0] - sfdae::parameter(t, "r", 0.0);
  };
  const auto with = [&](const sfdae::Sensitivities& wanted) {
    return course_of(problem, solver_options(1e-6, GetParam()), wanted, {1.0, 2.0}, 0.0, 5.0);
  };
  const std::vector<double> of_both = checkpoint_of(with(by({"p", "q"}))), of_none = checkpoint_of(with(by({})));
  EXPECT_EQ(of_none.size() < of_both.size(), true);
  for (const auto& others : {std::vector<std::string>{"q", "p"}, {"p"}, {"p", "q", ""}, {"p", "r"}, {}}) {
    sfdae::Solver solver = with(by(others)).solver();
    EXPECT_NE(refusal(solver, of_both).find("2 sensitivities, by p, q: call sfdae_set_sensitivities"),
              std::string::npos);
  }
  sfdae::Solver solver = with(by({"p", "q"})).solver();
  EXPECT_NE(refusal(solver, of_none).find("no sensitivities: call sfdae_set_sensitivities with count = 0"),
            std::string::npos);
  EXPECT_EQ(refusal(solver, of_both), "");
  // Other options of S, such as their directions, may differ: they are for starts.
  sfdae::Sensitivities moved = by({"p", "q"});
  moved.directions = Matrix(2, 2);
  moved.directions(0, 1) = 1.0;
  sfdae::Solver other = with(moved).solver();
  EXPECT_EQ(refusal(other, of_both), "");
  EXPECT_EQ(other.sensitivity_statistics().count, 2);
}

TEST_P(SensitivityCheckpoints, AreRefusedWhereTheyAreDamaged) {
  const Course course = of_van_der_pol(GetParam(), by({"p"}));
  const std::vector<double> checkpoint = checkpoint_of(course);
  sfdae::Solver solver = course.solver();
  Point point{course.from, course.x, {}};
  solver.start(point, course.to);
  solver.advance(1.0, point);
  const std::vector<double> S = entries(solver.sensitivities(1.0).S);
  for (std::size_t byte = 0; byte < 8 * checkpoint.size(); byte += 3) {
    std::vector<double> damaged = checkpoint;
    const std::uint64_t word = std::bit_cast<std::uint64_t>(damaged[byte / 8]);
    damaged[byte / 8] = std::bit_cast<double>(word ^ (std::uint64_t{0xff} << (8 * (byte % 8))));
    ASSERT_NE(refusal(solver, damaged), "") << byte;
  }
  for (std::size_t length = 0; length < checkpoint.size(); ++length)
    ASSERT_NE(refusal(solver, {checkpoint.begin(), checkpoint.begin() + std::ptrdiff_t(length)}), "");
  // The integration under way goes on.
  EXPECT_EQ(entries(solver.sensitivities(1.0).S), S);
  sfdae::Solver plain = course.solver();
  Point same{course.from, course.x, {}};
  plain.start(same, course.to);
  plain.advance(1.0, same);
  expect_same_sensitivities(plain, solver, 1.0, true);
  solver.advance(30.0, point);
  plain.advance(30.0, same);
  EXPECT_EQ(point.x, same.x);
  expect_same_sensitivities(plain, solver, 30.0, true);
}

// Wrong numbers with a checksum that fits, in what there is beside x: refused, or taken where any number will do.
TEST_P(SensitivityCheckpoints, AreReadWithCare) {
  constexpr std::size_t checksum = 2, first_parameter = 3;
  const auto courses = [](const sfdae::Sensitivities& wanted) {
    return std::vector<Course>{
        course_of(van_der_pol(), solver_options(1e-5, GetParam()), wanted, {2.0, 0.0, 0.0}, 0.0, 40.0),
        course_of(chain_of_rods(3), solver_options(1e-4, GetParam()), wanted, start_of_chain(3), 0.0, 1.0),
        course_of(diffusion(6), solver_options(1e-4, GetParam()), wanted, std::vector<double>(12, 0.0), 0.0, 3.0)};
  };
  const std::vector<Course> with = courses(by({"p"})), without = courses(by({}));
  for (std::size_t c = 0; c < with.size(); ++c) {
    const std::vector<double> checkpoint = checkpoint_of(with[c]);
    // The number of parameters and their own come first, S and what belongs to it last.
    const std::size_t of_x = checkpoint_of(without[c]).size() + 2;
    ASSERT_GT(checkpoint.size(), of_x);
    sfdae::Solver solver = with[c].solver();
    long refused = 0;
    const auto restore_with = [&](std::size_t k, double wrong) {
      std::vector<double> damaged = checkpoint;
      damaged[k] = wrong;
      sfdae::core::WordHash hash;
      hash.add(damaged.data() + checksum + 1, damaged.size() - checksum - 1);
      damaged[checksum] = static_cast<double>(hash.value() >> 12);
      try {
        solver.restore_checkpoint(damaged);
      } catch (const sfdae::Error& error) {
        EXPECT_EQ(error.status(), SFDAE_ILLEGAL_ARGUMENT) << k << ": " << error.what();
        ++refused;
      }
    };
    for (double wrong : {-2.0, -1.0, 0.0, 0.5, 3.0, 70000.0, 1e300, std::numeric_limits<double>::quiet_NaN()}) {
      for (std::size_t k : {first_parameter, first_parameter + 1})
        if (wrong != checkpoint[k]) restore_with(k, wrong);
      for (std::size_t k = of_x; k < checkpoint.size(); ++k) restore_with(k, wrong);
    }
    EXPECT_GT(refused, static_cast<long>(checkpoint.size() - of_x));
    solver.restore_checkpoint(checkpoint);
    Point point{};
    point.x.resize(std::size_t(solver.num_unknowns()));
    EXPECT_EQ(solver.advance(0.5 * with[c].to, point), SFDAE_OK);
  }
}

}  // namespace
