// SPDX-License-Identifier: BSD-3-Clause
// Taylor coefficients of nonlinear problems: from recorded equations and from callbacks, scaled, and what goes wrong.
#include "problem/callback_problem.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "jet.h"
#include "matrix_checks.h"
#include "recorded.h"

namespace sfdae::core {

namespace {

using sfdae_test::factorial;
using sfdae_test::Jet;
using sfdae_test::rounding;
using sfdae_test::size;

constexpr int m = 2, n = 3;

// F1 = x1' - x1 x2, F2 = x1^2 + sin(t) x2' + t x3' x3.
template <class V>
std::array<V, m> residuals(const V& t, const V* x, const V* xdot) {
  return {xdot[0] - x[0] * x[1], x[0] * x[0] + sin(t) * xdot[1] + t * xdot[2] * x[2]};
}
template <class V>
std::array<V, m * n> gradient_x(const V& t, const V* x, const V* xdot) {  // column by column
  return {-x[1], 2.0 * x[0], -x[0], V(0.0), V(0.0), t * xdot[2]};
}
template <class V>
std::array<V, m * n> gradient_xdot(const V& t, const V* x) {
  return {V(1.0), V(0.0), V(0.0), sin(t), V(0.0), t * x[2]};
}

struct Series {
  std::array<Jet, m> F;
  std::array<Jet, m * n> F_x, F_xdot;
};

// coefficients: Taylor coefficients, n x (order + 2).
Series series(double t, int order, const double* coefficients) {
  std::array<Jet, n> x, xdot;
  for (std::size_t j = 0; j < n; ++j) {
    x[j] = Jet::zero(order + 1);
    for (int k = 0; k <= order + 1; ++k) x[j][k] = coefficients[j + n * size(k)];
    xdot[j] = derivative(x[j]);
  }
  const Jet time = Jet::variable(t, order);
  return {residuals(time, x.data(), xdot.data()), gradient_x(time, x.data(), xdot.data()),
          gradient_xdot(time, x.data())};
}

// What the callback does besides its duty.
struct Behavior {
  int code = 0, from_order = 0;
  int poisoned_array = -1;  // 0: F, 1: F_x, 2: F_xdot; its entry 3, or 1 of F, becomes NaN
  int calls = 0;
};

int total_derivatives(double t, int order, const double* derivatives, double* F, double* F_x, double* F_xdot,
                      void* user) {
  Behavior& behavior = *static_cast<Behavior*>(user);
  ++behavior.calls;
  if (order >= behavior.from_order && behavior.code != 0) return behavior.code;
  std::vector<double> coefficients(n * size(order + 2));
  for (int k = 0; k <= order + 1; ++k)
    for (std::size_t j = 0; j < n; ++j) coefficients[j + n * size(k)] = derivatives[j + n * size(k)] / factorial(k);
  const Series s = series(t, order, coefficients.data());
  for (std::size_t i = 0; i < m; ++i) F[i] = s.F[i][order] * factorial(order);
  for (std::size_t i = 0; i < m * n; ++i) {
    if (F_x != nullptr) F_x[i] = s.F_x[i][order] * factorial(order);
    if (F_xdot != nullptr) F_xdot[i] = s.F_xdot[i][order] * factorial(order);
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  if (order >= behavior.from_order) {
    if (behavior.poisoned_array == 0) F[1] = nan;
    if (behavior.poisoned_array == 1 && F_x != nullptr) F_x[3] = nan;
    if (behavior.poisoned_array == 2 && F_xdot != nullptr) F_xdot[3] = nan;
  }
  return 0;
}

RecordedProblem recorded() {
  sfdae_test::Recording r(n);
  const auto F = residuals(r.t, r.x.data(), r.xdot.data());
  return {r.finish({F[0], F[1]}), PrescribedInputs{}};
}

std::vector<double> jet_of_order(int order) { return sfdae_test::random_vector(n * (order + 1), 31); }

}  // namespace

TEST(NonlinearProblem, HasTheTaylorCoefficientsOfItsResiduals) {
  Behavior behavior;
  RecordedProblem by_record = recorded();
  CallbackProblem by_callback(m, n, total_derivatives, &behavior, {});
  for (NonlinearProblem* problem : std::initializer_list<NonlinearProblem*>{&by_record, &by_callback})
    for (int order : {4, 0, 2, 7}) {
      const std::vector<double> jet = jet_of_order(order + 1);
      const Series expected = series(0.7, order, jet.data());
      std::vector<double> F(m * size(order + 1));
      ASSERT_EQ(problem->residuals(0.7, jet.data(), order, F.data()).status, SFDAE_OK);
      for (int k = 0; k <= order; ++k)
        for (std::size_t i = 0; i < m; ++i)
          EXPECT_NEAR(F[i + m * size(k)], expected.F[i][k], rounding(order + 4)) << k;
    }
  EXPECT_EQ(by_record.evaluations(), 4);
  EXPECT_EQ(by_record.linearizations(), 0);
}

// E(k) = D tau^k (F_x')_k C, A(k) = -D tau^(k+1) (F_x)_k C, f(k) = -D tau^(k+1) F_k, D powers of two.
TEST(NonlinearProblem, LinearizesWithTheScalingOfLinearProblems) {
  Behavior behavior;
  RecordedProblem by_record = recorded();
  CallbackProblem by_callback(m, n, total_derivatives, &behavior, {});
  const std::vector<double> units = {1.0, 32.0, 0.25}, no_units;
  for (NonlinearProblem* problem : std::initializer_list<NonlinearProblem*>{&by_record, &by_callback})
    for (const Units& columns : {Units(no_units), Units(units)})
      for (double tau : {1.0, 0.25, 16.0})
        for (Orders orders : {Orders{3, 3, 3}, Orders{0, 2, 1}, Orders{4, 1, 0}, Orders{0, 0, -1}}) {
          const int highest = std::max({orders.E, orders.A, orders.f});
          const std::vector<double> jet = jet_of_order(highest + 1);
          const Series expected = series(-0.4, highest, jet.data());
          TaylorData data;
          ASSERT_EQ(
              problem->linearize(-0.4, jet.data(), orders, {tau, RowScaling::each, nullptr, &columns}, data).status,
              SFDAE_OK);
          EXPECT_EQ(data.time_scale, tau);
          for (int k = 0; k <= highest; ++k)
            for (int i = 0; i < m; ++i) {
              const double D = data.row_scale[size(i)];
              EXPECT_EQ(D, std::ldexp(1.0, std::ilogb(D)));
              const double power = D * std::pow(tau, k),
                           tolerance = rounding(highest + 4) * 32.0 * power * std::max(1.0, tau);
              if (k <= orders.f) {
                EXPECT_NEAR(data.f(k)[i], -power * tau * expected.F[size(i)][k], tolerance) << k;
              }
              for (int j = 0; j < n; ++j) {
                const double unit = columns[j];
                const std::size_t at = size(i + m * j);
                if (k <= orders.E) {
                  EXPECT_NEAR(data.E(k)(i, j), power * unit * expected.F_xdot[at][k], tolerance) << k;
                }
                if (k <= orders.A) {
                  EXPECT_NEAR(data.A(k)(i, j), -power * tau * unit * expected.F_x[at][k], tolerance) << k;
                }
              }
            }
        }
}

TEST(CallbackProblem, TellsHowTheFunctionFailed) {
  struct Case {
    int code, status;
  };
  for (const Case c : {Case{1, SFDAE_CALLBACK_FAILED},
                       {-3, SFDAE_CALLBACK_STOPPED},
                       {SFDAE_ORDER_NOT_AVAILABLE, SFDAE_ORDER_MISSING}})
    for (int order : {0, 2}) {
      Behavior behavior{.code = c.code, .from_order = order};
      CallbackProblem problem(m, n, total_derivatives, &behavior, {});
      const std::vector<double> jet = jet_of_order(4);
      std::vector<double> F(m * 4);
      TaylorData data;
      for (const CallbackError& error : {problem.residuals(0.5, jet.data(), 3, F.data()),
                                         problem.linearize(0.5, jet.data(), {3, 3, 3}, {}, data)}) {
        EXPECT_EQ(error.status, c.status);
        EXPECT_EQ(error.code, c.code);
        EXPECT_EQ(error.order, order);
        EXPECT_EQ(error.t, 0.5);
        EXPECT_STREQ(error.function, "F");
      }
      EXPECT_EQ(behavior.calls, 2 * (order + 1));  // not asked any further
    }
}

TEST(CallbackProblem, NamesTheFirstEntryThatIsNotFinite) {
  const char* names[] = {"F", "F_x", "F_xdot"};
  for (int array = 0; array < 3; ++array) {
    Behavior behavior{0, 1, array};
    CallbackProblem problem(m, n, total_derivatives, &behavior, {});
    const std::vector<double> jet = jet_of_order(3);
    TaylorData data;
    const CallbackError error = problem.linearize(0.5, jet.data(), {2, 2, 2}, {}, data);
    EXPECT_EQ(error.status, SFDAE_NOT_FINITE);
    EXPECT_STREQ(error.function, names[array]);
    EXPECT_EQ(error.order, 1);
    EXPECT_EQ(error.row, 1);
    EXPECT_EQ(error.column, array == 0 ? 0 : 1);
    EXPECT_TRUE(error.is_recoverable());
    EXPECT_FALSE(error.message().empty());
  }
}

// log(x) at x <= 0, sqrt(x) at 0 from the first derivative on, and an overflow.
TEST(RecordedProblem, NamesTheEquationThatCannotBeEvaluated) {
  sfdae_test::Recording r(2);
  RecordedProblem problem(r.finish({r.xdot[0] + r.x[1], log(r.x[0]) + sqrt(r.x[1])}), PrescribedInputs{});
  const auto status_at = [&](double x1, double x2, int order) {
    const std::vector<double> jet = {x1, x2, 0.5, 0.5, 0.0, 0.0};
    std::vector<double> F(4);
    const CallbackError error = problem.residuals(0.25, jet.data(), order, F.data());
    if (error.status != SFDAE_OK) {
      EXPECT_EQ(error.row, std::isnan(x1) ? -1 : 1);
      EXPECT_NE(error.message().find("t = 0.25"), std::string::npos) << error.message();
    }
    TaylorData data;
    EXPECT_EQ(problem.linearize(0.25, jet.data(), {0, order, order}, {}, data).status == SFDAE_OK,
              error.status == SFDAE_OK);
    return error.status;
  };
  EXPECT_EQ(status_at(1.0, 1.0, 1), SFDAE_OK);
  EXPECT_EQ(status_at(-1.0, 1.0, 0), SFDAE_NOT_FINITE);
  EXPECT_EQ(status_at(1.0, 0.0, 0), SFDAE_OK);
  EXPECT_EQ(status_at(1.0, 0.0, 1), SFDAE_NOT_FINITE);
  EXPECT_EQ(status_at(std::nan(""), 1.0, 0), SFDAE_NOT_FINITE);
}

// x1' of 1e250 squared.
TEST(NonlinearProblem, TellsThatScalingOverflows) {
  sfdae_test::Recording r(2);
  RecordedProblem problem(r.finish({1e70 * r.xdot[0] * r.xdot[0] + r.x[0] + r.x[1]}), PrescribedInputs{});
  const double jet[] = {1.0, 1.0, 1e250, 1.0};
  TaylorData data;
  const CallbackError error = problem.linearize(0.0, jet, {0, 0, 0}, {1.0, RowScaling::each, nullptr, nullptr}, data);
  EXPECT_EQ(error.status, SFDAE_NOT_FINITE);
  EXPECT_FALSE(error.message().empty());
}

TEST(NonlinearProblem, AsksForNothingOnceAStopIsRequested) {
  Behavior behavior;
  CallbackProblem problem(m, n, total_derivatives, &behavior, {});
  problem.request_stop();
  const std::vector<double> jet = jet_of_order(1);
  double F[m];
  TaylorData data;
  EXPECT_EQ(problem.residuals(0.0, jet.data(), 0, F).status, SFDAE_STOPPED);
  EXPECT_EQ(problem.linearize(0.0, jet.data(), {0, 0, 0}, {}, data).status, SFDAE_STOPPED);
  EXPECT_EQ(behavior.calls, 0);
  EXPECT_TRUE(problem.take_stop_request());
  EXPECT_EQ(problem.residuals(0.0, jet.data(), 0, F).status, SFDAE_OK);
}

TEST(NonlinearProblem, StopsWithItsLeaderWhoseRequestStays) {
  Behavior behavior;
  CallbackProblem leader(m, n, total_derivatives, &behavior, {}), problem(m, n, total_derivatives, &behavior, {});
  problem.stop_with(leader);
  leader.request_stop();
  const std::vector<double> jet = jet_of_order(1);
  double F[m];
  EXPECT_EQ(problem.residuals(0.0, jet.data(), 0, F).status, SFDAE_STOPPED);
  EXPECT_FALSE(problem.take_stop_request());
  EXPECT_TRUE(problem.stop_is_requested());
  EXPECT_TRUE(leader.take_stop_request());
  EXPECT_EQ(problem.residuals(0.0, jet.data(), 0, F).status, SFDAE_OK);
}

// values = (2 t, code or NaN from t = 1 on)
TEST(NonlinearProblem, HandsOutPrescribedValuesAndTheirTrouble) {
  struct Input {
    int code = 0;
    double value = 5.0;
  } input;
  const auto values = [](double t, int order, double* to, void* user) {
    const Input& from = *static_cast<const Input*>(user);
    EXPECT_EQ(order, 0);
    to[0] = 2.0 * t;
    to[1] = t < 1.0 ? 5.0 : from.value;
    return t < 1.0 ? 0 : from.code;
  };
  Behavior behavior;
  CallbackProblem problem(m, n, total_derivatives, &behavior, {{2, 0}, values, &input}),
      without(m, n, total_derivatives, &behavior, {});
  double got[2];
  EXPECT_EQ(problem.evaluate_prescribed(0.5, got).status, SFDAE_OK);
  EXPECT_EQ(got[0], 1.0);
  EXPECT_EQ(got[1], 5.0);
  input.code = 7;
  EXPECT_EQ(problem.evaluate_prescribed(2.0, got).status, SFDAE_CALLBACK_FAILED);
  input.code = -7;
  EXPECT_EQ(problem.evaluate_prescribed(2.0, got).status, SFDAE_CALLBACK_STOPPED);
  input = {0, INFINITY};
  const CallbackError error = problem.evaluate_prescribed(2.0, got);
  EXPECT_EQ(error.status, SFDAE_NOT_FINITE);
  EXPECT_NE(error.message().find("prescribed_values"), std::string::npos) << error.message();
  EXPECT_EQ(without.evaluate_prescribed(0.5, nullptr).status, SFDAE_OK);
}

}  // namespace sfdae::core
