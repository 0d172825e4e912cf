// SPDX-License-Identifier: BSD-3-Clause
//
// The C++ interface: ownership, exceptions and that every function of the C API is reached.
//
//     x1' = x2,   x2' = -x1,   0 = x3 - x2 - t        mu = 0, d = 2, a = 1
//     x = (cos t, -sin t, t - sin t)

#include <sfdae/sfdae.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <type_traits>
#include <vector>

namespace {

using sfdae::MatrixRef;
using sfdae::VectorRef;

static_assert(!std::is_copy_constructible_v<sfdae::Solver> && !std::is_copy_assignable_v<sfdae::Solver>);
static_assert(std::is_nothrow_move_constructible_v<sfdae::Solver> &&
              std::is_nothrow_move_assignable_v<sfdae::Solver>);
static_assert(std::is_copy_constructible_v<sfdae::LinearProblem> && std::is_copy_constructible_v<sfdae::Options>);
static_assert(!std::is_constructible_v<sfdae::MatrixFunction, int>);
static_assert(!std::is_constructible_v<sfdae::MatrixFunction, void (*)(double)>);

sfdae::LinearProblem oscillator() {
  sfdae::LinearProblem problem(3, 3);
  problem.E = [](double, int order, MatrixRef E) {
    if (order == 0) E(0, 0) = E(1, 1) = 1;
  };
  problem.A = [](double, int order, MatrixRef A) {
    if (order == 0) A(0, 1) = 1, A(1, 0) = -1, A(2, 1) = -1, A(2, 2) = 1;
  };
  problem.f = [](double t, int order, VectorRef f) {
    if (order < 2) f[2] = order == 0 ? -t : -1;
  };
  return problem;
}

sfdae::Point start_point() { return {0.0, {1.0, 0.0, 0.0}, {}}; }

// Within 10 times the default tolerances.
void expect_exact(const sfdae::Point& point) {
  const double t = point.t;
  const double exact[] = {std::cos(t), -std::sin(t), t - std::sin(t)};
  ASSERT_EQ(point.x.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(point.x[i], exact[i], 10 * (1e-6 * std::abs(exact[i]) + 1e-6));
}

template <class Call>
int status_of_call(Call call) {
  try {
    return call();
  } catch (const sfdae::Error& error) {
    EXPECT_STRNE(error.what(), "");
    return error.status();
  }
}

TEST(Solver, SolvesForwardAndBackward) {
  sfdae::Solver solver(oscillator());
  sfdae::Point point = start_point();
  EXPECT_EQ(solver.start(point, 4.0), SFDAE_OK);
  EXPECT_NEAR(point.xdot[0], 0, 1e-12);
  EXPECT_NEAR(point.xdot[1], -1, 1e-12);
  for (int k = 1; k <= 4; ++k) {
    EXPECT_EQ(solver.advance(k, point), SFDAE_OK);
    EXPECT_EQ(point.t, k);
    expect_exact(point);
  }
  EXPECT_EQ(solver.start(point, 0.0), SFDAE_OK);
  EXPECT_EQ(solver.advance(2.0, point), SFDAE_OK);
  expect_exact(point);
}

TEST(Solver, AdvanceNeedsNoSizes) {
  sfdae::Solver solver(oscillator());
  sfdae::Point point = start_point();
  solver.start(point, 1.0);
  sfdae::Point reached;
  solver.advance(1.0, reached);
  expect_exact(reached);
  EXPECT_EQ(reached.xdot.size(), 3u);
}

TEST(Solver, StepsOneByOne) {
  sfdae::Solver solver(oscillator());
  sfdae::Point point = start_point();
  solver.start(point, 1.0);
  long steps = 0;
  while (solver.step(1.0, point) == SFDAE_STEP_TAKEN) {
    EXPECT_EQ(solver.statistics().steps, ++steps);
    expect_exact(point);
  }
  EXPECT_EQ(point.t, 1.0);
  EXPECT_GT(steps, 1);
}

TEST(Solver, KeepsItsCallbacksWhenItMoves) {
  auto counter = std::make_shared<int>(0);
  std::vector<sfdae::Solver> solvers;
  sfdae::Point point = start_point();
  {
    sfdae::LinearProblem problem = oscillator();
    problem.A = [counter, A = problem.A](double t, int order, MatrixRef matrix) {
      ++*counter;
      return A.call(t, order, matrix);
    };
    sfdae::Options options;
    options.monitor = [counter](const sfdae::Progress&) {
      ++*counter;
      return false;
    };
    sfdae::Solver solver(std::move(problem), options);
    solver.start(point, 2.0);
    solver.advance(0.5, point);
    solvers.push_back(std::move(solver));
    EXPECT_EQ(solver.get(), nullptr);
  }
  solvers.emplace_back(oscillator());
  solvers.emplace_back(oscillator());  // the vector grows and moves its solvers
  const int before = *counter;
  solvers[0].advance(1.0, point);
  expect_exact(point);
  EXPECT_GT(*counter, before);

  solvers[1] = std::move(solvers[0]);  // frees what was there
  solvers[1].advance(2.0, point);
  expect_exact(point);
  EXPECT_GT(counter.use_count(), 1);
  solvers.clear();
  EXPECT_EQ(counter.use_count(), 1);  // nothing is kept
}

struct LinearMishap : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Throws in the function, at the call and in the phase wanted.
struct Thrower {
  char function = 0;
  int countdown = 0;
  void operator()(char name) {
    if (name == function && countdown-- == 0) throw LinearMishap("no value");
  }
};

TEST(Solver, PassesOnExceptionsFromEveryCallAndGoesOn) {
  for (char function : {'E', 'A', 'f', 'm'})
    for (int call = 0;; ++call) {
      auto thrower = std::make_shared<Thrower>();
      sfdae::LinearProblem problem = oscillator();
      problem.E = [thrower, inner = problem.E](double t, int order, MatrixRef E) {
        (*thrower)('E');
        return inner.call(t, order, E);
      };
      problem.A = [thrower, inner = problem.A](double t, int order, MatrixRef A) {
        (*thrower)('A');
        return inner.call(t, order, A);
      };
      problem.f = [thrower, inner = problem.f](double t, int order, VectorRef f) {
        (*thrower)('f');
        return inner.call(t, order, f);
      };
      sfdae::Options options;
      options.monitor = [thrower](const sfdae::Progress&) {
        (*thrower)('m');
        return false;
      };
      sfdae::Solver solver(problem, options);
      thrower->function = function;
      thrower->countdown = call;
      bool thrown = false;
      try {
        sfdae::Point point = start_point();
        solver.analyze(0.0, 1.0);
        solver.start(point, 1.0);
        solver.advance(1.0, point);
        solver.check_derivatives(0.5, 1);
      } catch (const LinearMishap& mishap) {
        thrown = true;
        EXPECT_STREQ(mishap.what(), "no value");
      }
      thrower->function = 0;
      sfdae::Point point = start_point();
      ASSERT_EQ(solver.start(point, 1.0), SFDAE_OK);
      ASSERT_EQ(solver.advance(1.0, point), SFDAE_OK);
      expect_exact(point);
      if (!thrown) {
        EXPECT_GT(call, 0);
        break;
      }
    }
}

TEST(Solver, PassesOnAnythingThatIsThrown) {
  sfdae::LinearProblem problem = oscillator();
  problem.f = [](double, int, VectorRef) { throw 42; };
  sfdae::Solver solver(std::move(problem));
  sfdae::Point point = start_point();
  EXPECT_THROW(solver.start(point, 1.0), int);
}

TEST(Solver, KeepsTheLastPointWhenTheMonitorThrows) {
  sfdae::Options options;
  options.monitor = [](const sfdae::Progress& progress) -> bool {
    if (progress.t > 0.5) throw LinearMishap("enough");
    return false;
  };
  sfdae::Solver solver(oscillator(), options);
  sfdae::Point point = start_point();
  solver.start(point, 1.0);
  EXPECT_THROW(solver.advance(1.0, point), LinearMishap);
  EXPECT_GT(point.t, 0.5);
  expect_exact(point);
  options.monitor = nullptr;
  solver.set_options(options);
  EXPECT_EQ(solver.advance(2.0, point), SFDAE_OK);
  expect_exact(point);
}

TEST(Solver, MonitorStops) {
  sfdae::Options options;
  options.monitor = [](const sfdae::Progress& progress) { return progress.steps == 3; };
  sfdae::Solver solver(oscillator(), options);
  sfdae::Point point = start_point();
  solver.start(point, 4.0);
  EXPECT_EQ(solver.advance(4.0, point), SFDAE_STOPPED);
  EXPECT_NE(solver.message(), "");
  EXPECT_EQ(solver.statistics().steps, 3);
  EXPECT_EQ(solver.advance(4.0, point), SFDAE_OK);
  EXPECT_EQ(solver.message(), "");
  expect_exact(point);
}

TEST(Solver, StopRequestsAreObeyed) {
  sfdae::Solver solver(oscillator());
  sfdae::Point point = start_point();
  solver.request_stop();
  EXPECT_EQ(solver.start(point, 1.0), SFDAE_STOPPED);
  EXPECT_EQ(solver.start(point, 1.0), SFDAE_OK);
}

TEST(Solver, IsBusyInItsOwnCallbacks) {
  sfdae::Solver* inside = nullptr;
  sfdae::LinearProblem problem = oscillator();
  problem.f = [&inside](double, int, VectorRef) { inside->analyze(0.0, 1.0); };
  sfdae::Solver solver(std::move(problem));
  inside = &solver;
  sfdae::Point point = start_point();
  EXPECT_EQ(status_of_call([&] { return solver.start(point, 1.0); }), SFDAE_BUSY);
}

TEST(Solver, UnderstandsStatusCodesOfCallbacks) {
  int code = SFDAE_ORDER_NOT_AVAILABLE;
  sfdae::LinearProblem problem = oscillator();
  problem.A = [&code, A = problem.A](double t, int order, MatrixRef matrix) -> int {
    return code ? code : A.call(t, order, matrix);
  };
  sfdae::Solver solver(std::move(problem));
  sfdae::Point point = start_point();
  EXPECT_LT(status_of_call([&] { return solver.start(point, 1.0); }), 0);
  code = 1;
  EXPECT_EQ(status_of_call([&] { return solver.start(point, 1.0); }), SFDAE_CALLBACK_FAILED);
  code = -1;
  EXPECT_EQ(status_of_call([&] { return solver.start(point, 1.0); }), SFDAE_CALLBACK_STOPPED);
  code = 0;
  EXPECT_EQ(solver.start(point, 1.0), SFDAE_OK);
}

TEST(Solver, ThrowsErrorsThatExplain) {
  sfdae::LinearProblem problem = oscillator();
  problem.E = nullptr;
  EXPECT_EQ(status_of_call([&] { return sfdae::Solver(problem).set_options({}); }), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_NE(sfdae::Solver::check(problem), "");
  EXPECT_EQ(status_of_call([] { return sfdae::Solver(sfdae::LinearProblem(0, 0)).set_options({}); }),
            SFDAE_EMPTY_PROBLEM);

  sfdae::Options options;
  options.rtol = -1;
  EXPECT_NE(sfdae::Solver::check(oscillator(), options), "");
  EXPECT_EQ(status_of_call([&] { return sfdae::Solver(oscillator(), options).set_options({}); }),
            SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(sfdae::Solver::check(oscillator()), "");

  sfdae::Solver solver(oscillator());
  sfdae::Point point = start_point();
  EXPECT_EQ(status_of_call([&] { return solver.set_options(options); }), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(status_of_call([&] { return solver.advance(1.0, point); }), SFDAE_NOT_STARTED);
  EXPECT_EQ(status_of_call([&] { return solver.analyze(0.0, 0.0); }), SFDAE_ILLEGAL_ARGUMENT);
  EXPECT_EQ(status_of_call([&] { return solver.characteristics().strangeness_index; }), SFDAE_NOT_STARTED);
  point.x.resize(2);
  EXPECT_EQ(status_of_call([&] { return solver.start(point, 1.0); }), SFDAE_ILLEGAL_ARGUMENT);
}

TEST(Options, VectorsHaveOneEntryForEachUnknown) {
  sfdae::Options options;
  options.rtol_vector = {1e-6, 1e-6};
  EXPECT_NE(status_of_call([&] { return sfdae::Solver(oscillator(), options).set_options({}); }), SFDAE_OK);
  options.rtol_vector = {1e-6, 1e-6, 1e-6};
  options.atol_vector = {1e-6, 1e-6, 1e-6};
  options.initial_weights = {1, 1, 1e-3};
  options.initial_values = SFDAE_INITIAL_FIXED;
  options.fixed = {1, 1, 0};
  const sfdae::Options copy = options;
  options = sfdae::Options();
  EXPECT_TRUE(options.rtol_vector.empty());
  EXPECT_EQ(options.max_index, 5);

  sfdae::Solver solver(oscillator(), copy);
  sfdae::Point point{0.0, {1.0, 0.0, 7.0}, {}};
  EXPECT_EQ(solver.start(point, 1.0), SFDAE_OK);
  EXPECT_EQ(point.x[0], 1.0);
  EXPECT_EQ(point.x[1], 0.0);
  EXPECT_NEAR(point.x[2], 0.0, 1e-15);
  solver.advance(1.0, point);
  expect_exact(point);
}

TEST(Solver, IntegratesByEveryMethod) {
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU, SFDAE_METHOD_AUTOMATIC}) {
    sfdae::Options options;
    options.method = method;
    options.min_stages = options.max_stages = 5;
    sfdae::Solver solver(oscillator(), options);
    sfdae::Point point = start_point();
    solver.start(point, 2.0);
    EXPECT_EQ(solver.advance(2.0, point), SFDAE_OK);
    expect_exact(point);
    EXPECT_EQ(solver.statistics().last_order == 9, method != SFDAE_METHOD_BDF);
  }
  sfdae::Options options;
  options.max_stages = 6;
  EXPECT_NE(sfdae::Solver::check(oscillator(), options), "");
}

TEST(Solver, GoesOnFromACheckpointInEveryBit) {
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU, SFDAE_METHOD_AUTOMATIC}) {
    sfdae::Options options;
    options.method = method;
    sfdae::Solver solver(oscillator(), options);
    EXPECT_EQ(status_of_call([&] { return static_cast<int>(solver.save_checkpoint().size()); }), SFDAE_NOT_STARTED);
    sfdae::Point point = start_point(), copy;
    solver.start(point, 4.0);
    solver.advance(1.0, point);
    const std::vector<double> checkpoint = solver.save_checkpoint();
    solver.advance(3.0, point);

    sfdae::Solver other(oscillator(), options);
    EXPECT_EQ(other.restore_checkpoint(checkpoint), SFDAE_OK);
    EXPECT_EQ(other.advance(3.0, copy), SFDAE_OK);
    EXPECT_EQ(copy.t, point.t);
    EXPECT_EQ(copy.x, point.x);
    EXPECT_EQ(copy.xdot, point.xdot);
    EXPECT_EQ(other.save_checkpoint(), solver.save_checkpoint());

    std::vector<double> damaged = checkpoint;
    damaged.pop_back();
    EXPECT_EQ(status_of_call([&] { return other.restore_checkpoint(damaged); }), SFDAE_ILLEGAL_ARGUMENT);
    EXPECT_EQ(status_of_call([&] { return other.restore_checkpoint({}); }), SFDAE_ILLEGAL_ARGUMENT);
    // The integration under way goes on as if nothing had been asked.
    EXPECT_EQ(solver.advance(4.0, point), SFDAE_OK);
    EXPECT_EQ(other.advance(4.0, copy), SFDAE_OK);
    EXPECT_EQ(copy.x, point.x);
    EXPECT_EQ(copy.xdot, point.xdot);
  }
}

/// cos t falls through 1/2 at pi / 3; -sin t falls through x2' = -cos t where sin t = cos t, at pi / 4.
TEST(Solver, FindsEvents) {
  sfdae::Options options;
  options.rtol = options.atol = 1e-9;
  sfdae::Solver solver(oscillator(), options);
  sfdae::Point point = start_point();
  solver.start(point, 2.0);
  EXPECT_TRUE(solver.events().empty());
  const auto g = [](double, sfdae::ConstVectorRef x, sfdae::ConstVectorRef xdot, VectorRef values) {
    EXPECT_EQ(x.size(), 3);
    EXPECT_EQ(xdot.size(), 3);
    values[0] = x[0] - 0.5;
    values[1] = x[1] - xdot[1];
  };
  EXPECT_EQ(solver.set_events(2, g, {0, -1}), SFDAE_OK);
  sfdae::Solver moved = std::move(solver);
  EXPECT_EQ(moved.advance(2.0, point), SFDAE_EVENT);
  EXPECT_EQ(moved.events(), (std::vector<int>{0, -1}));
  EXPECT_NEAR(point.t, std::atan(1.0), 1e-6);
  EXPECT_EQ(moved.advance(2.0, point), SFDAE_EVENT);
  EXPECT_EQ(moved.events(), (std::vector<int>{-1, 0}));
  EXPECT_NEAR(point.t, std::acos(0.5), 1e-6);
  EXPECT_NEAR(point.x[0], 0.5, 1e-14);
  sfdae::Point between{point.t, {}, {}};
  EXPECT_EQ(moved.interpolate(between), SFDAE_OK);
  EXPECT_NEAR(between.x[0], 0.5, 1e-8);
  EXPECT_EQ(moved.set_events(0, nullptr), SFDAE_OK);
  EXPECT_EQ(moved.advance(4.0, point), SFDAE_OK);
  expect_exact(point);
}

TEST(Solver, PassesOnExceptionsOfEventFunctions) {
  sfdae::Solver solver(oscillator());
  sfdae::Point point = start_point();
  bool fails = true;
  EXPECT_THROW(solver.set_events(2, nullptr), sfdae::Error);
  EXPECT_THROW(solver.set_events(2, [](double, sfdae::ConstVectorRef, sfdae::ConstVectorRef, VectorRef) {}, {1}),
               sfdae::Error);
  solver.set_events(1, [&fails](double t, sfdae::ConstVectorRef, sfdae::ConstVectorRef, VectorRef g) {
    if (fails && t > 0.5) throw std::domain_error("as it happens");
    g[0] = t - 1.5;
    return 0;
  });
  solver.start(point, 2.0);
  EXPECT_THROW(solver.advance(2.0, point), std::domain_error);
  EXPECT_LE(point.t, 0.5);
  expect_exact(point);
  fails = false;
  EXPECT_EQ(solver.advance(2.0, point), SFDAE_EVENT);
  EXPECT_NEAR(point.t, 1.5, 4e-16);
}

TEST(LinearProblem, PrescribesComponents) {
  sfdae::LinearProblem problem(1, 2);  // x1' = x2, x2 = cos t, x1 = sin t
  problem.E = [](double, int order, MatrixRef E) { E(0, 0) = order == 0; };
  problem.A = [](double, int order, MatrixRef A) { A(0, 1) = order == 0; };
  problem.constant_E = problem.constant_A = true;
  problem.prescribed = {1};
  problem.prescribed_values = [](double t, int order, VectorRef values) {
    EXPECT_EQ(order, 0);
    EXPECT_EQ(values.size(), 1);
    std::fill(values.begin(), values.end(), std::cos(t));
  };
  sfdae::Solver solver(std::move(problem));
  sfdae::Point point{0.0, {0.0, 1.0}, {}};
  solver.start(point, 2.0);
  solver.advance(2.0, point);
  EXPECT_NEAR(point.x[0], std::sin(2.0), 10 * 2e-6);
  EXPECT_NEAR(point.x[1], std::cos(2.0), 1e-14);
  EXPECT_EQ(solver.characteristics().undetermined, 1);
}

TEST(LinearProblem, AcceptsFunctionsOfC) {
  sfdae::LinearProblem problem(1, 1);
  struct C {
    static void E(double, int order, MatrixRef E) { E(0, 0) = order == 0; }
    static int A(double, int order, MatrixRef A) {
      A(0, 0) = order == 0 ? -1 : 0;
      return 0;
    }
  };
  problem.E = C::E;
  problem.A = &C::A;
  sfdae::Solver solver(std::move(problem));
  sfdae::Point point{0.0, {1.0}, {}};
  solver.start(point, 1.0);
  solver.advance(1.0, point);
  EXPECT_NEAR(point.x[0], std::exp(-1), 10 * 2e-6);
}

TEST(Solver, LooksInside) {
  sfdae::Solver solver(oscillator());
  EXPECT_EQ(solver.analyze(0.0, 1.0), SFDAE_OK);
  const sfdae::Characteristics c = solver.characteristics();
  EXPECT_EQ(c.strangeness_index, 0);
  EXPECT_EQ(c.differential, 2);
  EXPECT_EQ(c.algebraic, 1);
  const std::vector<sfdae::Decision> decisions = solver.decisions();
  ASSERT_FALSE(decisions.empty());
  for (const sfdae::Decision& decision : decisions) EXPECT_EQ(decision.verdict, SFDAE_VERDICT_CLEAR);
  EXPECT_EQ(status_of_call([&] { return solver.change().new_algebraic; }), SFDAE_NOT_STARTED);

  sfdae::Point point{0.5, {1.0, 0.5, 9.0}, {}};
  EXPECT_EQ(solver.make_consistent(point), SFDAE_OK);
  EXPECT_NEAR(point.x[2], point.x[1] + 0.5, 1e-14);
  const sfdae::InitialReport initial = solver.initial_report();
  EXPECT_EQ(initial.t, 0.5);
  EXPECT_GT(initial.residual_before, 1);
  EXPECT_LT(initial.residual_after, 1e-14);

  EXPECT_NE(solver.report(), "");
  EXPECT_EQ(solver.report().find('\0'), std::string::npos);

  const sfdae::DerivativeArray array = solver.derivative_array(0.5, 1);  // M = [E 0; -A E]
  EXPECT_EQ(array.M.rows(), 6);
  EXPECT_EQ(array.M.columns(), 6);
  EXPECT_EQ(array.N.columns(), 3);
  EXPECT_EQ(array.M(0, 0), 1);
  EXPECT_EQ(array.M(3, 1), -1);
  EXPECT_EQ(array.M(4, 0), 1);
  EXPECT_EQ(array.M(4, 4), 1);
  EXPECT_EQ(array.N(0, 1), 1);
  EXPECT_EQ(array.g[2], -0.5);
  EXPECT_EQ(array.g[5], -1);
  for (int level : {-1, std::numeric_limits<int>::max()})
    EXPECT_EQ(status_of_call([&] { return solver.derivative_array(0.5, level).M.rows(); }), SFDAE_ILLEGAL_ARGUMENT);

  const sfdae::Projectors p = solver.projectors(0.5);
  EXPECT_EQ(p.Z1.rows(), 3);
  EXPECT_EQ(p.Z1.columns(), 2);
  EXPECT_EQ(p.Z2.columns(), 1);
  EXPECT_EQ(p.Z3.columns(), 0);
  EXPECT_EQ(p.T2.columns(), 2);
  EXPECT_NEAR(std::abs(p.Z2(2, 0)), 1, 1e-14);

  const sfdae::StrangenessFreeSystem s = solver.strangeness_free(0.5);
  EXPECT_EQ(s.E1.rows(), 2);
  EXPECT_EQ(s.A2.columns(), 3);
  EXPECT_NEAR(s.A2(0, 0) * point.x[0] + s.A2(0, 1) * point.x[1] + s.A2(0, 2) * point.x[2] + s.f2[0], 0, 1e-14);
  EXPECT_EQ(s.residual, 0);

  EXPECT_EQ(solver.check_derivatives(0.5, 1).suspicious, 0);
  EXPECT_GE(solver.certify(), 1e-3);
  EXPECT_STREQ(sfdae::version(), sfdae_version());
  EXPECT_STREQ(sfdae::status_name(SFDAE_BUSY), "SFDAE_BUSY");
}

}  // namespace
