// Work against precision of whole solves, as comma-separated values on standard output:
// problem, tol, steps, rejected, reductions, error in tolerances (steps), error in tolerances (outputs), absolute
// error, microseconds of the library (user's callbacks subtracted).
// SPDX-License-Identifier: BSD-3-Clause
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>

#include "family_run.h"
#include "testset_linear.h"

namespace {

using namespace sfdae_test;

void run(const std::shared_ptr<const LinearFamily>& family, double t0, double t1) {
  for (double exponent = -3.0; exponent >= -10.0; exponent -= 1.0) {
    const double tol = std::pow(10.0, exponent);
    CallbackHooks hooks;
    hooks.measure_time = true;
    FamilyProblem problem(family, hooks);
    const auto start = std::chrono::steady_clock::now();
    const FamilyRun result = run_family(problem, t0, t1, options_with_tolerance(tol));
    const double elapsed =
        std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
    if (result.status < 0) {
      std::printf("\"%s\",%.0e,failed: %s\n", family->name().c_str(), tol, sfdae_status_name(result.status));
      continue;
    }
    std::printf("\"%s\",%.0e,%ld,%ld,%ld,%.3g,%.3g,%.3g,%.1f\n", family->name().c_str(), tol, result.statistics.steps,
                result.statistics.error_failures, result.statistics.reductions, result.step_error,
                result.output_error, result.step_error * tol, elapsed - 1e6 * problem.seconds());
  }
}

}  // namespace

int main() {
  std::printf("problem,tol,steps,rejected,reductions,step_error,output_error,absolute_error,microseconds\n");
  for (int n : {8, 32})
    for (int mu = 0; mu <= 3; ++mu) run(kron(n, mu, 0.5), 0.0, 1.0);
  run(kron(16, 2, 2.0), 0.0, 1.0);
  run(kron(16, 2, 4.0), 0.0, 1.0);
  run(chain(10, 2), 0.0, 1.0);
  run(chain(10, 2, 0.5, 100.0), 0.0, 1.0);
  run(spin(-50.0, 1.0), 0.0, 1.0);
  for (LinearTestProblem& item : linear_testset())
    if (item.family->has_exact() && item.family->values().u == 0) run(std::move(item.family), item.t0, item.tf);
}
