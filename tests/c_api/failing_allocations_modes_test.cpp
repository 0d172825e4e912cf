// SPDX-License-Identifier: BSD-3-Clause
//
// Memory that is missing at jumps and breakpoints.
#include <gtest/gtest.h>

#include <vector>

#include "calls_on_a_handle.h"
#include "sfdae/modes.h"

namespace sfdae::test {
namespace {

class Modes : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(FailingAllocations, Modes, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

sfdae_expression step_at_half(const sfdae_expression& t) {
  return sfdae_choose(sfdae_less(t, sfdae_number(0.5)), sfdae_number(0.0), sfdae_number(1.0));
}

// q' = i, q = v + v^3, v = s(t), w' = v - w: nonlinear, mu = 1; the index of x' = y, x = s(t) beside an ODE where
// linear.
int driven_capacitor(sfdae_record*, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                     sfdae_expression* F, void*) {
  F[0] = sfdae_subtract(xdot[0], x[2]);
  F[1] = sfdae_subtract(x[0], sfdae_add(x[1], sfdae_multiply(x[1], sfdae_multiply(x[1], x[1]))));
  F[2] = sfdae_subtract(x[1], step_at_half(t));
  F[3] = sfdae_subtract(xdot[3], sfdae_subtract(x[1], x[3]));
  return 0;
}
int driven_line(sfdae_record*, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                sfdae_expression* F, void*) {
  F[0] = sfdae_subtract(xdot[0], x[2]);
  F[1] = sfdae_subtract(x[0], x[1]);
  F[2] = sfdae_subtract(x[1], step_at_half(t));
  F[3] = sfdae_subtract(xdot[3], sfdae_subtract(x[1], x[3]));
  return 0;
}

template <sfdae_equations_function equations>
int create(sfdae_solver** solver, const sfdae_options& options) {
  return create_recorded(solver, options, 4, equations);
}

std::vector<Call> calls_across_a_jump(Create create, int method, const std::vector<double>& x) {
  return {create_call(create, options_of(method, 1e-4)),
          {"set breakpoints",
           [](Session& s) {
             const double t[] = {0.25, 0.5};
             const int kinds[] = {SFDAE_BREAKPOINT_KINK, SFDAE_BREAKPOINT_JUMP};
             return armed([&] { return sfdae_set_breakpoints(s.solver, 2, t, kinds); });
           }},
          start("start", x),
          advance("advance to the jump", 0.3),
          advance("advance across the jump", 1.0),
          {"jump", [x](Session& s) {
             std::vector<double> after(x), impulses(x.size());
             const int status =
                 armed([&] { return sfdae_jump(s.solver, 0.6, 1.0, x.data(), after.data(), 1, impulses.data()); });
             s.result = after;
             s.result.insert(s.result.end(), impulses.begin(), impulses.end());
             return status;
           }}};
}

TEST_P(Modes, WithJumpsOfNonlinearEquations) {
  const std::vector<double> x = {0.0, 0.0, 0.0, 0.5};
  run_with_faults(
      {"jumps of nonlinear equations", x, calls_across_a_jump(create<driven_capacitor>, GetParam(), x), 1e-2});
}

TEST_P(Modes, WithJumpsOfLinearEquations) {
  const std::vector<double> x = {0.0, 0.0, 0.0, 0.5};
  run_with_faults({"jumps of linear equations", x, calls_across_a_jump(create<driven_line>, GetParam(), x), 1e-2});
}

}  // namespace
}  // namespace sfdae::test
