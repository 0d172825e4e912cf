// What outputs cost: processor time of an integration with 1 and with 500 outputs, the start left out, for both methods
// and both kinds of outputs; and the error of the outputs, in tolerances, against a run with a thousandth of
// the tolerance. Callbacks of kron(16, 2) copy values (replay.h).
//
//   output_cost [tolerance [x']]                      default 1e-6; with a second argument x' is asked for as well
//
// Run it with OPENBLAS_NUM_THREADS=1.
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "multibody/models.h"
#include "multibody/multibody_run.h"
#include "replay.h"
#include "sfdae/sfdae.h"
#include "test_set/pendulum.h"
#include "test_set/recorded.h"

namespace {

constexpr int many = 500;

// A solver that starts at x0, and where it goes.
struct Case {
  std::string name;
  double t0, tf;
  std::vector<double> x0;
};

struct Measured {
  double milliseconds = 1e300;
  sfdae_statistics statistics{};
  std::vector<double> x;  // of all outputs
};

sfdae_options options_for(int method, int output, double tolerance) {
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  options.rtol = options.atol = tolerance;
  options.method = method;
  options.max_steps = 1000000;
  options.output = output;
  return options;
}

void integrate(sfdae_solver* solver, const Case& given, int outputs, bool with_slopes, Measured& result) {
  std::vector<double> x = given.x0, xdot(x.size());
  if (sfdae_start(solver, given.t0, given.tf, x.data(), nullptr) < 0) std::abort();
  result.x.clear();
  result.x.reserve(x.size() * static_cast<std::size_t>(outputs));
  double t = given.t0;
  const std::clock_t begin = std::clock();
  for (int i = 1; i <= outputs; ++i) {
    const double tout = i == outputs ? given.tf : given.t0 + (given.tf - given.t0) * i / outputs;
    const int status = sfdae_advance(solver, tout, &t, x.data(), with_slopes ? xdot.data() : nullptr);
    if (status < 0) {
      std::fprintf(stderr, "%s: %s\n", given.name.c_str(), sfdae_message(solver));
      std::abort();
    }
    result.x.insert(result.x.end(), x.begin(), x.end());
  }
  const double elapsed = 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  result.milliseconds = std::min(result.milliseconds, elapsed);
  sfdae_statistics_init(&result.statistics, sizeof result.statistics);
  sfdae_get_statistics(solver, &result.statistics);
}

double largest_error(const std::vector<double>& x, const std::vector<double>& reference, double tolerance) {
  double worst = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i)
    worst = std::max(worst, std::fabs(x[i] - reference[i]) / (tolerance * (1.0 + std::fabs(reference[i]))));
  return worst;
}

// run(method, output, tolerance, outputs, result): one integration.
template <class Run>
void measure(const std::string& name, double tolerance, Run run) {
  Measured reference;
  run(SFDAE_METHOD_RADAU, SFDAE_OUTPUT_CONSISTENT, std::max(1e-3 * tolerance, 1e-12), many, reference);
  for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
    for (const int output : {SFDAE_OUTPUT_CONSISTENT, SFDAE_OUTPUT_INTERPOLATED}) {
      Measured one, all;
      for (int repetition = 0; repetition < 15; ++repetition) {
        run(method, output, tolerance, 1, one);
        run(method, output, tolerance, many, all);
      }
      std::printf("%-18s %-5s %-12s %9.3f %9.3f %7.2f %6ld %6ld %7ld %7ld %9.2g\n", name.c_str(),
                  method == SFDAE_METHOD_BDF ? "BDF" : "Radau",
                  output == SFDAE_OUTPUT_CONSISTENT ? "consistent" : "interpolated", one.milliseconds,
                  all.milliseconds, all.milliseconds / one.milliseconds, one.statistics.steps, all.statistics.steps,
                  one.statistics.reductions, all.statistics.reductions, largest_error(all.x, reference.x, tolerance));
      std::fflush(stdout);
    }
}

void measure_kron(double tolerance, bool with_slopes) {
  const std::shared_ptr<const sfdae_test::LinearFamily> family = sfdae_test::kron(16, 2, 0.5);
  Case given{"kron(16, 2)", 0.0, 1.0, std::vector<double>(16)};
  family->exact(given.t0, given.x0.data(), nullptr);
  measure(given.name, tolerance, [&](int method, int output, double tol, int outputs, Measured& result) {
    const sfdae_options options = options_for(method, output, tol);
    sfdae_bench::Replay replay(family);
    sfdae_solver* solver = nullptr;
    if (sfdae_create_linear(&solver, &replay.problem, &options) < 0) std::abort();
    Measured recorded;
    integrate(solver, given, outputs, with_slopes, recorded);
    sfdae_destroy(&solver);
    replay.rewind();
    if (sfdae_create_linear(&solver, &replay.problem, &options) < 0) std::abort();
    integrate(solver, given, outputs, with_slopes, result);
    sfdae_destroy(&solver);
  });
}

void measure_raw_pendulum(double tolerance, bool with_slopes) {
  const sfdae_test::TestProblem p = sfdae_test::pendulum();
  const auto equations = [](int, const auto& t, const auto* x, const auto* xdot, auto* F) {
    sfdae_test::pendulum_residual(t, x, xdot, F);
  };
  sfdae_test::RecordedEquations<decltype(equations)> recorded(p, equations);
  const Case given{"raw pendulum", p.t0, p.tf, p.x0};
  measure(given.name, tolerance, [&](int method, int output, double tol, int outputs, Measured& result) {
    const sfdae_options options = options_for(method, output, tol);
    sfdae_nonlinear_problem problem;
    sfdae_nonlinear_problem_init(&problem, sizeof problem);
    problem.num_equations = p.m;
    problem.num_unknowns = p.n;
    problem.equations = &decltype(recorded)::write;
    problem.user = &recorded;
    sfdae_solver* solver = nullptr;
    if (sfdae_create_nonlinear(&solver, &problem, &options) < 0) std::abort();
    integrate(solver, given, outputs, with_slopes, result);
    sfdae_destroy(&solver);
  });
}

void measure_multibody(double tolerance, bool with_slopes) {
  sfdae_test::for_each_multibody_model([&](const sfdae_test::TestProblem& p, const auto& system) {
    if (p.name != "pendulum" && p.name != "andrews") return;
    Case given{"multibody " + p.name, p.t0, p.tf, p.x0};
    measure(given.name, tolerance, [&](int method, int output, double tol, int outputs, Measured& result) {
      sfdae_test::MultibodyRun run(system, sfdae_test::MultibodyForm::recorded, options_for(method, output, tol));
      given.x0.resize(run.x.size());
      integrate(run.solver(), given, outputs, with_slopes, result);
    });
  });
}

}  // namespace

int main(int argc, char** argv) {
  const double tolerance = argc > 1 ? std::atof(argv[1]) : 1e-6;
  const bool with_slopes = argc > 2;
  std::printf("%-18s %-5s %-12s %9s %9s %7s %6s %6s %7s %7s %9s\n", "problem", "", "outputs", "1, ms", "500, ms",
              "ratio", "steps", "steps", "reduct.", "reduct.", "error");
  measure_kron(tolerance, with_slopes);
  measure_raw_pendulum(tolerance, with_slopes);
  measure_multibody(tolerance, with_slopes);
}
