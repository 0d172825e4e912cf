// SPDX-License-Identifier: BSD-3-Clause
// All problems whose equations are written as templates; those of tests/data/problems.json are in formula_problems.h.
#ifndef SFDAE_TESTS_TEST_SET_H
#define SFDAE_TESTS_TEST_SET_H

#include "akzo.h"
#include "andrews.h"
#include "car_axis.h"
#include "fekete.h"
#include "nand.h"
#include "pendulum.h"
#include "rigid_slider_crank.h"
#include "slider_crank.h"
#include "transistor_amplifier.h"

namespace sfdae_test {

// visit(problem, equations) for each: equations(segment, t, x, xdot, F) takes any scalar type. The segment counts the
// restarts passed so far; problems without restarts do not look at it.
template <class Visitor>
void for_each_problem_of_test_set(Visitor&& visit) {
  const auto smooth = [&visit](const TestProblem& problem, auto residual) {
    visit(problem,
          [residual](int, const auto& t, const auto* x, const auto* xdot, auto* F) { residual(t, x, xdot, F); });
  };
  smooth(pendulum(), [](const auto& t, auto... a) { pendulum_residual(t, a...); });
  smooth(car_axis(), [](const auto& t, auto... a) { car_axis_residual(t, a...); });
  smooth(rigid_slider_crank(), [](const auto& t, auto... a) { rigid_slider_crank_residual(t, a...); });
  smooth(slider_crank(), [](const auto& t, auto... a) { slider_crank_residual(t, a...); });
  smooth(andrews(), [](const auto& t, auto... a) { andrews_residual(t, a...); });
  smooth(fekete(), [](const auto& t, auto... a) { fekete_residual(t, a...); });
  smooth(fekete_position(), [](const auto& t, auto... a) { fekete_position_residual(t, a...); });
  smooth(transistor_amplifier(), [](const auto& t, auto... a) { transistor_amplifier_residual(t, a...); });
  smooth(akzo(), [](const auto& t, auto... a) { akzo_residual(t, a...); });
  visit(nand(), [](int segment, const auto& t, const auto* x, const auto* xdot, auto* F) {
    nand_residual(nand_inputs(t, segment), x, xdot, F);
  });
}

}  // namespace sfdae_test

#endif
