// SPDX-License-Identifier: BSD-3-Clause
// Linear problems: the test set, families of any size, random ones, changes of the characteristic values.
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>

#include "random_family.h"
#include "session.h"
#include "testset_linear.h"

namespace sfdae_bench {

namespace {

using namespace sfdae_test;

constexpr int methods[] = {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU, SFDAE_METHOD_AUTOMATIC};

std::string text(double value) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%g", value);
  return digits;
}

void add(Runs& runs, const std::string& name, const Problem& problem, const sfdae_options& options,
         const Plan& plan = {}) {
  runs.push_back({name, [=](Trace& trace) { solve(trace, problem, options, plan); }});
}

sfdae_options with_reduction(sfdae_options options, int reduction) {
  options.reduction = reduction;
  return options;
}

void add_test_set(Runs& runs) {
  for (LinearTestProblem& p : linear_testset()) {
    const Family family = std::move(p.family);
    const Problem problem = family_problem(family, p.t0, p.tf).from(p.x0);
    const std::string name = "linear_" + family->name();
    add(runs, name + "_bdf", problem, options_of(SFDAE_METHOD_BDF, 1e-6), {.outputs = 4, .checkpoint = true});
    add(runs, name + "_radau", problem, options_of(SFDAE_METHOD_RADAU, 1e-8),
        {.outputs = 4, .checkpoint = true, .events = true});
    add(runs, name + "_svd", constant_family_problem(family, p.t0, p.tf).from(p.x0),
        with_reduction(options_of(SFDAE_METHOD_AUTOMATIC, 1e-4), SFDAE_REDUCTION_SVD), {.outputs = 12});
  }
}

void add_families(Runs& runs) {
  for (const int n : {4, 8, 13})
    for (int mu = 0; mu <= 3; ++mu)
      for (const int method : methods) {
        const double tol = method == SFDAE_METHOD_BDF ? 1e-4 : method == SFDAE_METHOD_RADAU ? 1e-10 : 1e-6;
        const Family family = kron(n, mu, 0.5, n == 13 ? 1 : 0, mu);
        add(runs, "kron_" + std::to_string(n) + "_" + std::to_string(mu) + "_" + name_of(method),
            family_problem(family, 0.0, 1.0), options_of(method, tol), {.outputs = 3});
      }
  const Family large = kron(32, 1), wide = kron(20, 2, 0.5, 3);
  add(runs, "kron_32", family_problem(large, 0.0, 0.3), options_of());
  add(runs, "kron_20_free", family_problem(wide, 0.0, 0.5), options_of(SFDAE_METHOD_RADAU));
  add(runs, "kron_stiff", family_problem(Family(kron(6, 1, 0.5, 0, 1, 1e4)), 0.0, 1.0), options_of());
  add(runs, "kron_small_scale", family_problem(Family(kron(6, 2, 0.5, 0, 1, 1.0, 1e-9)), 0.0, 1.0), options_of());
  for (const int method : methods) {
    const std::string end = std::string("_") + name_of(method);
    add(runs, "chain_4_1" + end, family_problem(Family(chain(4, 1)), 0.0, 2.0), options_of(method, 1e-7),
        {.checkpoint = true});
    add(runs, "chain_8_3_fixed" + end, constant_family_problem(Family(chain(8, 3, 0.0)), 0.0, 2.0),
        options_of(method, 1e-6));
    add(runs, "chain_6_2_stiff" + end, family_problem(Family(chain(6, 2, 2.0, 100.0)), 0.0, 1.0),
        options_of(method, 1e-5), {.events = true});
    add(runs, "chain_4_2_steps" + end, family_problem(Family(chain(4, 2)), 0.0, 1.0), options_of(method, 1e-6),
        {.by_steps = true});
  }
}

void add_leading_terms(Runs& runs) {
  const Family families[] = {spin(-50.0, 1.0), spin(0.3, -0.5), rotated_ode(RowOperation::scaling),
                             rotated_ode(RowOperation::rotation, 10.0)};
  const char* const names[] = {"spin_hard", "spin_soft", "rows_scaled", "rows_turned"};
  for (std::size_t i = 0; i < std::size(families); ++i)
    for (const int leading :
         {SFDAE_LEADING_AUTOMATIC, SFDAE_LEADING_PROJECTOR, SFDAE_LEADING_MATRIX, SFDAE_LEADING_IDENTITY})
      for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
        sfdae_options options = options_of(method, 1e-5);
        options.leading_term = leading;
        options.max_steps = 2000;
        add(runs, std::string(names[i]) + "_leading_" + std::to_string(leading) + "_" + name_of(method),
            family_problem(families[i], 0.0, 0.5), options, {.outputs = 2});
      }
}

void add_random_families(Runs& runs) {
  RandomOptions kind;
  kind.max_size = 9;
  for (std::uint64_t seed = 1; seed <= 45; ++seed) {
    const int method = methods[seed % 3];
    const int reduction = seed % 4 == 0 ? SFDAE_REDUCTION_SVD : SFDAE_REDUCTION_STAGED;
    add(runs, "random_" + std::to_string(seed), family_problem(Family(random_family(seed, kind)), 0.0, 0.7),
        with_reduction(options_of(method, seed % 2 == 0 ? 1e-6 : 1e-8), reduction),
        {.outputs = 2, .by_steps = seed % 5 == 0, .checkpoint = seed % 7 == 0, .events = seed % 11 == 0});
  }
  kind.row_decades = 6;
  for (std::uint64_t seed = 101; seed <= 110; ++seed)
    add(runs, "random_rows_" + std::to_string(seed), family_problem(Family(random_family(seed, kind)), 0.2, -0.4),
        options_of(methods[seed % 2], 1e-6));
  kind.row_decades = 0;
  kind.rho = 1e-3;
  for (std::uint64_t seed = 201; seed <= 210; ++seed) {
    sfdae_options options = options_of(methods[seed % 2], 1e-6);
    options.ignore_inconsistency = seed % 3 == 0 ? 1 : 0;
    if (seed % 5 == 0) options.consistency_tol = 1e-2;
    add(runs, "random_contradiction_" + std::to_string(seed),
        family_problem(Family(random_family(seed, kind)), 0.0, 0.5), options);
  }
}

// On to the change, then a new analysis beyond it.
void pass_change(Trace& trace, const Problem& problem, const sfdae_options& options) {
  Session session(trace, problem, options);
  if (session.start() < 0) return session.describe();
  session.outputs(problem.tf, 3);
  session.describe();
  session.advance(problem.tf);
  const double beyond = session.t + 0.01 * (problem.tf - problem.t0);
  if (session.start(beyond, problem.tf, session.x) < 0) {
    session.analyze(beyond, problem.tf);
    session.describe();
    if (session.start(beyond, problem.tf, session.x) < 0) return;
  }
  session.outputs(problem.tf, 2);
  session.describe();
}

void add_changes(Runs& runs) {
  const auto add_change = [&runs](const std::string& name, LinearTestProblem p) {
    const Problem problem = family_problem(Family(std::move(p.family)), p.t0, p.tf).from(p.x0);
    for (const int method : methods)
      runs.push_back({"change_" + name + "_" + name_of(method),
                      [=](Trace& trace) { pass_change(trace, problem, options_of(method, 1e-6)); }});
  };
  add_change("vanishing_E", vanishing_E());
  add_change("vanishing_E_growing", vanishing_E(1.0));
  add_change("vanishing_A", vanishing_A());
  add_change("structure", changing_structure());
  add_change("structure_late", changing_structure(0.8));
  add_change("rankdrop", rankdrop_t());
}

void add_unclear_ranks(Runs& runs) {
  for (const double eps : {1e-6, 1e-12, 1e-13, 3e-14, 1e-14, 1e-15, 1e-16})
    for (const int reduction : {SFDAE_REDUCTION_STAGED, SFDAE_REDUCTION_SVD}) {
      LinearTestProblem p = singular_perturbation(eps);
      add(runs, "perturbation_" + text(eps) + (reduction == SFDAE_REDUCTION_SVD ? "_svd" : "_staged"),
          family_problem(Family(std::move(p.family)), p.t0, p.tf).from(p.x0),
          with_reduction(options_of(SFDAE_METHOD_RADAU, 1e-5), reduction), {.outputs = 1});
    }
  for (const double rank_tol : {1e-20, 1e-10, 1e-3}) {
    LinearTestProblem p = singular_perturbation(1e-8);
    sfdae_options options = options_of();
    options.rank_tol = rank_tol;
    add(runs, "perturbation_rank_tol_" + text(rank_tol),
        family_problem(Family(std::move(p.family)), p.t0, p.tf).from(p.x0), options, {.outputs = 1});
  }
  for (const int max_index : {0, 2, 3, 12}) {
    LinearTestProblem p = nilpotent(4);
    sfdae_options options = options_of();
    options.max_index = max_index;
    add(runs, "nilpotent_4_max_index_" + std::to_string(max_index),
        family_problem(Family(std::move(p.family)), p.t0, p.tf).from(p.x0), options);
  }
  LinearTestProblem deep = nilpotent(7);
  add(runs, "nilpotent_7_index_too_high",
      family_problem(Family(std::move(deep.family)), deep.t0, deep.tf).from(deep.x0), options_of());
}

void add_inspections(Runs& runs) {
  const auto inspect = [&runs](const std::string& name, const Family& family, int reduction) {
    const Problem problem = family_problem(family, 0.1, 1.0);
    runs.push_back({"inspect_" + name, [=](Trace& trace) {
                      Session session(trace, problem, with_reduction(options_of(), reduction));
                      session.analyze(0.1, 1.0);
                      session.describe();
                      session.inspect(0.1, 0);
                      session.inspect(0.37, family->values().mu);
                      session.inspect(0.9, family->values().mu + 1);
                    }});
  };
  for (int mu = 0; mu <= 3; ++mu) {
    inspect("kron_5_" + std::to_string(mu), Family(kron(5, mu)), SFDAE_REDUCTION_STAGED);
    inspect("kron_6_1_" + std::to_string(mu) + "_svd", Family(kron(6, mu, 0.5, 1)), SFDAE_REDUCTION_SVD);
  }
  inspect("chain", Family(chain(3, 1)), SFDAE_REDUCTION_STAGED);
  inspect("underdetermined", Family(lin_underdet().family), SFDAE_REDUCTION_STAGED);
  inspect("overdetermined", Family(lin_overdet_consistent().family), SFDAE_REDUCTION_STAGED);
  inspect("free", Family(km_ex31_underdet().family), SFDAE_REDUCTION_STAGED);
  RandomOptions kind;
  kind.max_size = 5;
  for (std::uint64_t seed = 1; seed <= 4; ++seed)
    inspect("random_" + std::to_string(seed), Family(random_family(seed, kind)),
            seed % 2 == 0 ? SFDAE_REDUCTION_SVD : SFDAE_REDUCTION_STAGED);
}

}  // namespace

void add_linear_runs(Runs& runs) {
  add_test_set(runs);
  add_families(runs);
  add_leading_terms(runs);
  add_random_families(runs);
  add_changes(runs);
  add_unclear_ranks(runs);
  add_inspections(runs);
}

}  // namespace sfdae_bench
