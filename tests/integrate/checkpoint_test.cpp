// SPDX-License-Identifier: BSD-3-Clause
// A checkpoint contains all that the continuation depends on: runs that are saved, destroyed and restored between all
// calls agree in every bit with runs that are not.
#include "integrate/checkpoint.h"
#include "system/change_watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "analyzed_problem.h"
#include "c_api/problems.h"
#include "linear_family.h"
#include "problem/failure.h"

using namespace sfdae::core;
using sfdae_test::AnalyzedProblem;
using sfdae_test::LinearFamily;

namespace {

using Vector = std::vector<double>;
using FamilyPointer = std::shared_ptr<const LinearFamily>;

IntegrationOptions options_for(int n, double tol, Method method) {
  IntegrationOptions options;
  options.tolerances = {Vector(static_cast<std::size_t>(n), tol), Vector(static_cast<std::size_t>(n), tol)};
  options.method = method;
  return options;
}

// An integration from 0 toward 1 with all that it consists of.
struct Trip {
  Trip(const FamilyPointer& family, Method method, bool constant)
      : analyzed(family, 0.0, 1.0, LeadingTerm::automatic, {},
                 [constant](sfdae_test::FamilyProblem& callbacks) {
                   if (constant) callbacks.declare_constants();
                 }),
        options(options_for(analyzed.callbacks.n(), 1e-5, method)) {
    const Vector start = analyzed.exact(0.0), slope = analyzed.exact_derivative(0.0);
    EXPECT_EQ(analyzed.system.move_to(0.0), PointStatus::ok);
    integration = std::make_unique<Integration>(analyzed.system, std::make_unique<LinearChangeWatch>(analyzed.system),
                                                options, InitialPoint{0.0, 1.0, start, slope});
    system = &analyzed.system;
    x = start;
    xdot = slope;
  }

  int advance(double tout, bool one_step) {
    return integration->advance(tout, one_step, t, x.data(), xdot.data()).status;
  }

  ModelOptions model_options() const {
    ModelOptions wanted;
    wanted.analysis = analyzed.settings;
    return wanted;
  }

  // Nothing but the checkpoint survives.
  void interrupt() {
    Vector saved(checkpoint_size(*system, *integration));
    save_checkpoint(*system, *integration, saved.data());
    integration.reset();
    model = std::make_unique<LinearModel>(functions_of(analyzed.callbacks.problem));
    integration = restore_checkpoint(*model, model_options(), options, {saved.data(), saved.size()});
    system = model->system();
  }

  AnalyzedProblem analyzed;
  IntegrationOptions options;
  std::unique_ptr<LinearModel> model;
  LinearSystem* system;
  std::unique_ptr<Integration> integration;
  double t = 0.0;
  Vector x, xdot;
};

void compare(const FamilyPointer& family, Method method, bool constant = false) {
  Trip plain(family, method, constant), broken(family, method, constant);
  for (int i = 1; i <= 40; ++i) {
    const bool one_step = i % 3 != 0;
    const double tout = std::max(i / 40.0, plain.t);
    broken.interrupt();
    ASSERT_EQ(plain.advance(tout, one_step), broken.advance(tout, one_step)) << i;
    ASSERT_EQ(plain.t, broken.t) << i;
    ASSERT_EQ(plain.x, broken.x) << i;
    ASSERT_EQ(plain.xdot, broken.xdot) << i;
    const IntegrationCounts a = plain.integration->counts(), b = broken.integration->counts();
    ASSERT_EQ(a.steps, b.steps);
    ASSERT_EQ(a.error_failures, b.error_failures);
    ASSERT_EQ(a.smallest_kept, b.smallest_kept);
    ASSERT_EQ(plain.integration->stepper().state().next_step, broken.integration->stepper().state().next_step);
  }
}

const Method methods[] = {Method::bdf, Method::radau, Method::automatic};

TEST(Checkpoint, ContinuesInEveryBitAsIfNothingHadHappened) {
  for (Method method : methods) {
    for (int mu = 0; mu <= 3; ++mu) compare(sfdae_test::kron(8, mu), method);
    compare(sfdae_test::kron(8, 1, 0.5, 2), method);  // free components
    compare(sfdae_test::chain(4, 2), method);
    compare(sfdae_test::rotated_ode(sfdae_test::RowOperation::scaling, 5.0), method);
    compare(sfdae_test::kron(3, 2), method);  // no dynamics
  }
}

TEST(Checkpoint, ContinuesWithConstantMatricesReducedAnew) {
  for (Method method : methods) compare(sfdae_test::kron(8, 1, 0.0), method, true);
}

TEST(Checkpoint, RefusesWhatIsDamagedOrForeign) {
  Trip run(sfdae_test::kron(8, 1), Method::bdf, false);
  run.advance(0.5, false);
  Vector saved(checkpoint_size(*run.system, *run.integration));
  save_checkpoint(*run.system, *run.integration, saved.data());
  const auto status_of = [&](const Vector& values, std::size_t length, LinearModel& model) {
    try {
      restore_checkpoint(model, run.model_options(), run.options, {values.data(), length});
    } catch (const Failure& failure) {
      return failure.status();
    }
    return SFDAE_OK;
  };
  LinearModel model(functions_of(run.analyzed.callbacks.problem));
  EXPECT_EQ(status_of(saved, saved.size(), model), SFDAE_OK);
  for (std::size_t i = 0; i < saved.size(); ++i)
    for (double wrong : {saved[i] + 1.0, 1e300, std::numeric_limits<double>::quiet_NaN()}) {
      Vector damaged = saved;
      damaged[i] = wrong;
      if (damaged[i] == saved[i]) continue;
      ASSERT_EQ(status_of(damaged, damaged.size(), model), SFDAE_ILLEGAL_ARGUMENT) << i << " " << wrong;
    }
  for (std::size_t length = 0; length < saved.size(); ++length)
    ASSERT_EQ(status_of(saved, length, model), SFDAE_ILLEGAL_ARGUMENT) << length;
  sfdae_test::FamilyProblem callbacks(FamilyPointer(sfdae_test::kron(9, 1)));
  LinearModel other(functions_of(callbacks.problem));
  EXPECT_EQ(status_of(saved, saved.size(), other), SFDAE_ILLEGAL_ARGUMENT);
}

}  // namespace
