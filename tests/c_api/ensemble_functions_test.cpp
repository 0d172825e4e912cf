// Ensembles of problems with tables and functions of the user's, which all threads share.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "ensemble_problems.h"
#include "exp_sin.h"

namespace sfdae::test {
namespace {

constexpr int instances = 5;
const ExternalFunction wave("wave", 2, exp_sin);

// q'' = lambda G, 0 = q1 + 0.2 wave(c q1, q2) - sin t, and a force from a table: mu = 2.
NonlinearProblem shaken(bool is_external = true) {
  NonlinearProblem problem(5, 5);
  problem.equations = [is_external](const auto& t, auto x, auto xdot, auto F) {
    const Expression a = parameter(t, "c", 0.3) * x[0], b = x[1];
    const Expression constraint = x[0] + 0.2 * (is_external ? wave(a, b) : exp(a) * sin(b)) - sin(t);
    for (int i = 0; i < 2; ++i) {
      F[i] = xdot[i] - x[i + 2];
      F[i + 2] = xdot[i + 2] + x[4] * derivative(constraint, x[i]);
    }
    F[3] = F[3] - table(t, 3, {-1.0, 0.0, 0.5, 1.0, 2.0}, {0.0, 1.0, 0.0, -1.0, 0.0});
    F[4] = constraint;
  };
  return problem;
}

// The same constraint in a mechanical system, whose stages are evaluated eight points at a time.
MultibodyProblem shaken_body() {
  MultibodyProblem problem(2, 1);
  problem.equations = [](const auto& t, auto q, auto v, auto to) {
    const Expression c = parameter(t, "c", 0.3);
    to.M(0, 0) = to.M(1, 1) = 1.0;
    to.f[0] = -wave(0.1 * v[0], q[0]);
    to.f[1] = table(t, 3, {-1.0, 0.0, 0.5, 1.0, 2.0}, {0.0, 1.0, 0.0, -1.0, 0.0});
    to.g[0] = q[0] + 0.2 * wave(c * q[0], q[1]) - sin(t);
  };
  return problem;
}

// x1' = x2 - wave(c t, t) x1, 0 = x2 - wave(t, c): linear.
NonlinearProblem linear_waves() {
  NonlinearProblem problem(2, 2);
  problem.equations = [](const auto& t, auto x, auto xdot, auto F) {
    const Expression c = parameter(t, "c", 0.3);
    F[0] = xdot[0] - x[1] + wave(c * t, t) * x[0];
    F[1] = x[1] - wave(t, c);
  };
  return problem;
}

Ensemble of_c(int unknowns) {
  Ensemble ensemble = ensemble_of({"c"}, unknowns, instances);
  for (int i = 0; i < instances; ++i) {
    ensemble.parameters(0, i) = 0.1 + 0.1 * i;
    if (unknowns > 1) ensemble.x0(1, i) = 0.05 * i;
  }
  return ensemble;
}

struct Subject {
  const char* name;
  AnyProblem problem;
  int unknowns;
};

TEST(EnsembleOfFunctions, EqualsSolversOfTheirOwnToTheLastBit) {
  for (const Subject& subject :
       {Subject{"nonlinear", shaken(), 5}, {"multibody", shaken_body(), 5}, {"linear", linear_waves(), 2}})
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
      SCOPED_TRACE(subject.name);
      Options options;
      options.method = method;
      options.rtol = options.atol = 1e-4;
      Ensemble ensemble = of_c(subject.unknowns);
      std::vector<Outcome> alone;
      for (int i = 0; i < instances; ++i) {
        alone.push_back(solved_alone(subject.problem, options, ensemble, i));
        EXPECT_EQ(alone.back().x.size(), ensemble.times.size() * static_cast<std::size_t>(subject.unknowns))
            << alone.back().message;
      }
      Solver solver = solver_of(subject.problem, options);
      for (const int threads : thread_counts) {
        ensemble.threads = threads;
        const EnsembleSolution solution = solver.solve_ensemble(ensemble);
        for (int i = 0; i < instances; ++i)
          expect_same(outcome_of(solution, i), alone[static_cast<std::size_t>(i)], i);
      }
    }
}

TEST(EnsembleOfFunctions, IsThatOfTheFormulas) {
  Options options;
  options.rtol = options.atol = 1e-8;
  Ensemble ensemble = of_c(5);
  ensemble.threads = 3;
  Solver external(shaken(true), options), written(shaken(false), options);
  const EnsembleSolution is = external.solve_ensemble(ensemble), should_be = written.solve_ensemble(ensemble);
  ASSERT_EQ(is.num_failed, 0);
  for (int i = 0; i < instances; ++i)
    for (int j = 0; j < 4; ++j) {  // what is differentiated
      const int last = static_cast<int>(ensemble.times.size()) - 1;
      EXPECT_NEAR(is.x(i, last)[j], should_be.x(i, last)[j], 1e-6) << "instance " << i << ", x" << j;
    }
}

// x' = c f(x), f = 1 up to x = 1 and not to be evaluated beyond: c t > 1 is out of reach. Nothing is evaluated after
// the last output.
Options up_to_the_end(const Ensemble& ensemble) {
  Options options;
  options.use_stop_time = 1;
  options.stop_time = ensemble.times.back();
  return options;
}

NonlinearProblem fenced(const ExternalFunction& f) {
  NonlinearProblem problem(1, 1);
  problem.equations = [&f](const auto& t, auto x, auto xdot, auto F) {
    F[0] = xdot[0] - parameter(t, "c", 0.3) * f(x[0]);
  };
  return problem;
}

TEST(EnsembleOfFunctions, FailsWhereTheFunctionDoesAndNowhereElse) {
  struct Case {
    int code, status;
  };
  for (const Case& c : {Case{1, SFDAE_CALLBACK_FAILED}, {-3, SFDAE_CALLBACK_STOPPED}}) {
    const ExternalFunction f("fence", 1, [&c](int order, ConstVectorRef x, VectorRef derivatives) {
      if (x[0] > 1.0) return c.code;
      if (order == 0) derivatives[0] = 1.0;
      return 0;
    });
    const NonlinearProblem problem = fenced(f);
    Ensemble ensemble = of_c(1);
    for (int i = 0; i < instances; ++i) ensemble.parameters(0, i) = i % 2 == 0 ? 0.4 : 0.9 + 0.1 * i;
    std::vector<Outcome> alone;
    for (int i = 0; i < instances; ++i) {
      alone.push_back(solved_alone(problem, up_to_the_end(ensemble), ensemble, i));
      EXPECT_EQ(alone.back().status, i % 2 == 0 ? SFDAE_OK : c.status) << alone.back().message;
      EXPECT_EQ(alone.back().message.find("fence(") != std::string::npos, i % 2 == 1) << alone.back().message;
    }
    Solver solver(problem, up_to_the_end(ensemble));
    for (const int threads : thread_counts) {
      ensemble.threads = threads;
      const EnsembleSolution solution = solver.solve_ensemble(ensemble);
      EXPECT_EQ(solution.num_failed, instances / 2);
      for (int i = 0; i < instances; ++i) expect_same(outcome_of(solution, i), alone[static_cast<std::size_t>(i)], i);
    }
  }
}

TEST(EnsembleOfFunctions, SaysWhichOrderIsMissing) {
  const ExternalFunction f("line", 1, [](int order, ConstVectorRef x, VectorRef derivatives) {
    derivatives[0] = x[0];
    return order == 0 ? 0 : SFDAE_ORDER_NOT_AVAILABLE;
  });
  Ensemble ensemble = of_c(1);
  ensemble.threads = 3;
  Solver solver(fenced(f));
  const EnsembleSolution solution = solver.solve_ensemble(ensemble);
  EXPECT_EQ(solution.num_failed, instances);
  for (std::size_t i = 0; i < instances; ++i) {
    EXPECT_EQ(solution.statuses[i], SFDAE_ORDER_MISSING);
    EXPECT_NE(solution.messages[i].find("line has no derivatives of order 1"), std::string::npos)
        << solution.messages[i];
  }
}

// No exception crosses the library: the instances that it concerns stop.
TEST(EnsembleOfFunctions, MakesExceptionsStatuses) {
  std::atomic<int> thrown{0};
  const ExternalFunction f("thrower", 1, [&thrown](int order, ConstVectorRef x, VectorRef derivatives) {
    if (x[0] > 1.0) {
      ++thrown;
      throw std::runtime_error("too far");
    }
    if (order == 0) derivatives[0] = 1.0;
    return 0;
  });
  Ensemble ensemble = of_c(1);
  for (int i = 0; i < instances; ++i) ensemble.parameters(0, i) = i == 4 ? 2.0 : 0.4;
  ensemble.threads = 3;
  Solver solver(fenced(f), up_to_the_end(ensemble));
  const EnsembleSolution solution = solver.solve_ensemble(ensemble);
  EXPECT_EQ(solution.num_failed, 1);
  EXPECT_EQ(solution.statuses[4], SFDAE_CALLBACK_STOPPED);
  EXPECT_GT(thrown, 0);
}

}  // namespace
}  // namespace sfdae::test
