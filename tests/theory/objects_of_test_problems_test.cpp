// The theory's objects along solutions of all test problems: linear families, nonlinear problems recorded and with
// total derivatives, multibody systems recorded and by callbacks.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "../nonlinear/nonlinear_run.h"
#include "c_api/expressions.h"
#include "expression/taylor_evaluator.h"
#include "family_problem.h"
#include "multibody/models.h"
#include "multibody/multibody_run.h"
#include "random_family.h"
#include "test_set/formula_problems.h"
#include "test_set/recorded.h"
#include "test_set/test_set.h"
#include "testset_linear.h"
#include "theory_check.h"

namespace {

using namespace sfdae_test;

constexpr double tolerance = 1e-6;
// Unknowns. Most of the time goes into the index analysis: large problems are analyzed in one form only.
constexpr int large = 40, rather_large = 20;

// At the start, after steps, and within them; where the array is large, at one point.
template <class Run>
void check_along(Run& run, const theory_subject& subject, const TestProblem& p) {
  const int started = run.start(p.t0, p.tf, p.x0);
  // Stiff, and with accelerations among the unknowns: as a general problem it may be refused by a named error.
  const bool may_be_refused = p.name == "slider_crank" && subject.kind == THEORY_NONLINEAR;
  if (may_be_refused && (started == SFDAE_RANK_UNCLEAR || started == SFDAE_NO_CONSISTENT_VALUES)) return;
  ASSERT_GE(started, 0) << p.name << ": " << sfdae_message(subject.solver);
  const auto check_at = [&](double t) { EXPECT_EQ(theory_check(&subject, t), 0) << p.name << " at " << t; };
  if (p.n < large) check_at(run.t);
  for (int step = 0; step < (p.n < large ? 3 : 1); ++step) {
    const double before = run.t;
    ASSERT_GE(sfdae_step(subject.solver, p.tf, &run.t, run.x.data(), nullptr), 0) << p.name;
    check_at(run.t);
    if (p.n < large) check_at(before + 0.4 * (run.t - before));
  }
}

// Total derivatives as a user would write them: those of recorded equations, as plain derivatives.
class CallbackRun {
 public:
  template <class Equations>
  CallbackRun(const TestProblem& p, const Equations& equations) : n_(p.n) {
    RecordedEquations<Equations> recorded(p, equations);
    evaluator_ = std::make_unique<sfdae::core::TaylorEvaluator>(
        sfdae::core::record_equations(&decltype(recorded)::write, p.m, p.n, &recorded));
    sfdae_nonlinear_problem problem;
    sfdae_nonlinear_problem_init(&problem, sizeof problem);
    problem.num_equations = p.m;
    problem.num_unknowns = p.n;
    problem.total_derivative = &CallbackRun::total_derivative;
    problem.user = this;
    const sfdae_options options = options_with(tolerance);
    created = sfdae_create_nonlinear(&solver_, &problem, &options);
  }
  ~CallbackRun() { sfdae_destroy(&solver_); }
  CallbackRun(const CallbackRun&) = delete;
  CallbackRun& operator=(const CallbackRun&) = delete;

  int start(double t0, double toward, const std::vector<double>& guess) {
    t = t0;
    x = guess;
    return sfdae_start(solver_, t, toward, x.data(), nullptr);
  }
  sfdae_solver* solver() { return solver_; }

  int created = 0;
  double t = 0.0;
  std::vector<double> x;

 private:
  static int total_derivative(double t, int order, const double* derivatives, double* F, double* F_x, double* F_xdot,
                              void* user) {
    auto& self = *static_cast<CallbackRun*>(user);
    sfdae::core::TaylorEvaluator& evaluator = *self.evaluator_;
    const std::size_t n = static_cast<std::size_t>(self.n_), m = static_cast<std::size_t>(evaluator.record().m()),
                      orders = static_cast<std::size_t>(order) + 1;
    std::vector<double> jet(derivatives, derivatives + n * (orders + 1)), values(m * orders), by_x(m * n * orders),
        by_xdot(m * n * orders);
    double factorial = 1.0;
    for (std::size_t k = 2; k <= orders; ++k) {
      factorial *= static_cast<double>(k);
      for (std::size_t j = 0; j < n; ++j) jet[k * n + j] /= factorial;
    }
    factorial = std::tgamma(order + 1.0);
    if (!evaluator.gradients(t, jet.data(), {order, order, order}, values.data(), by_xdot.data(), by_x.data()))
      return 1;
    const auto write = [&](const std::vector<double>& from, std::size_t count, double* to) {
      for (std::size_t i = 0; to != nullptr && i < count; ++i) to[i] = factorial * from[(orders - 1) * count + i];
    };
    write(values, m, F);
    write(by_x, m * n, F_x);
    write(by_xdot, m * n, F_xdot);
    return 0;
  }

  int n_;
  std::unique_ptr<sfdae::core::TaylorEvaluator> evaluator_;
  sfdae_solver* solver_ = nullptr;
};

// Recorded, and by callbacks where that is not large.
template <class Equations>
void check_nonlinear(const TestProblem& p, const Equations& residual) {
  NonlinearRun run(equations_of(p.m, p.n, residual), options_with(tolerance));
  // Formulas that are linear in x and x' become linear problems, whose array does not need x.
  const bool is_linear = sfdae_get_derivative_array(run.solver(), p.t0, 0, nullptr, nullptr, nullptr) >= 0;
  const theory_subject subject{p.name.c_str(), is_linear ? THEORY_LINEAR : THEORY_NONLINEAR, p.m, p.n, run.solver()};
  check_along(run, subject, p);
  if (p.n >= rather_large) return;
  const auto equations = [&residual](int, const auto& t, const auto* x, const auto* xdot, auto* F) {
    residual(t, x, xdot, F);
  };
  CallbackRun callbacks(p, equations);
  ASSERT_EQ(callbacks.created, SFDAE_OK);
  const std::string name = p.name + ", callbacks";
  const theory_subject same{name.c_str(), THEORY_NONLINEAR, p.m, p.n, callbacks.solver()};
  check_along(callbacks, same, p);
}

TEST(ObjectsOfTestProblems, OfTheTestSet) {
  for_each_problem_of_test_set([](const TestProblem& p, const auto& equations) {
    check_nonlinear(p, [&](const auto& t, const auto* x, const auto* xdot, auto* F) { equations(0, t, x, xdot, F); });
  });
}

TEST(ObjectsOfTestProblems, OfFormulas) {
  for (const FormulaProblem& problem : formula_problems())
    check_nonlinear(problem.data, [&problem](const auto& t, const auto* x, const auto* xdot, auto* F) {
      problem.residual(t, x, xdot, F);
    });
}

TEST(ObjectsOfTestProblems, OfMultibodySystems) {
  for_each_multibody_model([](const TestProblem& p, const auto& system) {
    for (const MultibodyForm form : {MultibodyForm::recorded, MultibodyForm::callbacks, MultibodyForm::extended}) {
      if (form == MultibodyForm::extended && p.n >= rather_large) continue;
      MultibodyRun run(system, form, multibody_options(tolerance, SFDAE_METHOD_BDF));
      const std::string name = p.name + ", form " + std::to_string(static_cast<int>(form));
      const enum theory_kind kind = form == MultibodyForm::recorded    ? THEORY_MULTIBODY
                                    : form == MultibodyForm::callbacks ? THEORY_MULTIBODY_CALLBACKS
                                                                       : THEORY_NONLINEAR;
      const theory_subject subject{name.c_str(), kind, p.n, p.n, run.solver()};
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
