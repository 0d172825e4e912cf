// SPDX-License-Identifier: BSD-3-Clause
// Multibody systems: those of the test set, redundant and nonholonomic constraints, recorded and by callbacks, in both
// kinds of coordinates, and as general problems.
#include <string>

#include "multibody/chain.h"
#include "multibody/four_bar.h"
#include "multibody/knife_edge.h"
#include "multibody/models.h"
#include "session.h"

namespace sfdae_bench {

namespace {

using namespace sfdae_test;

constexpr int methods[] = {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU};

void add(Runs& runs, const std::string& name, const Problem& problem, const sfdae_options& options,
         const Plan& plan = {}) {
  runs.push_back({name, [=](Trace& trace) { solve(trace, problem, options, plan); }});
}

template <class System>
void add_system(Runs& runs, const std::string& name, const System& system, double t0, double tf,
                const std::vector<double>& guess, bool is_large = false) {
  for (const int method : methods) {
    const std::string end = std::string("_") + name_of(method);
    const auto of = [&](Form form, int coordinates = SFDAE_COORDINATES_ORTHOGONAL) {
      return mechanical_problem(system, form, t0, tf, guess, coordinates);
    };
    const double tol = method == SFDAE_METHOD_BDF ? 1e-6 : 1e-8;
    add(runs, "multibody_" + name + "_recorded" + end, of(Form::recorded), options_of(method, tol),
        {.checkpoint = true, .events = !is_large});
    if (is_large && method == SFDAE_METHOD_RADAU) continue;
    add(runs, "multibody_" + name + "_callbacks" + end, of(Form::callbacks), options_of(method, tol),
        {.outputs = 12, .checkpoint = true});
    add(runs, "multibody_" + name + "_permuted" + end, of(Form::recorded, SFDAE_COORDINATES_PERMUTATION),
        options_of(method, tol), {.outputs = 2, .by_steps = method == SFDAE_METHOD_BDF});
    add(runs, "multibody_" + name + "_permuted_callbacks" + end, of(Form::callbacks, SFDAE_COORDINATES_PERMUTATION),
        options_of(method, 1e-4), {.outputs = 2});
    if (is_large) continue;
    add(runs, "multibody_" + name + "_general" + end, of(Form::general), options_of(method, 1e-5), {.outputs = 2});
    add(runs, "multibody_" + name + "_extended" + end, of(Form::extended), options_of(method, tol), {.outputs = 2});
  }
}

}  // namespace

void add_multibody_runs(Runs& runs) {
  for_each_multibody_model([&runs](const TestProblem& p, const auto& system) {
    const double share = p.n > 100 ? 1e-5 : p.n > 20 ? 0.02 : 0.1;
    add_system(runs, p.name, system, p.t0, p.t0 + share * (p.tf - p.t0), p.x0, p.n > 100);
  });
  add_system(runs, "four_bar", FourBar(), 0.0, 0.7, four_bar_start(true));
  add_system(runs, "plane_four_bar", PlaneFourBar(), 0.0, 0.7, four_bar_start(false));
  add_system(runs, "knife_edge", KnifeEdge(), 0.0, 1.0, KnifeEdge::exact(0.0));
  add_system(runs, "knife_edge_backward", KnifeEdge(), 1.0, 0.0, KnifeEdge::exact(1.0));
  const PendulumChain chain(3), long_chain(12);
  add_system(runs, "chain_3", chain, 0.0, 0.3, chain.start());
  add_system(runs, "chain_12", long_chain, 0.0, 0.05, long_chain.start());
}

}  // namespace sfdae_bench
