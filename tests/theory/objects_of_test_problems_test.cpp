// The theory's objects along solutions of all test problems: linear families, nonlinear problems recorded and with
// total derivatives, multibody systems recorded and by callbacks.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <string>

#include "../nonlinear/nonlinear_run.h"
#include "multibody/models.h"
#include "multibody/multibody_run.h"
#include "test_set/formula_problems.h"
#include "test_set/test_set.h"
#include "theory_check.h"

namespace {

using namespace sfdae_test;

constexpr double tolerance = 1e-6;

// At the start, after a step, within it, and further on.
template <class Run>
void check_along(Run& run, const theory_subject& subject, const TestProblem& p) {
  ASSERT_GE(run.start(p.t0, p.tf, p.x0), 0) << p.name << ": " << sfdae_message(subject.solver);
  EXPECT_EQ(theory_check(&subject, run.t), 0);
  for (int step = 0; step < 3; ++step) {
    const double before = run.t;
    ASSERT_GE(sfdae_step(subject.solver, p.tf, &run.t, run.x.data(), nullptr), 0) << p.name;
    EXPECT_EQ(theory_check(&subject, run.t), 0) << "step " << step;
    EXPECT_EQ(theory_check(&subject, before + 0.4 * (run.t - before)), 0) << "within step " << step;
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

}  // namespace
