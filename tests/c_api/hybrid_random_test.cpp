// SPDX-License-Identifier: BSD-3-Clause
//
// Random linear systems with known solutions piece by piece (weierstrass_modes.h) as hybrid systems that go back and
// forth between two modes at given times.

#include <sfdae/hybrid.h>

#include <gtest/gtest.h>

#include "weierstrass_solvers.h"

namespace {

using namespace sfdae_test;

struct HybridDeleter {
  void operator()(sfdae_hybrid* hybrid) const { sfdae_destroy_hybrid(&hybrid); }
};

// Changes at 0.3, 0.5, 0.6, 0.8 of the interval.
Outcome run(std::vector<Mode>& modes, int method, bool is_recorded) {
  const int n = modes[0].n();
  const double time = modes[0].time;
  const Tolerances tolerances(modes[0].unit, n);
  sfdae_options options;
  tolerances.set(options, method);
  BothModes both{{&modes[0], &modes[1]}};
  Solver solvers[2];
  sfdae_hybrid* created = nullptr;
  EXPECT_EQ(sfdae_create_hybrid(&created), SFDAE_OK);
  for (int k = 0; k < 2; ++k) {
    solvers[k] =
        is_recorded ? recorded_solver(both, options) : solver_of(modes[static_cast<std::size_t>(k)], options, true);
    if (is_recorded) {
      EXPECT_EQ(sfdae_set_parameter(solvers[k].get(), "s", k), SFDAE_OK);
    }
    EXPECT_EQ(sfdae_add_mode(created, solvers[k].get(), nullptr, nullptr), SFDAE_OK);
  }
  const std::unique_ptr<sfdae_hybrid, HybridDeleter> hybrid(created);
  const double parts[] = {0.3, 0.5, 0.6, 0.8, 1.0};
  for (int k = 0; k < 4; ++k) {
    sfdae_transition transition;
    sfdae_transition_init(&transition, sizeof transition);
    transition.from = k % 2;
    transition.to = 1 - k % 2;
    transition.kind = SFDAE_TRANSITION_TIME;
    transition.time = parts[k] * time;
    EXPECT_EQ(sfdae_add_transition(hybrid.get(), &transition, nullptr), SFDAE_OK);
  }
  Values y(static_cast<std::size_t>(modes[0].d));
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = std::cos(1.0 + static_cast<double>(i));
  double begin = 0.0, t = 0.0;
  Values x = modes[0].solution(0.0, 0.0, y);
  Outcome outcome;
  outcome.status = sfdae_start_hybrid(hybrid.get(), 0, 0.0, time, x.data(), nullptr);
  for (int k = 0; k < 5 && outcome.status >= 0; ++k) {
    const double end = parts[k] * time, inside = 0.5 * (begin + end);
    const Mode& mode = modes[static_cast<std::size_t>(k % 2)];
    outcome.status = sfdae_advance_hybrid(hybrid.get(), inside, &t, x.data(), nullptr);
    outcome.error = std::max(outcome.error, tolerances.error(x, mode.solution(inside, begin, y)));
    if (outcome.status >= 0) outcome.status = sfdae_advance_hybrid(hybrid.get(), end, &t, x.data(), nullptr);
    if (outcome.status < 0) break;
    const Values before = mode.solution(end, begin, y);
    const Mode& next = modes[static_cast<std::size_t>(k < 4 ? 1 - k % 2 : k % 2)];
    y = next.differential_part(before);
    begin = end;
    outcome.error = std::max(outcome.error, tolerances.error(x, next.solution(end, end, y)));
  }
  if (outcome.status < 0) {
    outcome.message = sfdae_get_hybrid_message(hybrid.get());
    return outcome;
  }
  for (int k = 0; k < 2; ++k) {
    sfdae_mode mode;
    sfdae_mode_init(&mode, sizeof mode);
    EXPECT_EQ(sfdae_get_mode(hybrid.get(), k, &mode), SFDAE_OK);
    EXPECT_EQ(mode.num_analyses, 1);
    EXPECT_EQ(mode.visits, 3 - k);
    EXPECT_EQ(mode.strangeness_index, modes[static_cast<std::size_t>(k)].mu);
    EXPECT_EQ(mode.differential, modes[static_cast<std::size_t>(k)].d);
  }
  return outcome;
}

TEST(HybridSystems, FollowSolutionsPieceByPiece) {
  for (int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU}) {
    Random random(41);
    Tally tally;
    const int count = scaled(500);
    for (int k = 0; k < count; ++k) {
      std::vector<Mode> modes = random_modes(random);
      tally.add(run(modes, method, k % 2 == 1), 20.0);
    }
    tally.print(method == SFDAE_METHOD_BDF ? "BDF" : "Radau");
    EXPECT_EQ(tally.wrong, 0);
    EXPECT_GE(tally.right, count - count / 50);
  }
}

}  // namespace
