// Outputs within steps, consistent and interpolated: accuracy, constraints, and what they do not change
// (docs/design/error_control.md).
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "family_problem.h"
#include "family_run.h"
#include "linear_family.h"
#include "multibody/models.h"
#include "multibody/multibody_run.h"
#include "test_set/pendulum.h"
#include "test_set/recorded.h"

namespace {

using namespace sfdae_test;
using OutputVector = std::vector<double>;

constexpr int both_methods[] = {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU};
constexpr int kinds[] = {SFDAE_OUTPUT_CONSISTENT, SFDAE_OUTPUT_INTERPOLATED};

std::size_t index(int i) { return static_cast<std::size_t>(i); }

sfdae_options options_for(int method, int output, double tol) {
  sfdae_options options = options_with_tolerance(tol);
  options.method = method;
  options.output = output;
  return options;
}

std::string name_of(int method, int output) {
  return std::string(method == SFDAE_METHOD_BDF ? "BDF" : "Radau") +
         (output == SFDAE_OUTPUT_CONSISTENT ? ", consistent" : ", interpolated");
}

// ---- Problems

// A solver, from where it starts.
struct Problem {
  virtual ~Problem() = default;
  virtual sfdae_solver* create(const sfdae_options& options) = 0;
  double t0 = 0.0, tf = 1.0;
  OutputVector start;
};

struct LinearCase : Problem {
  explicit LinearCase(std::shared_ptr<const LinearFamily> family) : callbacks(std::move(family)) {
    start.resize(index(callbacks.n()));
    callbacks.family().exact(t0, start.data(), nullptr);
  }
  sfdae_solver* create(const sfdae_options& options) override {
    sfdae_solver* solver = nullptr;
    EXPECT_EQ(sfdae_create_linear(&solver, &callbacks.problem, &options), SFDAE_OK);
    return solver;
  }
  FamilyProblem callbacks;
};

// The raw equations of the pendulum of the test set, recorded.
struct RawPendulum : Problem {
  RawPendulum() {
    tf = 2.0;
    start = data.x0;
  }
  sfdae_solver* create(const sfdae_options& options) override {
    sfdae_nonlinear_problem problem;
    sfdae_nonlinear_problem_init(&problem, sizeof problem);
    problem.num_equations = problem.num_unknowns = 5;
    problem.equations = &write;
    sfdae_solver* solver = nullptr;
    EXPECT_EQ(sfdae_create_nonlinear(&solver, &problem, &options), SFDAE_OK);
    return solver;
  }
  static int write(sfdae_record*, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                   sfdae_expression* residual, void*) {
    const std::vector<sfdae::Expression> unknowns(x, x + 5), slopes(xdot, xdot + 5);
    std::vector<sfdae::Expression> F(5);
    pendulum_residual(sfdae::Expression(t), unknowns.data(), slopes.data(), F.data());
    std::transform(F.begin(), F.end(), residual, [](const sfdae::Expression& e) { return e.c(); });
    return 0;
  }
  TestProblem data = pendulum();
};

// A model of the test set as a multibody system.
struct MultibodyCase : Problem {
  MultibodyCase(const std::string& name, double end) {
    for_each_multibody_model([&](const TestProblem& p, const auto& system) {
      if (p.name != name) return;
      t0 = p.t0;
      tf = end > 0.0 ? end : p.tf;
      start = p.x0;
      start.resize(index(system.sizes.unknowns()));
      using System = std::decay_t<decltype(system)>;
      const auto copy = std::make_shared<System>(system);
      owner = copy;
      sfdae_multibody_problem_init(&problem, sizeof problem);
      problem.num_positions = system.sizes.positions;
      problem.num_constraints = system.sizes.holonomic;
      problem.equations = &RecordedMultibody<System>::multibody;
      problem.user = copy.get();
    });
  }
  sfdae_solver* create(const sfdae_options& options) override {
    sfdae_solver* solver = nullptr;
    EXPECT_EQ(sfdae_create_multibody(&solver, &problem, &options), SFDAE_OK);
    return solver;
  }
  std::shared_ptr<void> owner;
  sfdae_multibody_problem problem{};
};

// ---- Runs

struct Course {
  Course(Problem& its_problem, const sfdae_options& options)
      : problem(its_problem), solver(problem.create(options)), t(problem.t0), x(problem.start), xdot(x.size()) {
    EXPECT_GE(sfdae_start(solver, t, problem.tf, x.data(), xdot.data()), 0) << sfdae_message(solver);
  }
  ~Course() { sfdae_destroy(&solver); }
  Course(const Course&) = delete;
  Course& operator=(const Course&) = delete;
  sfdae_statistics statistics() const {
    sfdae_statistics result;
    sfdae_statistics_init(&result, sizeof result);
    sfdae_get_statistics(solver, &result);
    return result;
  }
  // visit() after each of so many equidistant outputs; with_slopes: x' is asked for.
  void integrate(int outputs, bool with_slopes, const std::function<void()>& visit) {
    for (int i = 1; i <= outputs; ++i) {
      const double tout = i == outputs ? problem.tf : problem.t0 + (problem.tf - problem.t0) * i / outputs;
      const int status = sfdae_advance(solver, tout, &t, x.data(), with_slopes ? xdot.data() : nullptr);
      ASSERT_EQ(status, SFDAE_OK) << sfdae_message(solver);
      visit();
    }
  }
  Problem& problem;
  sfdae_solver* solver;
  double t;
  OutputVector x, xdot;
};

double in_tolerances(const OutputVector& x, const OutputVector& exact, double tol) {
  double worst = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i)
    worst = std::max(worst, std::fabs(x[i] - exact[i]) / (tol * (1.0 + std::fabs(exact[i]))));
  return worst;
}

// The pendulum that falls from the horizontal by its angle phi: phi'' = -g cos phi, with the classical Runge-Kutta
// method in steps so small that its errors are roundings.
struct Angle {
  void advance(double to) {
    const int steps = std::max(1, static_cast<int>(std::ceil((to - t) / 1e-4)));
    const double h = (to - t) / steps;
    const auto rate = [](double angle) { return -Pendulum::gravity * std::cos(angle); };
    for (int i = 0; i < steps; ++i) {
      const double k1 = omega, l1 = rate(phi), k2 = omega + 0.5 * h * l1, l2 = rate(phi + 0.5 * h * k1),
                   k3 = omega + 0.5 * h * l2, l3 = rate(phi + 0.5 * h * k2), k4 = omega + h * l3,
                   l4 = rate(phi + h * k3);
      phi += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
      omega += h / 6.0 * (l1 + 2.0 * l2 + 2.0 * l3 + l4);
    }
    t = to;
  }
  // (q, v) and v'.
  OutputVector state() const { return {std::cos(phi), std::sin(phi), -omega * std::sin(phi), omega * std::cos(phi)}; }
  double force() const { return omega * omega - Pendulum::gravity * std::sin(phi); }  // lambda of the raw equations
  OutputVector accelerations() const {
    return {-force() * std::cos(phi), -force() * std::sin(phi) - Pendulum::gravity};
  }
  double t = 0.0, phi = 0.0, omega = 0.0;
};

// ---- Accuracy

// Errors of w within steps are below two tolerances, those of x that is interpolated below about three, beside those
// of the steps.
TEST(Outputs, OfLinearProblemsAreAsAccurateAsSteps) {
  const std::vector<std::shared_ptr<const LinearFamily>> families = {kron(8, 0, 0.5), kron(8, 1, 2.0),
                                                                     kron(16, 2, 0.5), chain(10, 2)};
  for (const auto& family : families)
    for (double tol : {1e-4, 1e-6, 1e-9})
      for (int method : both_methods)
        for (int output : kinds) {
          LinearCase problem(family);
          Course run(problem, options_for(method, output, tol));
          OutputVector exact(run.x.size()), slope(exact);
          double worst = 0.0, worst_slope = 0.0;
          run.integrate(300, true, [&] {
            family->exact(run.t, exact.data(), slope.data());
            worst = std::max(worst, in_tolerances(run.x, exact, tol));
            // Slopes of polynomials err by errors of values over distances of points, which are shortest near the
            // start.
            const double distance = std::min(1.0, 0.03 * std::fabs(run.statistics().last_step));
            worst_slope = std::max(worst_slope, distance * in_tolerances(run.xdot, slope, tol));
          });
          EXPECT_LE(worst, 10.0) << family->name() << " " << tol << " " << name_of(method, output);
          EXPECT_LE(worst_slope, 10.0) << family->name() << " " << tol << " " << name_of(method, output);
        }
}

TEST(Outputs, OfPendulumsAreAsAccurateAsSteps) {
  for (double tol : {1e-4, 1e-6, 1e-9})
    for (int method : both_methods)
      for (int output : kinds)
        for (bool is_raw : {true, false}) {
          RawPendulum raw;
          raw.tf = 1.0;  // errors of BDF grow fast
          MultibodyCase multibody("pendulum", raw.tf);
          Problem& problem = is_raw ? static_cast<Problem&>(raw) : multibody;
          Course run(problem, options_for(method, output, tol));
          Angle angle;
          double worst = 0.0, worst_slope = 0.0;
          run.integrate(300, true, [&] {
            angle.advance(run.t);
            OutputVector exact = angle.state();
            if (is_raw) exact.push_back(angle.force());
            worst = std::max(worst, in_tolerances(run.x, exact, tol));
            const double distance = std::min(1.0, 0.03 * std::fabs(run.statistics().last_step));
            const OutputVector a = angle.accelerations(), slopes = {exact[2], exact[3], a[0], a[1]};
            worst_slope = std::max(worst_slope, distance * in_tolerances(run.xdot, slopes, tol));
          });
          EXPECT_LE(worst, 10.0) << is_raw << " " << tol << " " << name_of(method, output);
          EXPECT_LE(worst_slope, 10.0) << is_raw << " " << tol << " " << name_of(method, output);
        }
}

// g = 0, g_q v = 0 and, for the raw equations, where the multiplier is known, |v|^2 + q a = 0.
TEST(Outputs, ConsistentOnesFulfilAllConstraintsToRounding) {
  constexpr double rounding = 1e-13;  // values up to 30 and a dozen operations
  for (int method : both_methods)
    for (bool is_raw : {true, false}) {
      RawPendulum raw;
      MultibodyCase multibody("pendulum", raw.tf);
      Problem& problem = is_raw ? static_cast<Problem&>(raw) : multibody;
      Course run(problem, options_for(method, SFDAE_OUTPUT_CONSISTENT, 1e-5));
      run.integrate(300, false, [&] {
        const OutputVector& x = run.x;
        EXPECT_LE(std::fabs(x[0] * x[0] + x[1] * x[1] - 1.0), rounding);
        EXPECT_LE(std::fabs(x[0] * x[2] + x[1] * x[3]), rounding);
        if (is_raw) {
          EXPECT_LE(std::fabs(x[2] * x[2] + x[3] * x[3] - x[4] - Pendulum::gravity * x[1]), 10.0 * rounding);
        }
      });
    }
}

// Iterations at outputs of raw equations with the linearization of the step: 6.6 at Radau's outputs, 8.7 without
// Anderson's method.
TEST(Outputs, ConsistentOnesOfRawEquationsTakeFewIterations) {
  constexpr int outputs = 500;
  RawPendulum problem;
  problem.tf = 10.0;
  const sfdae_options options = options_for(SFDAE_METHOD_RADAU, SFDAE_OUTPUT_CONSISTENT, 1e-6);
  Course one(problem, options), many(problem, options);
  one.integrate(1, false, [] {});
  many.integrate(outputs, false, [] {});
  EXPECT_LE(many.statistics().evaluations_F - one.statistics().evaluations_F, 7.5 * outputs);
}

// Evaluations at outputs of mechanical systems: both levels twice or three times, and all terms once.
TEST(Outputs, ConsistentOnesOfMultibodySystemsTakeFewEvaluations) {
  constexpr int outputs = 500;
  MultibodyCase pendulum("pendulum", 10.0), andrews("andrews", 0.0);
  for (Problem* problem : {static_cast<Problem*>(&pendulum), static_cast<Problem*>(&andrews)})
    for (const auto& [method, tol] : {std::pair{SFDAE_METHOD_RADAU, 1e-6}, std::pair{SFDAE_METHOD_BDF, 1e-4}}) {
      const sfdae_options options = options_for(method, SFDAE_OUTPUT_CONSISTENT, tol);
      Course one(*problem, options), many(*problem, options);
      one.integrate(1, false, [] {});
      many.integrate(outputs, false, [] {});
      EXPECT_LE(many.statistics().evaluations_F - one.statistics().evaluations_F, 4.2 * outputs)
          << problem->start.size() << " " << name_of(method, SFDAE_OUTPUT_CONSISTENT);
    }
}

// Positions, velocities and multipliers of a consistent output: an integration that starts there, where all that
// holds stays, has the same multipliers.
TEST(Outputs, ConsistentOnesOfMultibodySystemsHaveTheirMultipliers) {
  for (const auto& [method, tol] : {std::pair{SFDAE_METHOD_RADAU, 1e-6}, std::pair{SFDAE_METHOD_BDF, 1e-4}}) {
    MultibodyCase andrews("andrews", 0.0);
    Course run(andrews, options_for(method, SFDAE_OUTPUT_CONSISTENT, tol));
    run.integrate(50, false, [&] {
      if (run.t == andrews.tf) return;
      MultibodyCase there("andrews", 0.0);
      there.t0 = run.t;
      there.start = run.x;
      const Course started(there, options_for(method, SFDAE_OUTPUT_CONSISTENT, tol));
      double size = 0.0;
      for (std::size_t i = 14; i < run.x.size(); ++i) size = std::max(size, std::fabs(run.x[i]));
      for (std::size_t i = 0; i < run.x.size(); ++i) {
        const double scale = i < 14 ? 1.0 + std::fabs(run.x[i]) : size;
        EXPECT_NEAR(run.x[i], started.x[i], (i < 7 ? 1e-13 : i < 14 ? 1e-11 : 1e-9) * scale) << run.t << " " << i;
      }
    });
  }
}

// Rows of A x + f = 0 where those of E vanish.
TEST(Outputs, ConsistentOnesOfLinearProblemsFulfilTheirConstraintsToRounding) {
  const std::shared_ptr<const LinearFamily> family = chain(10, 2);
  const int n = family->n();
  for (int method : both_methods) {
    LinearCase problem(family);
    Course run(problem, options_for(method, SFDAE_OUTPUT_CONSISTENT, 1e-5));
    OutputVector E(index(n * n)), A(E), f(index(n));
    run.integrate(100, false, [&] {
      family->matrix_coefficients(run.t, 0, E.data(), A.data());
      family->vector_coefficients(run.t, 0, f.data());
      for (int i = n - 2; i < n; ++i) {
        double sum = f[index(i)];
        for (int j = 0; j < n; ++j) sum += A[index(i + j * n)] * run.x[index(j)];
        EXPECT_LE(std::fabs(sum), 1e-12) << run.t;
      }
    });
  }
}

// ---- Steps and reductions

long reductions_of(const Course& run) { return run.statistics().reductions; }

TEST(Outputs, DoNotChangeSteps) {
  const auto check = [](Problem& problem, const std::string& name) {
    for (int method : both_methods)
      for (int output : kinds) {
        const sfdae_options options = options_for(method, output, 1e-6);
        Course one(problem, options), many(problem, options);
        one.integrate(1, false, [] {});
        many.integrate(500, false, [] {});
        EXPECT_EQ(many.statistics().steps, one.statistics().steps) << name << " " << name_of(method, output);
        const long more = reductions_of(many) - reductions_of(one);
        // The last output is one of both; kept factors serve those of nonlinear problems.
        if (output == SFDAE_OUTPUT_INTERPOLATED) EXPECT_EQ(more, 0) << name << " " << name_of(method, output);
        else EXPECT_LE(more, 499) << name << " " << name_of(method, output);
      }
  };
  LinearCase linear(kron(16, 2, 0.5));
  RawPendulum raw;
  raw.tf = 10.0;
  MultibodyCase multibody("pendulum", 10.0), andrews("andrews", 0.0);
  check(linear, "kron");
  check(raw, "raw pendulum");
  check(multibody, "multibody pendulum");
  check(andrews, "andrews");
}

// To the last bit, though the structure is confirmed at each of them.
TEST(Outputs, DoNotChangeStepsOfTheMinimalExtension) {
  for (int method : both_methods)
    for (int output : kinds)
      for (double tol : {1e-4, 1e-6}) {
        sfdae_options options = options_for(method, output, tol);
        options.structure = SFDAE_STRUCTURE_REQUIRED;
        RawPendulum pendulum;
        pendulum.tf = 10.0;
        Course one(pendulum, options), many(pendulum, options);
        one.integrate(1, false, [] {});
        many.integrate(500, false, [] {});
        EXPECT_EQ(many.statistics().steps, one.statistics().steps) << name_of(method, output) << " " << tol;
        EXPECT_EQ(many.x, one.x) << name_of(method, output) << " " << tol;
      }
}

// Three stages are too few for these tolerances: steps are those of the order at their ends, within them the polynomial
// is of order 3. It becomes accurate by shorter steps, in proportion to the fourth root of its error at most.
TEST(Outputs, AreAccurateWhereStepsAreTooLongForThePolynomial) {
  for (double tol : {1e-7, 1e-9, 1e-11})
    for (int output : kinds) {
      LinearCase problem(kron(16, 2, 0.5));
      sfdae_options options = options_for(SFDAE_METHOD_RADAU, output, tol);
      options.min_stages = options.max_stages = 3;
      Course one(problem, options), run(problem, options);
      one.integrate(1, false, [] {});
      OutputVector exact(run.x.size());
      double worst = 0.0;
      run.integrate(500, false, [&] {
        problem.callbacks.family().exact(run.t, exact.data(), nullptr);
        worst = std::max(worst, in_tolerances(run.x, exact, tol));
      });
      EXPECT_LE(worst, 10.0) << tol << " " << name_of(SFDAE_METHOD_RADAU, output);
      EXPECT_LE(run.statistics().steps, 4 * one.statistics().steps) << tol;
      // Not a step for every output, as when steps ended there.
      EXPECT_LE(run.statistics().steps, 400) << tol;
    }
}

// Stiff components: their slopes at the start say nothing about the polynomial.
TEST(Outputs, OfStiffProblemsAreAccurate) {
  for (double rate : {-1e2, -1e4, -1e6})
    for (int method : both_methods)
      for (int output : kinds) {
        LinearCase problem(spin(rate, 1.0));
        const double tol = 1e-6;
        Course run(problem, options_for(method, output, tol));
        OutputVector exact(run.x.size());
        double worst = 0.0;
        run.integrate(300, false, [&] {
          problem.callbacks.family().exact(run.t, exact.data(), nullptr);
          worst = std::max(worst, in_tolerances(run.x, exact, tol));
        });
        EXPECT_LE(worst, 10.0) << rate << " " << name_of(method, output);
      }
}

// Backward in time, and at earlier points of the last step again.
TEST(Outputs, InterpolateTheLastStepInBothDirections) {
  for (int method : both_methods)
    for (int output : kinds) {
      const std::shared_ptr<const LinearFamily> family = kron(8, 1, 0.5);
      LinearCase problem(family);
      problem.t0 = 1.0;
      problem.tf = 0.0;
      family->exact(1.0, problem.start.data(), nullptr);
      const double tol = 1e-6;
      Course run(problem, options_for(method, output, tol));
      OutputVector exact(run.x.size()), x(exact);
      run.integrate(20, true, [&] {
        const sfdae_statistics statistics = run.statistics();
        for (double part : {0.0, 0.3, 0.9, 1.0}) {
          const double t = statistics.t_internal - part * statistics.last_step;
          ASSERT_EQ(sfdae_interpolate(run.solver, t, x.data(), nullptr), SFDAE_OK) << sfdae_message(run.solver);
          family->exact(t, exact.data(), nullptr);
          EXPECT_LE(in_tolerances(x, exact, tol), 10.0) << t << " " << name_of(method, output);
        }
      });
    }
}

// ---- Checkpoints

// A run that is saved after every third output and goes on in another solver agrees in every bit.
TEST(Outputs, AreTheSameAfterACheckpointWithinAStep) {
  const auto check = [](Problem& problem, const std::string& name) {
    for (int method : both_methods)
      for (int output : kinds)
        for (double tol : {1e-5, 1e-9}) {
          const sfdae_options options = options_for(method, output, tol);
          Course plain(problem, options), broken(problem, options);
          constexpr int outputs = 60;
          for (int i = 1; i <= outputs; ++i) {
            const double tout = problem.t0 + (problem.tf - problem.t0) * i / (outputs + 1);
            for (Course* run : {&plain, &broken})
              ASSERT_EQ(sfdae_advance(run->solver, tout, &run->t, run->x.data(), run->xdot.data()), SFDAE_OK)
                  << sfdae_message(run->solver);
            ASSERT_EQ(plain.x, broken.x) << name << " " << tout << " " << name_of(method, output);
            ASSERT_EQ(plain.xdot, broken.xdot) << name << " " << tout << " " << name_of(method, output);
            if (i % 3 != 0) continue;
            std::size_t length = 0;
            ASSERT_EQ(sfdae_get_checkpoint_length(broken.solver, &length), SFDAE_OK);
            OutputVector saved(length);
            ASSERT_EQ(sfdae_save_checkpoint(broken.solver, saved.data(), length), SFDAE_OK);
            sfdae_destroy(&broken.solver);
            broken.solver = problem.create(options);
            ASSERT_EQ(sfdae_restore_checkpoint(broken.solver, saved.data(), length), SFDAE_OK)
                << sfdae_message(broken.solver);
          }
        }
  };
  LinearCase linear(kron(16, 2, 0.5));
  RawPendulum raw;
  MultibodyCase multibody("pendulum", 2.0);
  check(linear, "kron");
  check(raw, "raw pendulum");
  check(multibody, "multibody pendulum");
}

}  // namespace
