// SPDX-License-Identifier: BSD-3-Clause
// The user's functions: called as promised, counted, checked, differentiated where they have to be.
#include "problem/linear_problem.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "c_api/problems.h"
#include "family_problem.h"
#include "matrix_checks.h"
#include "testset_linear.h"

namespace sfdae::core {

namespace {

using sfdae_test::Call;
using sfdae_test::Callback;
using sfdae_test::factorial;
using sfdae_test::FamilyProblem;
using sfdae_test::LinearFamily;
using sfdae_test::rounding;
using sfdae_test::size;
using Family = std::shared_ptr<const LinearFamily>;
using Numbers = std::vector<double>;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

// m = n = 2, all functions alike; what they do is set by members.
struct Probe {
  sfdae_linear_problem problem{};
  bool arrays_were_zero = true;
  int entry = -1;  // written with `value`
  double value = 0.0;
  Numbers prescribed{1.0, 2.0};
  int prescribed_code = 0;
  int indices[2] = {1, 0};

  Probe() {
    sfdae_linear_problem_init(&problem, sizeof problem);
    problem.num_equations = problem.num_unknowns = 2;
    problem.E =
        problem.A = [](double, int, double* out, void* user) { return static_cast<Probe*>(user)->write(out, 4); };
    problem.f = [](double, int, double* out, void* user) { return static_cast<Probe*>(user)->write(out, 2); };
    problem.num_prescribed = 2;
    problem.prescribed = indices;
    problem.prescribed_values = [](double, int, double* out, void* user) {
      const Probe& probe = *static_cast<Probe*>(user);
      std::copy(probe.prescribed.begin(), probe.prescribed.end(), out);
      return probe.prescribed_code;
    };
    problem.user = this;
  }
  int write(double* out, int count) {
    for (int i = 0; i < count; ++i) arrays_were_zero = arrays_were_zero && out[i] == 0.0;
    if (entry >= 0 && entry < count) out[entry] = value;
    return 0;
  }
};

// Largest difference to the exact derivative of order k of one function.
double error_of(ConstView computed, const LinearFamily& family, char which, double t, int k) {
  Matrix exact(computed.rows, computed.cols);
  if (which == 'E') family.E(t, k, exact.data());
  else if (which == 'A') family.A(t, k, exact.data());
  else family.f(t, k, exact.data());
  return sfdae_test::distance(computed, exact);
}

// Least and greatest time and the number of calls outside of limits.
struct TimesAsked {
  double lowest = infinity, highest = -infinity;
  std::function<int(const Call&)> hook() {
    return [this](const Call& call) {
      lowest = std::min(lowest, call.t);
      highest = std::max(highest, call.t);
      return 0;
    };
  }
};

}  // namespace

TEST(LinearProblem, ArraysAreZeroBeforeEveryCall) {
  Probe probe;
  probe.entry = 1;
  probe.value = 3.0;
  LinearProblem problem(functions_of(probe.problem));
  TaylorData data;
  for (int repetition = 0; repetition < 3; ++repetition) {
    ASSERT_EQ(problem.evaluate_plain(0.1 * repetition, {2, 1, 3}, data).status, SFDAE_OK);
    Numbers dirty(4, 77.0);
    ASSERT_EQ(problem.call('A', 0.0, 0, dirty.data()).status, SFDAE_OK);
    EXPECT_EQ(dirty, (Numbers{0.0, 3.0, 0.0, 0.0}));
  }
  EXPECT_TRUE(probe.arrays_were_zero);
}

TEST(LinearProblem, EveryOrderIsAskedForOnceAndCounted) {
  FamilyProblem callbacks((Family(sfdae_test::kron(4, 1))));
  LinearProblem problem(functions_of(callbacks.problem));
  TaylorData data;
  ASSERT_EQ(problem.evaluate(0.2, {1, 2, 3}, 0.0, data).status, SFDAE_OK);
  for (int k = 0; k <= 4; ++k) {
    EXPECT_EQ(callbacks.calls(Callback::E, k), k <= 1 ? 1 : 0);
    EXPECT_EQ(callbacks.calls(Callback::A, k), k <= 2 ? 1 : 0);
    EXPECT_EQ(callbacks.calls(Callback::f, k), k <= 3 ? 1 : 0);
  }
  EXPECT_EQ(problem.evaluations('E'), 2);
  EXPECT_EQ(problem.evaluations('A'), 3);
  EXPECT_EQ(problem.evaluations('f'), 4);
  EXPECT_EQ(data.t, 0.2);
}

TEST(LinearProblem, ValuesThatAreKeptAreAskedForOnce) {
  FamilyProblem callbacks((Family(sfdae_test::kron(16, 1))));
  LinearProblem problem(functions_of(callbacks.problem));
  TaylorData first, again, elsewhere;
  {
    const KeptValues kept(problem, 0.2);
    ASSERT_EQ(problem.evaluate(0.2, {1, 0, 1}, 0.0, first).status, SFDAE_OK);
    ASSERT_EQ(problem.evaluate_plain(0.2, {2, 1, 1}, again).status, SFDAE_OK);
    ASSERT_EQ(problem.evaluate(0.3, {0, 0, 0}, 0.0, elsewhere).status, SFDAE_OK);
    ASSERT_EQ(problem.evaluate(0.3, {0, 0, 0}, 0.0, elsewhere).status, SFDAE_OK);
    for (int k = 0; k <= 2; ++k) {
      const int elsewhere_twice = k == 0 ? 2 : 0;
      EXPECT_EQ(callbacks.calls(Callback::E, k), 1 + elsewhere_twice);
      EXPECT_EQ(callbacks.calls(Callback::A, k), (k <= 1 ? 1 : 0) + elsewhere_twice);
      EXPECT_EQ(callbacks.calls(Callback::f, k), (k <= 1 ? 1 : 0) + elsewhere_twice);
    }
    EXPECT_EQ(problem.evaluations('E'), 5);
    EXPECT_NE(first.kept_factorizations(), nullptr);
    EXPECT_EQ(elsewhere.kept_factorizations(), nullptr);
  }
  EXPECT_EQ(first.kept_factorizations(), nullptr);
  for (int k = 0; k <= 2; ++k) EXPECT_EQ(error_of(again.E(k), callbacks.family(), 'E', 0.2, k), 0.0);
  ASSERT_EQ(problem.evaluate(0.2, {0, 0, 0}, 0.0, first).status, SFDAE_OK);
  EXPECT_EQ(callbacks.calls(Callback::E, 0), 4);
}

TEST(LinearProblem, FailuresAndStopRequestsAreNotKept) {
  FamilyProblem callbacks((Family(sfdae_test::kron(4, 1))));
  LinearProblem problem(functions_of(callbacks.problem));
  TaylorData data;
  int failures = 1;
  callbacks.hooks.status = [&](const Call&) { return failures-- > 0 ? 1 : 0; };
  const KeptValues kept(problem, 0.2);
  EXPECT_EQ(problem.evaluate_plain(0.2, {0, -1, -1}, data).status, SFDAE_CALLBACK_FAILED);
  EXPECT_EQ(problem.evaluate_plain(0.2, {0, -1, -1}, data).status, SFDAE_OK);
  problem.request_stop();
  EXPECT_EQ(problem.evaluate_plain(0.2, {0, -1, -1}, data).status, SFDAE_STOPPED);
}

TEST(LinearProblem, PlainDerivativesAreThoseOfTheCallbacks) {
  const Family family(sfdae_test::kron(5, 2));
  FamilyProblem callbacks(family);
  LinearProblem problem(functions_of(callbacks.problem));
  TaylorData data;
  ASSERT_EQ(problem.evaluate_plain(0.3, {2, 3, 1}, data).status, SFDAE_OK);
  for (int k = 0; k <= 2; ++k) EXPECT_EQ(error_of(data.E(k), *family, 'E', 0.3, k), 0.0);
  for (int k = 0; k <= 3; ++k) EXPECT_EQ(error_of(data.A(k), *family, 'A', 0.3, k), 0.0);
  for (int k = 0; k <= 1; ++k) EXPECT_EQ(error_of({data.f(k), 5, 1, 5}, *family, 'f', 0.3, k), 0.0);
}

TEST(LinearProblem, OrdersOfMinusOneAreNotEvaluated) {
  FamilyProblem callbacks((Family(sfdae_test::kron(4, 1))));
  LinearProblem problem(functions_of(callbacks.problem));
  TaylorData data;
  ASSERT_EQ(problem.evaluate_plain(0.2, {-1, -1, 1}, data).status, SFDAE_OK);
  EXPECT_EQ(callbacks.calls(), 2);
  EXPECT_EQ(callbacks.calls(Callback::f), 2);
}

TEST(LinearProblem, ConstantsAreAskedForOnceAndHaveZeroDerivatives) {
  FamilyProblem callbacks(Family(std::move(sfdae_test::lin_underdet().family)));
  callbacks.declare_constants();
  LinearProblem problem(functions_of(callbacks.problem));
  EXPECT_TRUE(problem.is_constant());
  TaylorData data;
  for (double t : {0.0, 0.5, 0.7}) {
    ASSERT_EQ(problem.evaluate_plain(t, {2, 2, 1}, data).status, SFDAE_OK);
    for (int k = 0; k <= 2; ++k) {
      EXPECT_EQ(error_of(data.E(k), callbacks.family(), 'E', t, k), 0.0);
      EXPECT_EQ(error_of(data.A(k), callbacks.family(), 'A', t, k), 0.0);
    }
  }
  EXPECT_EQ(callbacks.calls(Callback::E), 1);
  EXPECT_EQ(callbacks.calls(Callback::A), 1);
  EXPECT_EQ(callbacks.calls(Callback::f), 6);
}

TEST(LinearProblem, AConstantThatFailedIsAskedForAgain) {
  FamilyProblem callbacks(Family(std::move(sfdae_test::lin_underdet().family)));
  callbacks.declare_constants();
  callbacks.hooks.status = sfdae_test::return_at_call(1, 7);
  LinearProblem problem(functions_of(callbacks.problem));
  TaylorData data;
  EXPECT_EQ(problem.evaluate_plain(0.0, {0, 0, 0}, data).status, SFDAE_CALLBACK_FAILED);
  EXPECT_EQ(problem.evaluate_plain(0.0, {0, 0, 0}, data).status, SFDAE_OK);
  EXPECT_EQ(callbacks.calls(Callback::E), 2);
}

TEST(LinearProblem, WithoutFTheInhomogeneityIsZero) {
  Probe probe;
  probe.problem.f = nullptr;
  LinearProblem problem(functions_of(probe.problem));
  TaylorData data;
  ASSERT_EQ(problem.evaluate_plain(0.0, {0, 0, 2}, data).status, SFDAE_OK);
  for (int k = 0; k <= 2; ++k)
    for (int i = 0; i < 2; ++i) EXPECT_EQ(data.f(k)[i], 0.0);
  EXPECT_EQ(problem.evaluations('f'), 0);
  EXPECT_TRUE(problem.is_constant('f'));
}

// ---- What goes wrong ----

TEST(LinearProblem, NumbersThatAreNotFiniteAreFoundByRowAndColumn) {
  for (double bad : {not_a_number, infinity, -infinity})
    for (int entry = 0; entry < 4; ++entry) {
      Probe probe;
      probe.entry = entry;
      probe.value = bad;
      LinearProblem problem(functions_of(probe.problem));
      TaylorData data;
      const CallbackError error = problem.evaluate(0.25, {0, 0, 0}, 0.0, data);
      EXPECT_EQ(error.status, SFDAE_NOT_FINITE);
      EXPECT_EQ(error.row, entry % 2);
      EXPECT_EQ(error.column, entry / 2);
      EXPECT_STREQ(error.function, "E");
      EXPECT_EQ(error.order, 0);
      EXPECT_EQ(error.t, 0.25);
      EXPECT_TRUE(error.is_recoverable());
      EXPECT_NE(error.message().find("row " + std::to_string(entry % 2)), std::string::npos);
    }
}

TEST(LinearProblem, NumbersTooLargeForProductsAreRefused) {
  Probe probe;
  probe.entry = 0;
  probe.value = 1.0;
  probe.problem.f = [](double, int, double* out, void*) {
    out[1] = 1e100;
    return 0;
  };
  LinearProblem problem(functions_of(probe.problem));
  TaylorData data;
  const CallbackError error = problem.evaluate(0.0, {0, 0, 0}, 0.0, data);
  EXPECT_EQ(error.status, SFDAE_NOT_FINITE);
  EXPECT_FALSE(error.message().empty());
}

TEST(LinearProblem, ReturnCodesBecomeStatuses) {
  struct Case {
    int code, status;
    bool recoverable;
  };
  for (const Case c : {Case{-1, SFDAE_CALLBACK_STOPPED, false},
                       {-77, SFDAE_CALLBACK_STOPPED, false},
                       {1, SFDAE_CALLBACK_FAILED, true},
                       {1000, SFDAE_CALLBACK_FAILED, true},
                       {SFDAE_ORDER_NOT_AVAILABLE, SFDAE_ORDER_MISSING, false}}) {
    FamilyProblem callbacks((Family(sfdae_test::kron(4, 1))));
    callbacks.hooks.status = sfdae_test::return_at_call(4, c.code);  // E twice, A order 0, A order 1
    LinearProblem problem(functions_of(callbacks.problem));
    TaylorData data;
    const CallbackError error = problem.evaluate(0.5, {1, 1, 1}, 0.0, data);
    EXPECT_EQ(error.status, c.status);
    EXPECT_EQ(error.code, c.code);
    EXPECT_STREQ(error.function, "A");
    EXPECT_EQ(error.order, 1);
    EXPECT_EQ(error.t, 0.5);
    EXPECT_EQ(error.is_recoverable(), c.recoverable);
    EXPECT_FALSE(error.message().empty());
    EXPECT_EQ(callbacks.calls(), 4);  // nothing is called afterwards
  }
}

TEST(LinearProblem, AStopRequestEndsTheEvaluationBeforeTheNextCall) {
  FamilyProblem callbacks((Family(sfdae_test::kron(4, 1))));
  LinearProblem problem(functions_of(callbacks.problem));
  callbacks.hooks.status = [&](const Call& call) {
    if (call.number == 3) problem.request_stop();
    return 0;
  };
  TaylorData data;
  EXPECT_EQ(problem.evaluate(0.5, {1, 1, 1}, 0.0, data).status, SFDAE_STOPPED);
  EXPECT_EQ(callbacks.calls(), 3);
  EXPECT_TRUE(problem.stop_is_requested());
  EXPECT_TRUE(problem.take_stop_request());
  EXPECT_FALSE(problem.take_stop_request());
  EXPECT_EQ(problem.evaluate(0.5, {1, 1, 1}, 0.0, data).status, SFDAE_OK);
}

TEST(LinearProblem, PrescribedValuesAreReadCheckedAndReported) {
  Probe probe;
  LinearProblem problem(functions_of(probe.problem));
  EXPECT_EQ(problem.prescribed(), (std::vector<int>{1, 0}));
  Numbers values(2);
  EXPECT_EQ(problem.evaluate_prescribed(0.0, values.data()).status, SFDAE_OK);
  EXPECT_EQ(values, probe.prescribed);
  for (int code : {4, -4}) {
    probe.prescribed_code = code;
    EXPECT_EQ(problem.evaluate_prescribed(0.0, values.data()).status,
              code > 0 ? SFDAE_CALLBACK_FAILED : SFDAE_CALLBACK_STOPPED);
  }
  probe.prescribed_code = 0;
  probe.prescribed[1] = not_a_number;
  EXPECT_EQ(problem.evaluate_prescribed(0.0, values.data()).status, SFDAE_NOT_FINITE);
}

TEST(LinearProblem, CopiesThePrescribedIndices) {
  Probe probe;
  LinearProblem problem(functions_of(probe.problem));
  probe.indices[0] = 99;
  EXPECT_EQ(problem.prescribed(), (std::vector<int>{1, 0}));
}

// ---- Derivatives by differences ----

TEST(LinearProblem, AMissingOrderIsNamedUnlessDifferencesAreAllowed) {
  FamilyProblem callbacks((Family(sfdae_test::kron(4, 1))));
  callbacks.hooks.highest_order = 1;
  LinearProblem problem(functions_of(callbacks.problem));
  TaylorData data;
  const CallbackError error = problem.evaluate_plain(0.5, {1, 2, 1}, data);
  EXPECT_EQ(error.status, SFDAE_ORDER_MISSING);
  EXPECT_STREQ(error.function, "A");
  EXPECT_EQ(error.order, 2);
  problem.set_differences({true, 0.0, 1.0});
  EXPECT_EQ(problem.evaluate_plain(0.5, {1, 2, 1}, data).status, SFDAE_OK);
}

TEST(LinearProblem, OrderZeroCannotBeReplaced) {
  FamilyProblem callbacks((Family(sfdae_test::kron(4, 1))));
  callbacks.hooks.highest_order = -1;
  LinearProblem problem(functions_of(callbacks.problem));
  problem.set_differences({true, 0.0, 1.0});
  TaylorData data;
  const CallbackError error = problem.evaluate_plain(0.5, {1, 1, 1}, data);
  EXPECT_EQ(error.status, SFDAE_ORDER_MISSING);
  EXPECT_EQ(error.order, 0);
}

// The largest error of a derivative over the one reported for that entry, beyond the rounding of the exact value.
double worst_share_of_error(const TaylorData& data, const LinearFamily& family, char which, int k) {
  const int rows = family.m(), columns = which == 'f' ? 1 : family.n();
  std::vector<double> exact(size(rows) * size(columns));
  if (which == 'E') family.E(data.t, k, exact.data());
  else if (which == 'A') family.A(data.t, k, exact.data());
  else family.f(data.t, k, exact.data());
  const double* computed = which == 'E' ? data.E(k).data : which == 'A' ? data.A(k).data : data.f(k);
  const double* errors = data.has_errors(which) ? data.errors(which, k) : nullptr;
  double worst = 0.0;
  for (std::size_t e = 0; e < exact.size(); ++e) {
    const double error = std::fabs(computed[e] - exact[e]) - rounding(1) * std::fabs(exact[e]);
    if (error > 0.0) worst = std::max(worst, error / (errors != nullptr ? errors[e] : 0.0));
  }
  return worst;
}

double largest_error(const TaylorData& data, char which, int k) {
  double largest = 0.0;
  for (int i = 0; i < data.m; ++i) largest = std::max(largest, data.error_of_row(which, k, i));
  return largest;
}

// The reported error is an estimate: the true one may be a few times as large. It holds for every entry.
TEST(LinearProblem, DifferencesAreAsGoodAsTheySay) {
  for (const Family& family : {Family(sfdae_test::kron(5, 2, 1.0)), Family(sfdae_test::kron(4, 1, 5.0)),
                               Family(sfdae_test::chain(4, 1)), Family(sfdae_test::gear_petzold(-0.5).family)})
    for (double t : {0.0, 0.4, 1.0}) {
      FamilyProblem callbacks(family);
      callbacks.hooks.highest_order = 0;
      LinearProblem problem(functions_of(callbacks.problem));
      problem.set_differences({true, 0.0, 1.0});
      problem.set_limits(0.0, 1.0);
      TaylorData data;
      ASSERT_EQ(problem.evaluate_plain(t, {2, 2, 2}, data).status, SFDAE_OK);
      for (int k = 1; k <= 2; ++k)
        for (char which : {'E', 'A', 'f'}) {
          EXPECT_LE(worst_share_of_error(data, *family, which, k), 3.0) << which << k << " at " << t;
          // 1e-4 is far from the 1e-8 that is usual, but would let rank decisions fail.
          EXPECT_LE(largest_error(data, which, k), 1e-4);
        }
      EXPECT_EQ(data.error_of_row('E', 0, 0), 0.0);
    }
}

// f = (-sin t, 1e8 cos 3t, 1e-6 sin 1e4 t, 1e6, e^(t/1e3), rounding errors of 1): errors are those of each row, so that
// derivatives keep digits of their own, and what varies on other scales of time has other points.
TEST(LinearProblem, EveryRowHasErrorsOfItsOwn) {
  struct Row {
    double size, speed;  // of size e^(i speed t)
  };
  const Row rows[] = {{1.0, 1.0}, {1e8, 3.0}, {1e-6, 1e4}};
  sfdae_linear_problem user;
  sfdae_linear_problem_init(&user, sizeof user);
  user.num_equations = user.num_unknowns = 6;
  user.E = user.A = [](double, int, double*, void*) { return 0; };
  user.constant_E = user.constant_A = 1;
  user.f = [](double t, int order, double* f, void*) {
    if (order > 0) return SFDAE_ORDER_NOT_AVAILABLE;
    f[0] = -std::sin(t);
    f[1] = 1e8 * std::cos(3.0 * t);
    f[2] = 1e-6 * std::sin(1e4 * t);
    f[3] = 1e6;
    f[4] = std::exp(t / 1e3);
    f[5] = std::pow(std::sin(t), 2) + std::pow(std::cos(t), 2);
    return 0;
  };
  for (double t : {0.0, 0.3, 1.0}) {
    LinearProblem problem(functions_of(user));
    problem.set_differences({true, 0.0, 1.0});
    problem.set_limits(0.0, 1.0);
    TaylorData data;
    ASSERT_EQ(problem.evaluate_plain(t, {0, 0, 3}, data).status, SFDAE_OK);
    for (int k = 1; k <= 3; ++k) {
      // Derivatives of -sin, cos, sin are those of cos with a phase.
      const double phases[] = {1.0, 0.0, -1.0};
      for (int i = 0; i < 3; ++i) {
        const double scale = rows[i].size * std::pow(rows[i].speed, k);
        const double exact = scale * std::cos(rows[i].speed * t + (phases[i] + k) * 1.5707963267948966);
        const double error = data.error_of_row('f', k, i);
        EXPECT_LE(std::fabs(data.f(k)[i] - exact), 3.0 * error + rounding(1000) * scale) << i << ", " << k;
        EXPECT_LE(error, 1e-4 * scale) << i << ", " << k;
      }
      EXPECT_EQ(data.f(k)[3], 0.0);
      EXPECT_EQ(data.error_of_row('f', k, 3), 0.0);
      EXPECT_LE(std::fabs(data.f(k)[4] - std::exp(t / 1e3) * std::pow(1e-3, k)), 3.0 * data.error_of_row('f', k, 4));
      EXPECT_LE(std::fabs(data.f(k)[5]), 3.0 * data.error_of_row('f', k, 5));
    }
  }
}

// Equidistant points, and those of half and a quarter of the spacing, could all see the same phase of
// cos(2 pi t / period).
TEST(LinearProblem, PeriodsThatFitTheIntervalAreSeen) {
  for (double period : {1.0 / 16.0, 1.0 / 32.0, 0.93 / 16.0, 0.93 / 128.0}) {
    sfdae_linear_problem user;
    sfdae_linear_problem_init(&user, sizeof user);
    user.num_equations = user.num_unknowns = 1;
    user.E = user.A = [](double, int, double*, void*) { return 0; };
    user.constant_E = user.constant_A = 1;
    user.user = &period;
    user.f = [](double t, int order, double* f, void* of) {
      if (order > 0) return SFDAE_ORDER_NOT_AVAILABLE;
      f[0] = 2.0 + std::sin(6.283185307179586 * t / *static_cast<double*>(of));
      return 0;
    };
    LinearProblem problem(functions_of(user));
    problem.set_differences({true, 0.0, 1.0});
    TaylorData data;
    ASSERT_EQ(problem.evaluate_plain(0.0, {0, 0, 1}, data).status, SFDAE_OK);
    EXPECT_NEAR(data.f(1)[0] * period / 6.283185307179586, 1.0, 1e-6) << period;
  }
}

TEST(LinearProblem, OrdersThatAreProvidedAreExactBesideDifferences) {
  const Family family(sfdae_test::kron(4, 2));
  FamilyProblem callbacks(family);
  callbacks.hooks.highest_order = 1;
  LinearProblem problem(functions_of(callbacks.problem));
  problem.set_differences({true, 0.0, 1.0});
  TaylorData data;
  ASSERT_EQ(problem.evaluate_plain(0.5, {3, 1, 1}, data).status, SFDAE_OK);
  EXPECT_EQ(error_of(data.E(1), *family, 'E', 0.5, 1), 0.0);
  EXPECT_EQ(largest_error(data, 'E', 1), 0.0);
  EXPECT_GT(largest_error(data, 'E', 2), 0.0);
  EXPECT_EQ(largest_error(data, 'A', 1), 0.0);
}

TEST(LinearProblem, ConstantFunctionsKeepDerivativesThatAreExactlyZero) {
  FamilyProblem callbacks(Family(sfdae_test::chain(4, 1)));  // E is constant, but not declared so
  callbacks.hooks.highest_order = 0;
  LinearProblem problem(functions_of(callbacks.problem));
  problem.set_differences({true, 0.0, 1.0});
  TaylorData data;
  ASSERT_EQ(problem.evaluate_plain(0.3, {3, 0, 0}, data).status, SFDAE_OK);
  for (int k = 1; k <= 3; ++k) EXPECT_EQ(sfdae_test::largest(std::as_const(data).E(k)), 0.0);
}

TEST(LinearProblem, AnOrderKnownToBeMissingIsNotAskedForAgain) {
  FamilyProblem callbacks((Family(sfdae_test::kron(4, 1))));
  callbacks.hooks.highest_order = 0;
  LinearProblem problem(functions_of(callbacks.problem));
  problem.set_differences({true, 0.0, 1.0});
  TaylorData data;
  for (double t : {0.1, 0.2, 0.3}) ASSERT_EQ(problem.evaluate_plain(t, {1, -1, -1}, data).status, SFDAE_OK);
  EXPECT_EQ(callbacks.calls(Callback::E, 1), 1);
  problem.set_differences({true, 0.0, 1.0});  // forgets
  ASSERT_EQ(problem.evaluate_plain(0.1, {1, -1, -1}, data).status, SFDAE_OK);
  EXPECT_EQ(callbacks.calls(Callback::E, 1), 2);
}

TEST(LinearProblem, TheSpacingOfTheUserIsUsed) {
  FamilyProblem callbacks((Family(sfdae_test::kron(4, 1))));
  callbacks.hooks.highest_order = 0;
  TimesAsked times;
  callbacks.hooks.status = times.hook();
  LinearProblem problem(functions_of(callbacks.problem));
  problem.set_differences({true, 0.01, 1.0});
  TaylorData data;
  ASSERT_EQ(problem.evaluate_plain(0.5, {1, -1, -1}, data).status, SFDAE_OK);
  EXPECT_NEAR(times.lowest, 0.46, rounding(1));
  EXPECT_NEAR(times.highest, 0.54, rounding(1));
}

TEST(LinearProblem, DifferencesRespectOneLimit) {
  for (double direction : {1.0, -1.0}) {
    FamilyProblem callbacks((Family(sfdae_test::kron(4, 1))));
    callbacks.hooks.highest_order = 0;
    TimesAsked times;
    callbacks.hooks.status = times.hook();
    LinearProblem problem(functions_of(callbacks.problem));
    problem.set_differences({true, 0.0, 1.0});
    if (direction > 0.0) problem.set_limits(0.5, infinity);
    else problem.set_limits(-infinity, 0.5);
    EXPECT_EQ(problem.room(0.5, direction), infinity);
    EXPECT_EQ(problem.room(0.5, -direction), 0.0);
    TaylorData data;
    ASSERT_EQ(problem.evaluate_plain(0.5, {2, 2, 2}, data).status, SFDAE_OK);
    if (direction > 0.0) EXPECT_GE(times.lowest, 0.5);
    else EXPECT_LE(times.highest, 0.5);
  }
}

// Where the points do not fit between two limits they move together.
// A spacing found in a long interval, or given by the user, and then limits a thousandth apart.
TEST(LinearProblem, DifferencesRespectLimitsThatAreCloserThanTheirPoints) {
  for (double step : {0.0, 0.01}) {
    FamilyProblem callbacks((Family(sfdae_test::kron(4, 1))));
    callbacks.hooks.highest_order = 0;
    LinearProblem problem(functions_of(callbacks.problem));
    problem.set_differences({true, step, 1.0});
    TaylorData data;
    ASSERT_EQ(problem.evaluate_plain(0.5, {1, 1, 1}, data).status, SFDAE_OK);
    TimesAsked times;
    callbacks.hooks.status = times.hook();
    problem.set_limits(0.999, 1.0);
    ASSERT_EQ(problem.evaluate_plain(0.9995, {1, 1, 1}, data).status, SFDAE_OK);
    EXPECT_GE(times.lowest, 0.999);
    EXPECT_LE(times.highest, 1.0);
  }
}

// Points out of the domain of the functions only make the spacing smaller.
TEST(LinearProblem, DifferencesStayWithinTheDomainOfTheFunctions) {
  const Family family(sfdae_test::kron(4, 1));
  FamilyProblem callbacks(family);
  callbacks.hooks.highest_order = 0;
  callbacks.hooks.status = sfdae_test::return_behind(0.52, 1);
  LinearProblem problem(functions_of(callbacks.problem));
  problem.set_differences({true, 0.0, 1.0});
  TaylorData data;
  ASSERT_EQ(problem.evaluate_plain(0.5, {1, -1, -1}, data).status, SFDAE_OK);
  EXPECT_LE(worst_share_of_error(data, *family, 'E', 1), 3.0);
}

TEST(LinearProblem, ACallbackThatStopsEndsTheSearchForASpacing) {
  FamilyProblem callbacks((Family(sfdae_test::kron(4, 1))));
  callbacks.hooks.highest_order = 0;
  callbacks.hooks.status = sfdae_test::return_at_call(5, -1);
  LinearProblem problem(functions_of(callbacks.problem));
  problem.set_differences({true, 0.0, 1.0});
  TaylorData data;
  EXPECT_EQ(problem.evaluate_plain(0.5, {1, 1, 1}, data).status, SFDAE_CALLBACK_STOPPED);
  EXPECT_EQ(callbacks.calls(), 5);
}

}  // namespace sfdae::core
