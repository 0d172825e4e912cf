// Memory that is missing where more than usual is going on: changes of ranks and of methods, differences of
// derivatives, free and redundant parts, formulas with mistakes.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "calls_on_a_handle.h"
#include "sfdae/sfdae.h"

namespace sfdae::test {
namespace {

constexpr double quarter = 1.5707963267948966;  // of a turn

int create_linear(sfdae_solver** solver, const sfdae_options& options, int m, int n, sfdae_matrix_function E,
                  sfdae_matrix_function A, sfdae_vector_function f) {
  sfdae_linear_problem problem;
  sfdae_linear_problem_init(&problem, sizeof problem);
  problem.num_equations = m, problem.num_unknowns = n;
  problem.E = E, problem.A = A, problem.f = f;
  return sfdae_create_linear(solver, &problem, &options);
}

class Methods : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(FailingAllocations, Methods, testing::Values(SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU));

// (t - 1/2) x2' = x1 + sin t,  0 = x2 + cos t,  x3' = -x3: E has another rank at t = 1/2, where steps have to end.
int drop_E(double t, int order, double* E, void*) {
  E[3] = order == 0 ? t - 0.5 : order == 1 ? 1.0 : 0.0;
  if (order == 0) E[8] = 1.0;
  return 0;
}
int drop_A(double, int order, double* A, void*) {
  if (order == 0) A[0] = A[4] = 1.0, A[8] = -1.0;
  return 0;
}
int drop_f(double t, int order, double* f, void*) {
  f[0] = std::sin(t + order * quarter);
  f[1] = std::cos(t + order * quarter);
  return 0;
}

TEST_P(Methods, WhereTheRankOfEChanges) {
  sfdae_options until = options_of(GetParam(), 1e-3);
  until.use_stop_time = 1;
  until.stop_time = 0.5;
  const std::vector<double> x = {0.0, -1.0, 1.0};
  const auto create = [](sfdae_solver** solver, const sfdae_options& options) {
    return create_linear(solver, options, 3, 3, drop_E, drop_A, drop_f);
  };
  run_with_faults({"rank of E",
                   x,
                   {create_call(create, until), set_options("stop at the change", until), analyze(x, false),
                    start("start", x), advance("advance to the change", 0.5),
                    set_options("no stop", options_of(GetParam(), 1e-3)), advance("advance beyond", 1.0)}});
}

// x1' = -x1,  (t - 1/2) x2' = x2: d = 1 at t = 1/2.
int vanishing_E(double t, int order, double* E, void*) {
  if (order == 0) E[0] = 1.0, E[3] = t - 0.5;
  if (order == 1) E[3] = 1.0;
  return 0;
}
int vanishing_A(double, int order, double* A, void*) {
  if (order == 0) A[0] = -1.0, A[3] = 1.0;
  return 0;
}

TEST_P(Methods, WhereCharacteristicValuesChange) {
  const auto create = [](sfdae_solver** solver, const sfdae_options& options) {
    return create_linear(solver, options, 2, 2, vanishing_E, vanishing_A, nullptr);
  };
  const std::vector<double> x = {1.0, -0.5};
  Call changed = advance("advance to the change", 1.0);
  changed.failure = SFDAE_CHARACTERISTICS_CHANGED;
  run_with_faults({"characteristic values",
                   x,
                   {create_call(create, options_of(GetParam(), 1e-3)), start("start", x), changed, get_change()}});
}

// y1' = t y2 - y1 + z,  y2' = y1 + z cos t,  0 = y1 + (2 + t) y2 - sin t without derivatives.
int plain_E(double, int order, double* E, void*) {
  if (order > 0) return SFDAE_ORDER_NOT_AVAILABLE;
  E[0] = E[4] = 1.0;
  return 0;
}
int plain_A(double t, int order, double* A, void*) {
  if (order > 0) return SFDAE_ORDER_NOT_AVAILABLE;
  const double entries[] = {-1.0, 1.0, -1.0, t, 0.0, -2.0 - t, 1.0, std::cos(t), 0.0};
  std::copy(entries, entries + 9, A);
  return 0;
}
int plain_f(double t, int order, double* f, void*) {
  if (order > 0) return SFDAE_ORDER_NOT_AVAILABLE;
  f[2] = std::sin(t);
  return 0;
}

TEST_P(Methods, WithDifferencesOfDerivatives) {
  sfdae_options options = options_of(GetParam(), 1e-3);
  options.difference_derivatives = 1;
  const auto create = [](sfdae_solver** solver, const sfdae_options& with) {
    return create_linear(solver, with, 3, 3, plain_E, plain_A, plain_f);
  };
  const std::vector<double> x = {0.3, 0.1, 0.2};
  std::vector<Call> calls = {create_call(create, options), set_options("set options", options), start("start", x),
                             advance("advance", 0.5)};
  for (Call& call : checkpoint_calls()) calls.push_back(std::move(call));
  calls.push_back(restore());
  calls.push_back(advance("advance after restore", 1.0));
  // Spacings are chosen for the orders needed so far: the first start chooses them for x and again for x', a second
  // one with the same analysis has those for x' from its beginning, failures or not. Second derivatives by differences
  // have errors of about 1e-11.
  run_with_faults({"differences", x, calls, 1e-10});
}

// x1' = x1 + x2,  0 = x3 - sin t,  0 = 2 x3 - 2 sin t - 1e-3: x2 is free, and the last two contradict each other.
int free_E(double, int order, double* E, void*) {
  if (order == 0) E[0] = 1.0;
  return 0;
}
int free_A(double, int order, double* A, void*) {
  if (order == 0) A[0] = A[3] = A[7] = 1.0, A[8] = 2.0;
  return 0;
}
int free_f(double t, int order, double* f, void*) {
  f[1] = -std::sin(t + order * quarter);
  f[2] = 2.0 * f[1] - (order == 0 ? 1e-3 : 0.0);
  return 0;
}

TEST_P(Methods, WithFreeComponentsAndContradictions) {
  sfdae_options options = options_of(GetParam(), 1e-3);
  options.ignore_inconsistency = 1;
  const auto create = [](sfdae_solver** solver, const sfdae_options& with) {
    return create_linear(solver, with, 3, 3, free_E, free_A, free_f);
  };
  const std::vector<double> x = {0.3, 0.1, 0.2};
  run_with_faults(
      {"free components",
       x,
       {create_call(create, options), set_options("set options", options), analyze(x, false), make_consistent(x),
        start("start", x), advance("advance", 0.5), advance("advance further", 1.0)}});
}

// The same without the contradiction, x2 prescribed.
int consistent_f(double t, int order, double* f, void*) {
  f[1] = -std::sin(t + order * quarter);
  f[2] = 2.0 * f[1];
  return 0;
}
int prescribed_value(double t, int, double* value, void*) {
  value[0] = std::cos(t);
  return 0;
}

TEST_P(Methods, WithPrescribedComponents) {
  const auto create = [](sfdae_solver** solver, const sfdae_options& options) {
    static const int components[] = {1};
    sfdae_linear_problem problem;
    sfdae_linear_problem_init(&problem, sizeof problem);
    problem.num_equations = problem.num_unknowns = 3;
    problem.E = free_E, problem.A = free_A, problem.f = consistent_f;
    problem.constant_E = problem.constant_A = 1;
    problem.num_prescribed = 1, problem.prescribed = components, problem.prescribed_values = prescribed_value;
    return sfdae_create_linear(solver, &problem, &options);
  };
  const std::vector<double> x = {0.3, 0.1, 0.2};
  run_with_faults({"prescribed components",
                   x,
                   {create_call(create, options_of(GetParam(), 1e-3)), start("start", x), advance("advance", 0.5),
                    advance("advance further", 1.0)}});
}

// x1' = x2,  x2' = -x1: many outputs make the automatic method change to BDF.
int oscillator_E(double, int order, double* E, void*) {
  if (order == 0) E[0] = E[3] = 1.0;
  return 0;
}
int oscillator_A(double, int order, double* A, void*) {
  if (order == 0) A[1] = -1.0, A[2] = 1.0;
  return 0;
}

Call many_outputs(double until) {
  return {"many outputs",
          [until](Session& s) {
            int status = SFDAE_OK;
            for (; s.outputs < std::lround(until * 100.0) && status == SFDAE_OK;
                 s.outputs += status == SFDAE_OK ? 1 : 0)
              status = armed([&] {
                const double tout = 0.01 * static_cast<double>(s.outputs + 1);
                return sfdae_advance(s.solver, tout, &s.t, s.x.data(), s.xdot.data());
              });
            if (status >= 0) keep_point(s);
            return status;
          },
          true};
}

TEST(FailingAllocations, WhereTheMethodChanges) {
  const auto create = [](sfdae_solver** solver, const sfdae_options& options) {
    return create_linear(solver, options, 2, 2, oscillator_E, oscillator_A, nullptr);
  };
  const std::vector<double> x = {0.0, 1.0};
  run_with_faults(
      {"automatic method",
       x,
       {create_call(create, options_of(SFDAE_METHOD_AUTOMATIC, 1e-4)), start("start", x), many_outputs(3.0)}});
}

// (1 + t p) x1' = x2 + exp(p t),  0 = x1 - p sin(x1 - x1 + t) recorded; linear as x1 - x1 vanishes.
int record_linear(sfdae_record* record, sfdae_expression t, const sfdae_expression* x, const sfdae_expression* xdot,
                  sfdae_expression* F, void*) {
  const sfdae_expression p = sfdae_parameter(record, "p", 0.5), pt = sfdae_multiply(p, t);
  F[0] = sfdae_subtract(sfdae_multiply(sfdae_add(sfdae_number(1.0), pt), xdot[0]), sfdae_add(x[1], sfdae_exp(pt)));
  F[1] = sfdae_subtract(x[0], sfdae_multiply(p, sfdae_sin(t)));
  return 0;
}

TEST_P(Methods, WithRecordedLinearEquations) {
  const auto create = [](sfdae_solver** solver, const sfdae_options& options) {
    return create_recorded(solver, options, 2, record_linear);
  };
  const auto set_parameter = [](double value) {
    return Call{"set parameter",
                [value](Session& s) { return armed([&] { return sfdae_set_parameter(s.solver, "p", value); }); }};
  };
  sfdae_options options = options_of(GetParam(), 1e-3);
  options.reduction = SFDAE_REDUCTION_SVD;
  const std::vector<double> x = {0.0, 0.0};
  run_with_faults({"recorded linear equations",
                   x,
                   {create_call(create, options), set_parameter(0.5), start("start", x), advance("advance", 0.5),
                    set_parameter(0.7), start("start with parameter", x), advance("advance with parameter", 0.5)}});
}

// All operations; that of index 0 is to be wrong where `user` says so.
int record_operations(sfdae_record* record, sfdae_expression t, const sfdae_expression* x,
                      const sfdae_expression* xdot, sfdae_expression* F, void* user) {
  const sfdae_expression p = sfdae_parameter(record, "a parameter with a name that is longer than usual", 2.0);
  const sfdae_expression a = sfdae_add(sfdae_multiply(x[0], x[0]), sfdae_number(2.0));
  sfdae_expression sum = sfdae_power(a, p);
  for (auto operation : {sfdae_sqrt, sfdae_exp, sfdae_log, sfdae_sin, sfdae_cos, sfdae_tan, sfdae_atan, sfdae_sinh,
                         sfdae_cosh, sfdae_tanh, sfdae_abs, sfdae_negate})
    sum = sfdae_add(sum, operation(a));
  sum = sfdae_add(sum, sfdae_add(sfdae_asin(sfdae_divide(t, a)), sfdae_acos(sfdae_divide(t, a))));
  sum = sfdae_add(sum, sfdae_atan2(t, sfdae_max(a, sfdae_min(t, p))));
  F[0] = sfdae_subtract(xdot[0], sfdae_choose(t, sfdae_multiply(sfdae_number(1e-6), sum), a));
  if (user != nullptr) F[0] = sfdae_add(F[0], sfdae_log(sfdae_number(-1.0)));
  return 0;
}

Call operations_call(bool is_wrong, bool checks) {
  static int mark;
  return {checks ? "check" : "create",
          [=](Session& s) {
            sfdae_nonlinear_problem problem;
            sfdae_nonlinear_problem_init(&problem, sizeof problem);
            problem.num_equations = problem.num_unknowns = 1;
            problem.equations = record_operations;
            problem.user = is_wrong ? &mark : nullptr;
            char text[300] = "";
            const int status = armed([&] {
              return checks ? sfdae_check_nonlinear(&problem, nullptr, text, sizeof text)
                            : sfdae_create_nonlinear(&s.solver, &problem, nullptr);
            });
            const bool says_so = std::string(text).find("out of memory.") != std::string::npos;
            EXPECT_EQ(checks && status == SFDAE_OUT_OF_MEMORY, says_so) << text;
            return status;
          },
          false, is_wrong ? SFDAE_ILLEGAL_ARGUMENT : SFDAE_OK};
}

TEST(FailingAllocations, InFormulasWithAndWithoutMistakes) {
  run_with_faults({"mistakes in formulas",
                   {},
                   {operations_call(true, false), operations_call(true, true), operations_call(false, true)}});
  run_with_faults(
      {"formulas", {1.0}, {operations_call(false, false), start("start", {1.0}), advance("advance", 0.5)}});
}

}  // namespace
}  // namespace sfdae::test
