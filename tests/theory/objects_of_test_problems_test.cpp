// The theory's objects along solutions of all test problems: linear families, nonlinear problems recorded and with
// total derivatives, multibody systems recorded and by callbacks.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <string>

#include "../nonlinear/nonlinear_run.h"
#include "family_problem.h"
#include "multibody/models.h"
#include "multibody/multibody_run.h"
#include "random_family.h"
#include "test_set/formula_problems.h"
#include "test_set/test_set.h"
#include "testset_linear.h"
#include "theory_check.h"

namespace {

using namespace sfdae_test;

constexpr double tolerance = 1e-6;

// At the start, after steps, and within them; where the array is large, at one point.
template <class Run>
void check_along(Run& run, const theory_subject& subject, const TestProblem& p) {
  constexpr int large = 40;
  ASSERT_GE(run.start(p.t0, p.tf, p.x0), 0) << p.name << ": " << sfdae_message(subject.solver);
  const auto check_at = [&](double t) { EXPECT_EQ(theory_check(&subject, t), 0) << p.name << " at " << t; };
  if (p.n < large) check_at(run.t);
  for (int step = 0; step < (p.n < large ? 3 : 1); ++step) {
    const double before = run.t;
    ASSERT_GE(sfdae_step(subject.solver, p.tf, &run.t, run.x.data(), nullptr), 0) << p.name;
    check_at(run.t);
    if (p.n < large) check_at(before + 0.4 * (run.t - before));
  }
}

template <class Equations>
void check_recorded(const TestProblem& p, const Equations& residual) {
  NonlinearRun run(equations_of(p.m, p.n, residual), options_with(tolerance));
  // Formulas that are linear in x and x' become linear problems, whose array does not need x.
  const bool is_linear = sfdae_get_derivative_array(run.solver(), p.t0, 0, nullptr, nullptr, nullptr) >= 0;
  const theory_subject subject{p.name.c_str(), is_linear ? THEORY_LINEAR : THEORY_NONLINEAR, p.m, p.n, run.solver()};
  check_along(run, subject, p);
}

TEST(ObjectsOfTestProblems, OfTheTestSet) {
  for_each_problem_of_test_set([](const TestProblem& p, const auto& equations) {
    check_recorded(p, [&](const auto& t, const auto* x, const auto* xdot, auto* F) { equations(0, t, x, xdot, F); });
  });
}

TEST(ObjectsOfTestProblems, OfFormulas) {
  for (const FormulaProblem& problem : formula_problems())
    check_recorded(problem.data, [&problem](const auto& t, const auto* x, const auto* xdot, auto* F) {
      problem.residual(t, x, xdot, F);
    });
}

TEST(ObjectsOfTestProblems, OfMultibodySystems) {
  for_each_multibody_model([](const TestProblem& p, const auto& system) {
    for (const MultibodyForm form : {MultibodyForm::recorded, MultibodyForm::callbacks}) {
      MultibodyRun run(system, form, multibody_options(tolerance, SFDAE_METHOD_BDF));
      const bool recorded = form == MultibodyForm::recorded;
      const std::string name = p.name + (recorded ? ", recorded" : ", callbacks");
      const theory_subject subject{name.c_str(), recorded ? THEORY_MULTIBODY : THEORY_MULTIBODY_CALLBACKS, p.n, p.n,
                                   run.solver()};
      check_along(run, subject, p);
    }
  });
}

// Families of linear problems: at any t, and along solutions.
TEST(ObjectsOfTestProblems, OfLinearFamilies) {
  std::vector<LinearTestProblem> all = linear_testset();
  for (int mu = 0; mu <= 4; ++mu) all.push_back({kron(9, mu), 0.0, 1.0, {}});
  all.push_back({kron(12, 2, 1.0, 2, 3, 10.0, 1e4), 0.0, 1.0, {}});
  all.push_back({chain(6, 2), 0.0, 1.0, {}});
  all.push_back({spin(3.0, -1.0), 0.0, 1.0, {}});
  for (std::uint64_t seed = 1; seed <= 40; ++seed) all.push_back({random_family(seed), 0.0, 1.0, {}});
  for (LinearTestProblem& p : all) {
    FamilyProblem problem(std::move(p.family));
    SCOPED_TRACE(problem.family().name());
    sfdae_solver* solver = nullptr;
    ASSERT_EQ(sfdae_create_linear(&solver, &problem.problem, nullptr), SFDAE_OK);
    const std::string name = problem.family().name();
    const theory_subject subject{name.c_str(), THEORY_LINEAR, problem.m(), problem.n(), solver};
    std::vector<double> x(static_cast<std::size_t>(problem.n()));
    double t = p.t0;
    problem.family().exact(t, x.data(), nullptr);
    ASSERT_GE(sfdae_start(solver, p.t0, p.tf, x.data(), nullptr), 0) << sfdae_message(solver);
    EXPECT_EQ(theory_check_linear(&subject, p.t0 + 0.37 * (p.tf - p.t0)), 0);
    EXPECT_EQ(theory_check(&subject, p.t0), 0);
    ASSERT_GE(sfdae_step(solver, p.tf, &t, x.data(), nullptr), 0);
    EXPECT_EQ(theory_check(&subject, t), 0);
    sfdae_destroy(&solver);
  }
}

}  // namespace
