// Ensembles: every instance as a solver of its own would solve it, whatever the number of threads.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "ensemble_problems.h"

namespace sfdae::test {
namespace {

double random_between(std::minstd_rand& generator, double low, double high) {
  return low + (high - low) * static_cast<double>(generator()) / static_cast<double>(std::minstd_rand::max());
}

Options options_of(int method) {
  Options options;
  options.method = method;
  options.rtol = options.atol = 1e-5;
  return options;
}

// Instances with random parameters, and start values that belong to them, of problems of all kinds.
struct Subject {
  std::string name;
  AnyProblem problem;
  Ensemble ensemble;
};

// Every third one is held horizontally: the start values are consistent as they are.
Ensemble pendula(int instances) {
  std::minstd_rand generator(7);
  Ensemble ensemble = ensemble_of({"L", "g"}, 5, instances);
  for (int i = 0; i < instances; ++i) {
    const double L = random_between(generator, 0.5, 2.0), angle = random_between(generator, -2.0, 2.0);
    ensemble.parameters(0, i) = L;
    ensemble.parameters(1, i) = random_between(generator, 1.0, 20.0);
    ensemble.x0(0, i) = i % 3 == 2 ? L : L * std::sin(angle);
    ensemble.x0(1, i) = i % 3 == 2 ? 0.0 : -L * std::cos(angle);
  }
  return ensemble;
}

Ensemble waves(int instances) {
  std::minstd_rand generator(11);
  Ensemble ensemble = ensemble_of({"a", "w"}, 3, instances);
  for (int i = 0; i < instances; ++i) {
    ensemble.parameters(0, i) = random_between(generator, 0.1, 3.0);
    ensemble.parameters(1, i) = random_between(generator, 0.5, 2.0);
    ensemble.x0(2, i) = random_between(generator, -1.0, 1.0);
  }
  return ensemble;
}

// Every third one has no capacity.
Ensemble capacities(int instances) {
  std::minstd_rand generator(13);
  Ensemble ensemble = ensemble_of({"p", "q"}, 2, instances);
  for (int i = 0; i < instances; ++i) {
    ensemble.parameters(0, i) = i % 3 == 1 ? 0.0 : random_between(generator, 0.5, 2.0);
    ensemble.parameters(1, i) = random_between(generator, 0.5, 1.5);
    ensemble.x0(0, i) = random_between(generator, -1.0, 1.0);
    ensemble.x0(1, i) = random_between(generator, 0.0, 1.0);
  }
  return ensemble;
}

std::vector<Subject> subjects(int instances) {
  return {{"multibody pendulum", multibody_pendulum(), pendula(instances)},
          {"raw pendulum", raw_pendulum(), pendula(instances)},
          {"time-varying linear", time_varying(), waves(instances)},
          {"nonlinear, ranks change", fading_capacity(), capacities(instances)},
          {"constant linear, ranks change", linear_capacity(), capacities(instances)}};
}

TEST(Ensemble, EqualsSolversOfTheirOwnToTheLastBit) {
  constexpr int instances = 11;
  for (const Subject& subject : subjects(instances))
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
      SCOPED_TRACE(subject.name + (method == SFDAE_METHOD_BDF ? " by BDF" : " by Radau"));
      std::vector<Outcome> alone;
      for (int i = 0; i < instances; ++i)
        alone.push_back(solved_alone(subject.problem, options_of(method), subject.ensemble, i));
      Solver solver = solver_of(subject.problem, options_of(method));
      for (const int threads : thread_counts) {
        SCOPED_TRACE(threads);
        Ensemble ensemble = subject.ensemble;
        ensemble.threads = threads;
        const EnsembleSolution solution = solver.solve_ensemble(ensemble);
        EXPECT_EQ(solution.status, SFDAE_OK) << solver.message();
        EXPECT_LE(solution.num_threads, threads);
        for (int i = 0; i < instances; ++i)
          expect_same(outcome_of(solution, i), alone[static_cast<std::size_t>(i)], i);
      }
    }
}

/// Where start values are consistent the jet of the analysis is the start.
TEST(Ensemble, EqualsSolversOfTheirOwnFromConsistentValues) {
  constexpr int instances = 12;
  Ensemble ensemble = pendula(instances);
  for (int i = 0; i < instances; ++i) ensemble.x0(2, i) = 0.1 * i, ensemble.x0(3, i) = 0.05;
  Solver solver(raw_pendulum(), options_of(SFDAE_METHOD_RADAU));
  const EnsembleSolution first = solver.solve_ensemble(ensemble);
  for (int i = 0; i < instances; ++i)
    for (int j = 0; j < 5; ++j) ensemble.x0(j, i) = first.x(i, 1)[j];
  const EnsembleSolution solution = solver.solve_ensemble(ensemble);
  for (int i = 0; i < instances; ++i)
    expect_same(outcome_of(solution, i), solved_alone(raw_pendulum(), options_of(SFDAE_METHOD_RADAU), ensemble, i),
                i);
}

/// Energy is kept, and length. Over 1.5 units of time errors of the tolerances grow by less than 1000.
TEST(Ensemble, SwingsPendulaAsNewtonSays) {
  Ensemble ensemble = pendula(5);
  Solver solver(multibody_pendulum(), options_of(SFDAE_METHOD_RADAU));
  const EnsembleSolution solution = solver.solve_ensemble(ensemble);
  for (int i = 0; i < 5; ++i) {
    const double L = ensemble.parameters(0, i), g = ensemble.parameters(1, i);
    for (int k = 0; k < 5; ++k) {
      const ConstVectorRef x = solution.x(i, k);
      EXPECT_NEAR(std::hypot(x[0], x[1]), L, 1e-12);
      EXPECT_NEAR(0.5 * (x[2] * x[2] + x[3] * x[3]) + g * x[1], g * ensemble.x0(1, i), 1e-2) << i << ", " << k;
    }
  }
}

// ---- Index analyses --------------------------------------------------------------------------------------------

TEST(Ensemble, AnalyzesOnceWhereRanksAreTheSame) {
  for (const Subject& subject : subjects(8)) {
    SCOPED_TRACE(subject.name);
    const bool changes = subject.name.find("ranks change") != std::string::npos;
    Solver solver = solver_of(subject.problem, options_of(SFDAE_METHOD_BDF));
    // Two more, 1, 4, 7, have other ranks.
    EXPECT_EQ(solver.solve_ensemble(subject.ensemble).num_analyses, changes ? 4 : 1);
  }
}

TEST(Ensemble, TakesTheAnalysisOfTheSolverAsPrecedent) {
  Solver solver(raw_pendulum());
  Point point{0.0, {1.0, 0.0, 0.0, 0.0, 0.0}, {}};
  solver.analyze_at(point, 1.0);
  EXPECT_EQ(solver.solve_ensemble(pendula(6)).num_analyses, 0);
}

/// w t x2' = x1 + 1, 0 = x2 - sin t: x1 = w t cos t - 1. For w = 0 the strangeness index is 0, else 1; at t = 0 ranks
/// are the same, so that only what happens beyond shows that the precedent does not hold.
TEST(Ensemble, AnalyzesAnewWhereTheStartAloneIsMisleading) {
  NonlinearProblem problem(2, 2);
  problem.linear_equations = [](const auto& t, auto E, auto A, auto f) {
    E(0, 1) = parameter(t, "w", 0.0) * t;
    A(0, 0) = A(1, 1) = 1.0;
    f[0] = 1.0, f[1] = -sin(t);
  };
  Ensemble ensemble = ensemble_of({"w"}, 2, 4);
  for (int i = 0; i < 4; ++i) ensemble.parameters(0, i) = i;
  Solver solver(problem);
  const EnsembleSolution solution = solver.solve_ensemble(ensemble);
  EXPECT_EQ(solution.num_analyses, 4);
  for (int i = 0; i < 4; ++i) {
    expect_same(outcome_of(solution, i), solved_alone(problem, {}, ensemble, i), i);
    EXPECT_NEAR(solution.x(i, 3)[0], i * std::cos(1.0) - 1.0, 1e-12);
  }
}

TEST(Ensemble, LeavesTheSolverAsItIs) {
  const auto reached = [](bool disturbed) {
    Solver solver(raw_pendulum());
    solver.set_parameter("L", 1.25);
    Point point{0.0, {0.75, -1.0, 0.0, 0.0, 0.0}, {}};
    solver.start(point, 2.0);
    solver.advance(0.5, point);
    if (disturbed) {
      solver.solve_ensemble(pendula(4));
      EXPECT_EQ(solver.parameter("L"), 1.25);
      EXPECT_EQ(solver.parameter("g"), 9.81);
    }
    solver.advance(2.0, point);
    return point.x;
  };
  EXPECT_TRUE(same_bits(reached(true), reached(false)));
}

TEST(Ensemble, HasParametersOfTheSolverWhereItsOwnAreNotNamed) {
  Ensemble ensemble = pendula(1), named = ensemble;
  ensemble.parameter_names = {"L"};
  ensemble.parameters = Matrix(1, 1);
  ensemble.parameters(0, 0) = named.parameters(0, 0);
  Solver solver(multibody_pendulum());
  solver.set_parameter("g", named.parameters(1, 0));
  const Outcome by_solver = outcome_of(solver.solve_ensemble(ensemble), 0);
  expect_same(by_solver, outcome_of(solver.solve_ensemble(named), 0), 0);
}

// ---- Options ---------------------------------------------------------------------------------------------------

TEST(Ensemble, KeepsFixedComponentsAndWeights) {
  Ensemble ensemble = pendula(2);
  for (int i = 0; i < 2; ++i) ensemble.x0(0, i) *= 0.99;  // off the circle
  for (const bool fixed : {true, false}) {
    Options options = options_of(SFDAE_METHOD_BDF);
    if (fixed) options.initial_values = SFDAE_INITIAL_FIXED, options.fixed = {1, 0, 0, 0, 0};
    else options.initial_weights = {1.0, 0.01, 1.0, 1.0, 1.0};
    Solver solver(multibody_pendulum(), options);
    const EnsembleSolution solution = solver.solve_ensemble(ensemble);
    for (int i = 0; i < 2; ++i) {
      expect_same(outcome_of(solution, i), solved_alone(multibody_pendulum(), options, ensemble, i), i);
      if (fixed) {
        EXPECT_EQ(solution.x(i, 0)[0], ensemble.x0(0, i));
      }
    }
  }
}

TEST(Ensemble, IntegratesBackward) {
  Ensemble ensemble = pendula(3);
  ensemble.times = {-0.2, -1.0};
  Solver solver(raw_pendulum());
  const EnsembleSolution solution = solver.solve_ensemble(ensemble);
  for (int i = 0; i < 3; ++i) expect_same(outcome_of(solution, i), solved_alone(raw_pendulum(), {}, ensemble, i), i);
}

TEST(Ensemble, FollowsGuessesOfTheDerivative) {
  // x'^2 = p^2: x' = p or -p.
  NonlinearProblem problem(1, 1);
  problem.equations = [](const auto& t, auto, auto xdot, auto F) {
    const Expression p = parameter(t, "p", 1.0);
    F[0] = xdot[0] * xdot[0] - p * p;
  };
  Options options;
  options.xdot_is_guess = 1;
  Solver solver(problem, options);
  Ensemble ensemble;
  ensemble.x0 = ensemble.xdot0 = ensemble.parameters = Matrix(1, 4);
  ensemble.parameter_names = {"p"};
  ensemble.times = {1.0};
  for (int i = 0; i < 4; ++i) {
    ensemble.parameters(0, i) = 1.0 + i;
    ensemble.xdot0(0, i) = (i % 2 == 0 ? 1.1 : -0.9) * (1.0 + i);
  }
  const EnsembleSolution solution = solver.solve_ensemble(ensemble);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(solution.x(i, 0)[0], (i % 2 == 0 ? 1.0 : -1.0) * (1.0 + i), 1e-5);
}

// ---- Failures --------------------------------------------------------------------------------------------------

// x' = p x^2, 0 = q z - cos t: contradicts itself for q = 0.
NonlinearProblem singular_for_zero() {
  NonlinearProblem problem(2, 2);
  problem.equations = [](const auto& t, auto x, auto xdot, auto F) {
    const Expression p = parameter(t, "p", 1.0), q = parameter(t, "q", 1.0);
    F[0] = xdot[0] - p * x[0] * x[0];
    F[1] = q * x[1] - cos(t);
  };
  return problem;
}

/// x' = p x^2, x(0) = 1 becomes infinite at t = 1/p: outputs before that are kept.
TEST(Ensemble, FailsWhereItMustWithoutDisturbingOthers) {
  constexpr int instances = 9;
  Ensemble ensemble = ensemble_of({"p", "q"}, 2, instances);
  for (int i = 0; i < instances; ++i) {
    ensemble.parameters(0, i) = i == 2 ? 2.0 : 0.1;
    ensemble.parameters(1, i) = i == 5 ? 0.0 : 1.0;
    ensemble.x0(0, i) = i == 7 ? std::numeric_limits<double>::quiet_NaN() : 1.0;
  }
  ensemble.parameters(0, 8) = std::numeric_limits<double>::infinity();
  Solver solver(singular_for_zero());
  for (const int threads : thread_counts) {
    ensemble.threads = threads;
    const EnsembleSolution solution = solver.solve_ensemble(ensemble);
    EXPECT_EQ(solution.status, SFDAE_INSTANCES_FAILED);
    EXPECT_EQ(solution.num_failed, 4);
    EXPECT_NE(solver.message().find("4 of 9 instances failed, first of all instance 2"), std::string::npos)
        << solver.message();
    for (int i = 0; i < instances; ++i) {
      expect_same(outcome_of(solution, i), solved_alone(singular_for_zero(), {}, ensemble, i), i);
      const bool fails = i == 2 || i == 5 || i >= 7;
      EXPECT_EQ(solution.statuses[static_cast<std::size_t>(i)] < 0, fails) << i;
      EXPECT_EQ(solution.num_outputs[static_cast<std::size_t>(i)], i == 2 ? 3 : fails ? 0 : 5) << i;
      EXPECT_EQ(std::isnan(solution.x(i, 4)[0]), fails) << i;
    }
    EXPECT_EQ(solution.statuses[5], SFDAE_NO_CONSISTENT_VALUES) << solution.messages[5];
    EXPECT_EQ(solution.statuses[7], SFDAE_ILLEGAL_ARGUMENT);
    EXPECT_NE(solution.messages[8].find("\"p\" is inf"), std::string::npos) << solution.messages[8];
  }
}

TEST(Ensemble, SolvesOthersWhereTheFirstOneHasNoAnalysis) {
  Ensemble ensemble = ensemble_of({"p", "q"}, 2, 4);
  for (int i = 0; i < 4; ++i) {
    ensemble.parameters(0, i) = 0.1;
    ensemble.parameters(1, i) = i == 0 ? 0.0 : 1.0;
    ensemble.x0(0, i) = 1.0;
  }
  Solver solver(singular_for_zero());
  const EnsembleSolution solution = solver.solve_ensemble(ensemble);
  EXPECT_EQ(solution.num_failed, 1);
  for (int i = 0; i < 4; ++i)
    expect_same(outcome_of(solution, i), solved_alone(singular_for_zero(), {}, ensemble, i), i);
}

// x' = -p x^3 + y with y prescribed, which throws beyond a time.
NonlinearProblem driven(std::atomic<int>& calls, double until) {
  NonlinearProblem problem(1, 2);
  problem.equations = [](const auto& t, auto x, auto xdot, auto F) {
    F[0] = xdot[0] + parameter(t, "p", 1.0) * x[0] * x[0] * x[0] - x[1];
  };
  problem.prescribed = {1};
  problem.prescribed_values = [&calls, until](double t, int, VectorRef y) {
    ++calls;
    if (t > until) throw std::runtime_error("no more");
    y[0] = std::sin(t);
  };
  return problem;
}

TEST(Ensemble, AsksSeveralThreadsForPrescribedValues) {
  std::atomic<int> calls{0};
  constexpr int instances = 7;
  Ensemble ensemble = ensemble_of({"p"}, 2, instances);
  for (int i = 0; i < instances; ++i) ensemble.parameters(0, i) = 1.0 + i, ensemble.x0(0, i) = 0.1 * i;
  const NonlinearProblem problem = driven(calls, 10.0);
  Solver solver(problem);
  for (const int threads : thread_counts) {
    ensemble.threads = threads;
    const EnsembleSolution solution = solver.solve_ensemble(ensemble);
    for (int i = 0; i < instances; ++i)
      expect_same(outcome_of(solution, i), solved_alone(problem, {}, ensemble, i), i);
  }
}

TEST(Ensemble, MakesExceptionsOfPrescribedValuesStatuses) {
  std::atomic<int> calls{0};
  Ensemble ensemble = ensemble_of({"p"}, 2, 5);
  for (int i = 0; i < 5; ++i) ensemble.parameters(0, i) = 1.0;
  ensemble.threads = 3;
  Solver solver(driven(calls, 0.5));
  const EnsembleSolution solution = solver.solve_ensemble(ensemble);
  EXPECT_EQ(solution.num_failed, 5);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(solution.statuses[static_cast<std::size_t>(i)], SFDAE_CALLBACK_STOPPED);
    EXPECT_EQ(solution.num_outputs[static_cast<std::size_t>(i)], 3);
  }
}

TEST(Ensemble, OfNothingIsSolved) {
  Solver solver(multibody_pendulum());
  Ensemble ensemble;
  ensemble.times = {1.0};
  const EnsembleSolution solution = solver.solve_ensemble(ensemble);
  EXPECT_EQ(solution.status, SFDAE_OK);
  EXPECT_EQ(solution.num_threads, 0);
}

TEST(Ensemble, RefusesMatricesOfOtherSizes) {
  Solver solver(multibody_pendulum());
  Ensemble ensemble = pendula(3);
  ensemble.x0 = Matrix(4, 3);
  EXPECT_THROW(solver.solve_ensemble(ensemble), Error);
  ensemble = pendula(3);
  ensemble.parameters = Matrix(2, 2);
  EXPECT_THROW(solver.solve_ensemble(ensemble), Error);
  ensemble = pendula(3);
  ensemble.x0 = Matrix();
  EXPECT_THROW(solver.solve_ensemble(ensemble), Error);
}

// ---- Monitor and stop requests ---------------------------------------------------------------------------------

TEST(Ensemble, ReportsEveryInstanceOnceAndOneAtATime) {
  constexpr int instances = 20;
  Solver solver(multibody_pendulum());
  Ensemble ensemble = pendula(instances);
  ensemble.threads = 4;
  std::vector<int> seen(instances, 0);
  std::atomic<int> inside{0};
  int ended = 0;
  ensemble.monitor = [&](const EnsembleProgress& progress) {
    EXPECT_EQ(++inside, 1);
    EXPECT_EQ(progress.num_ended, ++ended);
    EXPECT_EQ(progress.num_instances, instances);
    EXPECT_EQ(progress.status, SFDAE_OK);
    ++seen[static_cast<std::size_t>(progress.instance)];
    --inside;
    return false;
  };
  solver.solve_ensemble(ensemble);
  EXPECT_EQ(seen, std::vector<int>(instances, 1));
}

TEST(Ensemble, StopsWhenTheMonitorSaysSo) {
  constexpr int instances = 30;
  Solver solver(multibody_pendulum());
  for (const int threads : thread_counts) {
    Ensemble ensemble = pendula(instances);
    ensemble.threads = threads;
    ensemble.monitor = [](const EnsembleProgress& progress) { return progress.num_ended >= 3; };
    const EnsembleSolution stopped = solver.solve_ensemble(ensemble);
    EXPECT_EQ(stopped.status, SFDAE_STOPPED);
    int ended = 0;
    for (int i = 0; i < instances; ++i) {
      const bool is_stopped = stopped.statuses[static_cast<std::size_t>(i)] == SFDAE_STOPPED;
      if (!is_stopped) ++ended;
      const Outcome alone = solved_alone(multibody_pendulum(), {}, ensemble, i), is = outcome_of(stopped, i);
      if (!is_stopped) expect_same(is, alone, i);
      // What was reached is right.
      EXPECT_TRUE(begins_with(alone.x, is.x));
    }
    EXPECT_GE(ended, 3);
    EXPECT_LE(ended, 3 + threads);
    // The request is answered.
    ensemble.monitor = nullptr;
    EXPECT_EQ(solver.solve_ensemble(ensemble).status, SFDAE_OK);
  }
}

// When all have ended nothing is left to be stopped, later calls least of all.
TEST(Ensemble, ForgetsThatTheMonitorStoppedTheLastInstance) {
  Solver solver(multibody_pendulum());
  Ensemble ensemble = pendula(3);
  ensemble.threads = 1;
  for (const bool throws : {false, true}) {
    ensemble.monitor = [throws](const EnsembleProgress& progress) {
      if (throws && progress.num_ended == 3) throw std::runtime_error("enough");
      return progress.num_ended == 3;
    };
    if (throws) EXPECT_THROW(solver.solve_ensemble(ensemble), std::runtime_error);
    else EXPECT_EQ(solver.solve_ensemble(ensemble).status, SFDAE_OK);
    ensemble.monitor = nullptr;
    EXPECT_EQ(solver.solve_ensemble(ensemble).status, SFDAE_OK);
  }
}

TEST(Ensemble, StopsOnRequestBeforeAndMeanwhile) {
  Solver solver(multibody_pendulum());
  Ensemble ensemble = pendula(3);
  ensemble.threads = 2;
  solver.request_stop();
  const EnsembleSolution before = solver.solve_ensemble(ensemble);
  EXPECT_EQ(before.status, SFDAE_STOPPED);
  EXPECT_EQ(before.num_outputs, std::vector<int>(3, 0));
  EXPECT_EQ(before.statuses, std::vector<int>(3, SFDAE_STOPPED));
  // Far more than can be done.
  ensemble = pendula(8);
  ensemble.threads = 2;
  ensemble.times = {1e6};
  Options patient;
  patient.max_steps = 1000000000;
  solver.set_options(patient);
  std::thread stopper([&solver] {
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    solver.request_stop();
  });
  EXPECT_EQ(solver.solve_ensemble(ensemble).status, SFDAE_STOPPED);
  stopper.join();
}

TEST(Ensemble, PassesOnExceptionsOfTheMonitor) {
  Solver solver(multibody_pendulum());
  Ensemble ensemble = pendula(9);
  ensemble.threads = 3;
  ensemble.monitor = [](const EnsembleProgress&) -> bool { throw std::runtime_error("enough"); };
  EXPECT_THROW(solver.solve_ensemble(ensemble), std::runtime_error);
  ensemble.monitor = nullptr;
  EXPECT_EQ(solver.solve_ensemble(ensemble).status, SFDAE_OK);
}

}  // namespace
}  // namespace sfdae::test
