// Memory that is missing where equations have functions of the user's, tables and derivatives.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "calls_on_a_handle.h"
#include "sfdae/sfdae.h"

namespace sfdae::test {
namespace {

class FunctionMethods : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(FailingAllocations, FunctionMethods, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

// a b, whose derivatives above the second vanish.
int product(int order, const double* a, double* derivatives, void*) {
  if (order == 0) derivatives[0] = a[0] * a[1];
  if (order == 1) derivatives[0] = a[1], derivatives[1] = a[0];
  if (order == 2) derivatives[1] = derivatives[2] = 1.0;
  return 0;
}

sfdae_expression times(const sfdae_expression& a, const sfdae_expression& b) {
  const sfdae_expression arguments[] = {a, b};
  return sfdae_external("a product that is computed by a function of the user's", product, 2, arguments, nullptr);
}

sfdae_expression force_of_time(const sfdae_expression& t) {
  static const double x[] = {-1.0, 0.0, 0.4, 1.0, 2.0}, y[] = {0.0, 0.5, 0.0, 1.0, 0.0};
  return sfdae_table(t, 3, 5, x, y);
}

// A pendulum whose products are functions, whose forces are derivatives and which is driven by a table.
int pendulum_with_functions(sfdae_record*, sfdae_expression t, const sfdae_expression* x,
                            const sfdae_expression* xdot, sfdae_expression* F, void*) {
  F[4] = sfdae_subtract(sfdae_add(times(x[0], x[0]), times(x[1], x[1])), sfdae_number(1.0));
  for (int i = 0; i < 2; ++i) {
    F[i] = sfdae_subtract(xdot[i], x[i + 2]);
    F[i + 2] = sfdae_add(xdot[i + 2], times(x[4], sfdae_derivative(F[4], x[i])));
  }
  F[3] = sfdae_add(F[3], force_of_time(t));
  return 0;
}

int create_pendulum_with_functions(sfdae_solver** solver, const sfdae_options& options) {
  return create_recorded(solver, options, 5, pendulum_with_functions);
}

TEST_P(FunctionMethods, WithFunctionsInNonlinearEquations) {
  const std::vector<double> x = {1.0, 0.0, 0.0, 0.0, 0.0};
  std::vector<Call> calls = {create_call(create_pendulum_with_functions, options_of(GetParam(), 1e-3)),
                             start("start", x), advance("advance", 0.5)};
  for (Call& call : checkpoint_calls()) calls.push_back(std::move(call));
  calls.push_back(restore());
  calls.push_back(advance("advance after restore", 1.0));
  // Several tolerances: what has lost its linearization has other errors of iterations.
  run_with_faults({"functions in nonlinear equations", x, calls, 1e-2});
}

// The same as a mechanical system.
int record_body(sfdae_record*, sfdae_expression t, const sfdae_expression* q, const sfdae_expression*,
                const sfdae_multibody_formulas* to, void*) {
  to->M[0] = to->M[3] = sfdae_number(1.0);
  to->f[1] = sfdae_negate(force_of_time(t));
  to->g[0] = sfdae_subtract(sfdae_add(times(q[0], q[0]), times(q[1], q[1])), sfdae_number(1.0));
  return 0;
}

int create_body(sfdae_solver** solver, const sfdae_options& options) {
  sfdae_multibody_problem problem;
  sfdae_multibody_problem_init(&problem, sizeof problem);
  problem.num_positions = 2;
  problem.num_constraints = 1;
  problem.equations = record_body;
  return sfdae_create_multibody(solver, &problem, &options);
}

TEST_P(FunctionMethods, WithFunctionsInMechanicalSystems) {
  const std::vector<double> x = {1.0, 0.0, 0.0, 0.0, 0.0};
  run_with_faults({"functions in mechanical systems",
                   x,
                   {create_call(create_body, options_of(GetParam(), 1e-3)), start("start", x),
                    advance("advance", 0.5), advance("advance further", 1.0)}});
}

// x1' + t x2' = x1 + f, 0 = x2 - f with functions of time alone: linear.
int linear(sfdae_record*, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
           sfdae_expression* F, void*) {
  const sfdae_expression f = sfdae_add(times(t, t), force_of_time(t));
  F[0] = sfdae_subtract(sfdae_add(xdot[0], sfdae_multiply(t, xdot[1])), sfdae_add(x[0], f));
  F[1] = sfdae_subtract(x[1], f);
  return 0;
}

TEST_P(FunctionMethods, WithFunctionsInLinearEquations) {
  const auto create = [](sfdae_solver** solver, const sfdae_options& options) {
    return create_recorded(solver, options, 2, linear);
  };
  const std::vector<double> x = {1.0, 0.5};
  run_with_faults({"functions in linear equations",
                   x,
                   {create_call(create, options_of(GetParam(), 1e-3)), start("start", x), advance("advance", 0.5)}});
}

// Not defined beyond x = 1, which x reaches at t = 1/2: messages of the failure are made of what is there.
int fence(int order, const double* a, double* derivatives, void*) {
  if (a[0] > 1.0) return 7;
  if (order == 0) derivatives[0] = 1.0;
  return 0;
}

int fenced(sfdae_record*, sfdae_expression, const sfdae_expression* x, const sfdae_expression* xdot,
           sfdae_expression* F, void*) {
  F[0] = sfdae_subtract(xdot[0], sfdae_multiply(sfdae_number(2.0), sfdae_external("fence", fence, 1, x, nullptr)));
  return 0;
}

TEST_P(FunctionMethods, WhereAFunctionCannotBeEvaluated) {
  static const char* const names[] = {"balance of what comes and what goes"};
  const auto create = [](sfdae_solver** solver, const sfdae_options& options) {
    return create_recorded(solver, options, 1, fenced, names);
  };
  Call failed = advance("advance to the fence", 1.0);
  failed.failure = SFDAE_CALLBACK_FAILED;
  run_with_faults({"a function that fails",
                   {0.0},
                   {create_call(create, options_of(GetParam(), 1e-3)), start("start", {0.0}), failed}});
}

}  // namespace
}  // namespace sfdae::test
