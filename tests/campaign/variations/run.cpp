// SPDX-License-Identifier: BSD-3-Clause
#include "run.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>

namespace campaign {

namespace {

constexpr double most_seconds = 5.0;           // of processor time, else the run counts as a named error
constexpr double reference_tolerance = 2e-12;  // of a step
constexpr int most_dense_unknowns = 60;

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

int stop_late_runs(const sfdae_progress*, void* user) { return processor_seconds() > *static_cast<double*>(user); }

struct SolverHandle {
  sfdae_solver* solver = nullptr;
  SolverHandle() = default;
  ~SolverHandle() { sfdae_destroy(&solver); }
  SolverHandle(const SolverHandle&) = delete;
  SolverHandle& operator=(const SolverHandle&) = delete;
};

double shortest_feature(const Case& problem) {
  double shortest = problem.end;
  for (const SmallProblem& copy : problem.copies) shortest = std::min(shortest, copy.feature);
  return shortest;
}

}  // namespace

Variant random_variant(const Case& problem, int number, int variant, int seed) {
  RandomNumbers random(static_cast<std::uint64_t>(seed) + 2000,
                       static_cast<std::uint64_t>(number * variants_of_problem + variant));
  Variant result;
  constexpr std::array<double, 6> shares = {0.4, 0.15, 0.1, 0.15, 0.1, 0.1};
  double rest = random.uniform();
  int formulation = 0;
  while (formulation < 5 && (rest -= shares[static_cast<std::size_t>(formulation)]) >= 0.0) ++formulation;
  result.formulation = static_cast<Formulation>(formulation);
  result.method = random.integer(0, 2);
  result.tolerance = std::pow(10.0, -random.integer(3, 9));
  result.atol_factor = random.chance(0.3) ? 1e-2 : 1.0;
  const double kind = random.uniform();
  if (kind > 0.5) result.units = {kind > 0.67 ? 1e6 : 1e-6};
  if (kind > 0.84) {
    result.units.clear();
    for (int k = 0; k < 7; ++k) result.units.push_back(std::pow(10.0, 3.0 * random.integer(-2, 2)));
  }
  if (random.chance(0.25)) result.time_unit = std::pow(10.0, 3.0 * random.integer(-2, 2));
  const bool multibody = problem.family == Family::friction_multibody;
  result.has_sum = !multibody && problem.num_copies > 1 && random.chance(0.3);
  const int unknowns = problem.num_copies * problem.copies[0].num_unknowns();
  if (unknowns > most_dense_unknowns && result.formulation == Formulation::structure_off)
    result.formulation = Formulation::recorded;
  if (unknowns > most_dense_unknowns && result.formulation == Formulation::dense)
    result.formulation = Formulation::compressed;
  // Callbacks limit the steps to the width of pulses (options_of).
  constexpr double most_limited_steps = 2000.0;
  if (problem.family == Family::pulses && has_callbacks(result.formulation) &&
      problem.end > most_limited_steps * shortest_feature(problem))
    result.formulation = Formulation::recorded;
  if (multibody) result.formulation = random.chance(0.6) ? Formulation::recorded : Formulation::dense;
  return result;
}

std::vector<std::unique_ptr<Reference>> make_references(const Case& problem) {
  std::vector<std::unique_ptr<Reference>> result;
  for (const SmallProblem& copy : problem.copies)
    result.push_back(std::make_unique<Reference>(copy, problem.end, problem.outputs, reference_tolerance));
  return result;
}

namespace {

sfdae_options options_of(const Case& problem, const Variant& variant) {
  sfdae_options options;
  sfdae_options_init(&options, sizeof options);
  options.rtol = variant.tolerance;
  options.method = variant.method;
  options.max_steps = 30000;
  if (variant.formulation == Formulation::structure_off) options.structure = SFDAE_STRUCTURE_OFF;
  if (variant.formulation == Formulation::structure_required) options.structure = SFDAE_STRUCTURE_REQUIRED;
  // The library knows nothing of functions of the user's between the points where they are called.
  const bool opaque_input = problem.family == Family::pulses && problem.law.law == Law::opaque;
  if (has_callbacks(variant.formulation) || opaque_input)
    options.max_step = shortest_feature(problem) * variant.time_unit;
  return options;
}

// Notes the largest error at an output.
void compare(const System& system, std::size_t output, const Variant& variant, const std::vector<double>& atol,
             const std::vector<double>& x, RunResult& result, double t) {
  const std::vector<double> exact = system.solution(output);
  std::vector<double> perturbed;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double tolerance = variant.tolerance * std::abs(exact[i]) + atol[i], error = std::abs(x[i] - exact[i]);
    double ratio = error / tolerance;
    if (std::isnan(ratio)) ratio = HUGE_VAL;
    result.plain_error = std::max(result.plain_error, ratio);
    if (ratio > allowed_tolerances) {
      if (perturbed.empty()) perturbed = system.perturbed(output, variant.tolerance, atol);
      if (perturbed[i] > tolerance) ratio = error / perturbed[i];
    }
    if (!(ratio > result.error)) continue;
    result.error = ratio;
    result.unknown = static_cast<int>(i);
    result.t = t;
  }
}

void print_start(const Case& problem, const Variant& variant, const System& system, const sfdae_options& options) {
  std::printf("%s, law %s, gain %s, %d copies, 0 <= t <= %.17g\n",
              family_names[static_cast<std::size_t>(problem.family)],
              law_names[static_cast<std::size_t>(problem.law.law)],
              gain_names[static_cast<std::size_t>(problem.gain)], problem.num_copies, problem.end);
  std::printf("%s, method %d, rtol %g, atol_factor %g, time unit %g, units",
              formulation_names[static_cast<std::size_t>(variant.formulation)], variant.method, variant.tolerance,
              variant.atol_factor, variant.time_unit);
  for (double unit : variant.units) std::printf(" %g", unit);
  std::printf(", max_step %g\n%soutputs", options.max_step, system.text().c_str());
  for (double t : problem.outputs) std::printf(" %.17g", t);
  std::printf("\n");
  for (std::size_t k = 0; problem.law.law == Law::table && k < problem.law.spline.x.size(); ++k)
    std::printf("table of degree %d: %.17g %.17g\n", problem.law.spline.degree, problem.law.spline.x[k],
                problem.law.spline.y[k]);
}

void print_output(const System& system, std::size_t output, double t, const std::vector<double>& x,
                  const std::vector<double>& atol) {
  const std::vector<double> exact = system.solution(output);
  std::printf("t = %.6g:", t);
  for (std::size_t i = 0; i < std::min<std::size_t>(x.size(), 8); ++i)
    std::printf("  %.9g (%.9g, atol %.1e)", x[i], exact[i], atol[i]);
  std::printf("\n");
}

bool references_suffice(const std::vector<std::unique_ptr<Reference>>& references, const Variant& variant) {
  return std::all_of(references.begin(), references.end(), [&](const auto& reference) {
    return reference->is_known() && reference->error() <= variant.tolerance;
  });
}

int integrate(const Case& problem, const Variant& variant, System& system, sfdae_solver* solver,
              const std::vector<double>& atol, RunResult& result, bool prints) {
  std::vector<double> x = system.start();
  const double T = variant.time_unit;
  int warning = sfdae_start(solver, 0.0, problem.end * T, x.data(), nullptr);
  if (warning < 0) return warning;
  double t = 0.0;
  for (std::size_t k = 0; k < problem.outputs.size(); ++k) {
    const int status = sfdae_advance(solver, problem.outputs[k] * T, &t, x.data(), nullptr);
    if (status < 0 || status == SFDAE_STOPPED) return status;
    if (status > 0) warning = status;
    compare(system, k, variant, atol, x, result, problem.outputs[k]);
    if (prints) print_output(system, k, problem.outputs[k], x, atol);
  }
  return result.error > allowed_tolerances ? warning : SFDAE_OK;
}

}  // namespace

RunResult run(const Case& problem, const Variant& variant, const std::vector<std::unique_ptr<Reference>>& references,
              bool prints) {
  RunResult result;
  if (!references_suffice(references, variant)) {
    result.verdict = Verdict::no_reference;
    return result;
  }
  const bool multibody = problem.family == Family::friction_multibody;
  const auto system = (multibody ? make_multibody : make_equations)(problem, variant, references);
  std::vector<double> atol = system->sizes();
  for (double& size : atol) size = variant.tolerance * variant.atol_factor * (size > 0.0 ? size : 1.0);
  const double begin = processor_seconds();
  double limit = begin + most_seconds;
  sfdae_options options = options_of(problem, variant);
  options.atol_vector = atol.data();
  options.monitor = stop_late_runs;
  options.monitor_user = &limit;
  if (prints) print_start(problem, variant, *system, options);
  SolverHandle handle;
  result.status = system->create(&handle.solver, options);
  if (result.status == SFDAE_OK)
    result.status = integrate(problem, variant, *system, handle.solver, atol, result, prints);
  if (result.status != SFDAE_OK)
    std::snprintf(result.message, sizeof result.message, "%s", sfdae_message(handle.solver));
  result.seconds = processor_seconds() - begin;
  if (result.status != SFDAE_OK) {
    result.verdict = Verdict::named;
  } else if (result.error > allowed_tolerances) {
    result.verdict = Verdict::wrong;
  }
  if (!prints) return result;
  std::size_t length = 0;
  sfdae_report(handle.solver, nullptr, 0, &length);
  std::string text(length, '\0');
  sfdae_report(handle.solver, text.data(), length, nullptr);
  std::printf("%s\n%s\nstatus %s, error %.3g (in tolerances %.3g) of unknown %d at t = %.6g\n", text.c_str(),
              result.message, sfdae_status_name(result.status), result.error, result.plain_error, result.unknown,
              result.t);
  return result;
}

}  // namespace campaign
