// SPDX-License-Identifier: BSD-3-Clause
// Mechanical systems from callbacks and from recorded formulas: both deliver what the theory asks for.
#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <string>
#include <tuple>

#include "multibody/multibody_callbacks.h"
#include "multibody/problem_of.h"
#include "multibody_example.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

using namespace sfdae_test;

constexpr double t0 = 0.7;
constexpr double q0[] = {0.4, -0.9, 1.3}, v0[] = {1.1, 0.8, -0.6}, a0[] = {0.3, -2.0, 0.7}, mu0[] = {1.5, -0.4, 0.9};
constexpr double mass0 = 1.7;

class MultibodySources : public testing::TestWithParam<std::tuple<Source, bool>> {
 protected:
  Source source() const { return std::get<0>(GetParam()); }
  bool with_S() const { return std::get<1>(GetParam()); }
  bool has_differences() const { return source() == Source::callbacks; }

  double mass_ = mass0;
  std::unique_ptr<MultibodyProblem> problem_ =
      sfdae_test::problem_of(with_S() ? example<true>(source(), mass_) : example<false>(source(), mass_));
};

// What an iteration solves, from the terms.
struct Solved {
  std::vector<double> force, acceleration, velocity, kinematics;
};
Solved solved_at(MultibodyProblem& problem, const double* q, const double* v) {
  MultibodyTerms terms(problem.sizes());
  EXPECT_EQ(problem.at_velocity(t0, q, v, terms).status, SFDAE_OK);
  Solved result{terms.f, terms.acceleration_rest, terms.velocity_rest, std::vector<double>(v, v + nv)};
  for (int j = 0; j < nv; ++j)
    for (int i = 0; i < nl + nk; ++i) {
      result.acceleration[size(i)] += terms.C(i, j) * a0[j];
      result.velocity[size(i)] += terms.C(i, j) * v[j];
      result.force[size(j)] -= terms.C(i, j) * mu0[i];
    }
  for (int j = 0; j < nv; ++j)
    for (int i = 0; i < nv; ++i) result.force[size(i)] -= terms.M(i, j) * a0[j];
  if (!problem.has_kinematics()) return result;
  for (int i = 0; i < nq; ++i) {
    result.kinematics[size(i)] = 0.0;
    for (int j = 0; j < nv; ++j) result.kinematics[size(i)] += terms.S(i, j) * v[j];
  }
  return result;
}

// Central differences of fourth order.
template <class Function>
std::vector<double> slope(const double* at, int j, Function function) {
  constexpr double h = 1e-3;
  const double weights[] = {1.0 / 12.0, -2.0 / 3.0, 2.0 / 3.0, -1.0 / 12.0}, offsets[] = {-2.0, -1.0, 1.0, 2.0};
  std::vector<double> sum;
  for (int k = 0; k < 4; ++k) {
    double moved[3] = {at[0], at[1], at[2]};
    moved[j] += offsets[k] * h;
    const std::vector<double> values = function(moved);
    sum.resize(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) sum[i] += weights[k] / h * values[i];
  }
  return sum;
}

void expect_column(const Matrix& matrix, int j, const std::vector<double>& expected, double tolerance) {
  SCOPED_TRACE(matrix.rows() * 10 + matrix.cols());
  for (int i = 0; i < matrix.rows(); ++i) EXPECT_NEAR(matrix(i, j), expected[size(i)], tolerance) << i << ", " << j;
}

}  // namespace

INSTANTIATE_TEST_SUITE_P(, MultibodySources,
                         testing::Combine(testing::Values(Source::recorded, Source::callbacks,
                                                          Source::callbacks_with_curvature),
                                          testing::Bool()));

// Values of the formulas; g_q, g_t from series of g along lines, s from those along the motion.
TEST_P(MultibodySources, DeliversTermsOfTheTheory) {
  MultibodyTerms terms(problem_->sizes());
  ASSERT_EQ(problem_->at_velocity(t0, q0, v0, terms).status, SFDAE_OK);
  double M[9] = {}, S[9] = {}, H[3] = {}, h[1] = {}, f[3] = {}, g[2] = {}, g_q[6], g_t[2], s[3];
  const Formulas<double> formulas{t0, q0};
  formulas.M(M, mass0), formulas.f(v0, f), formulas.g(g), formulas.H(H), formulas.h(h);
  if (with_S()) formulas.S(S);
  jacobian_callback(t0, q0, g_q, nullptr), rate_callback(t0, q0, g_t, nullptr);
  (with_S() ? curvature_callback<true> : curvature_callback<false>)(t0, q0, v0, s, nullptr);
  (with_S() ? nonholonomic_curvature_callback<true> : nonholonomic_curvature_callback<false>)(t0, q0, v0, s + nl,
                                                                                              nullptr);
  const double tolerance = rounding(10);
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(terms.M.data()[i], M[i], tolerance) << "M " << i;
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(terms.f[size(i)], f[i], 10.0 * tolerance);
  for (int i = 0; i < nl; ++i) {
    EXPECT_NEAR(terms.g[size(i)], g[i], tolerance);
    EXPECT_NEAR(terms.velocity_rest[size(i)], g_t[i], tolerance);
  }
  EXPECT_NEAR(terms.velocity_rest[nl], h[0], tolerance);
  for (int j = 0; j < nv; ++j) {
    EXPECT_NEAR(terms.C(nl, j), H[j], tolerance);
    for (int i = 0; i < nl; ++i) {
      EXPECT_NEAR(terms.g_q(i, j), g_q[i + j * nl], tolerance);
      double G = with_S() ? 0.0 : g_q[i + j * nl];
      for (int k = 0; with_S() && k < nq; ++k) G += g_q[i + k * nl] * S[k + j * nq];
      EXPECT_NEAR(terms.C(i, j), G, tolerance);
    }
  }
  EXPECT_EQ(problem_->has_kinematics(), with_S());
  EXPECT_EQ(terms.S.cols(), with_S() ? nv : 0);
  for (int i = 0; with_S() && i < nq * nv; ++i) EXPECT_NEAR(terms.S.data()[i], S[i], tolerance);
  for (int i = 0; i < nl + nk; ++i)
    EXPECT_NEAR(terms.acceleration_rest[size(i)], s[i], has_differences() ? 1e-11 : 10.0 * tolerance) << i;
}

TEST_P(MultibodySources, DeliversTheSamePositionsWithoutVelocities) {
  MultibodyTerms position(problem_->sizes()), all(problem_->sizes());
  double g[nl];
  ASSERT_EQ(problem_->at_position(t0, q0, position).status, SFDAE_OK);
  ASSERT_EQ(problem_->at_velocity(t0, q0, v0, all).status, SFDAE_OK);
  ASSERT_EQ(problem_->constraints(t0, q0, g).status, SFDAE_OK);
  const double tolerance = rounding(10);
  for (int i = 0; i < nv * nv; ++i) EXPECT_EQ(position.M.data()[i], all.M.data()[i]);
  for (int i = 0; i < (nl + nk) * nv; ++i) EXPECT_EQ(position.C.data()[i], all.C.data()[i]);
  for (int i = 0; i < nl; ++i) {
    EXPECT_EQ(position.g[size(i)], g[i]);
    EXPECT_EQ(position.g[size(i)], all.g[size(i)]);
  }
  for (int i = 0; i < nl + nk; ++i)
    EXPECT_NEAR(position.velocity_rest[size(i)], all.velocity_rest[size(i)], tolerance);
}

TEST_P(MultibodySources, LinearizesWhatIsSolved) {
  MultibodyTerms terms(problem_->sizes());
  MultibodyJacobian jacobian(problem_->sizes());
  ASSERT_EQ(problem_->at_velocity(t0, q0, v0, terms).status, SFDAE_OK);
  ASSERT_EQ(problem_->linearize({t0, q0, v0, a0, mu0}, terms, jacobian).status, SFDAE_OK);
  // The differences of this test are exact to about 1e-11; those of callbacks to the square root of rounding, and wider
  // where values are differences, too.
  const double tolerance = source() == Source::recorded ? 1e-9 : 1e-6;
  const double of_acceleration = has_differences() ? 2e-4 : tolerance;
  for (int j = 0; j < nq; ++j) {
    const auto by_q = [&](std::vector<double> Solved::*part) {
      return slope(q0, j, [&](const double* q) { return solved_at(*problem_, q, v0).*part; });
    };
    expect_column(jacobian.force_q, j, by_q(&Solved::force), tolerance);
    expect_column(jacobian.acceleration_q, j, by_q(&Solved::acceleration), of_acceleration);
    expect_column(jacobian.velocity_q, j, by_q(&Solved::velocity), tolerance);
    if (with_S()) expect_column(jacobian.kinematics_q, j, by_q(&Solved::kinematics), tolerance);
  }
  for (int j = 0; j < nv; ++j) {
    const auto by_v = [&](std::vector<double> Solved::*part) {
      return slope(v0, j, [&](const double* v) { return solved_at(*problem_, q0, v).*part; });
    };
    expect_column(jacobian.force_v, j, by_v(&Solved::force), tolerance);
    expect_column(jacobian.acceleration_v, j, by_v(&Solved::acceleration),
                  std::max(tolerance, 1e-6 * has_differences()));
  }
}

TEST_P(MultibodySources, StopsOnRequest) {
  MultibodyTerms terms(problem_->sizes());
  problem_->request_stop();
  EXPECT_EQ(problem_->at_velocity(t0, q0, v0, terms).status, SFDAE_STOPPED);
  EXPECT_TRUE(problem_->take_stop_request());
  EXPECT_EQ(problem_->at_velocity(t0, q0, v0, terms).status, SFDAE_OK);
}

// One-sided near limits in t: the same within the accuracy of differences.
TEST(MultibodyCallbacks, TakeNoDifferencesFromBeyondLimits) {
  static double latest;
  double mass = mass0;
  for (const double room : {0.0, 1e-3, 0.1}) {
    sfdae_multibody_problem functions = example<true>(Source::callbacks, mass);
    functions.constraint_rate = [](double t, const double* q, double* g_t, void* user) {
      latest = std::max(latest, t);
      return rate_callback(t, q, g_t, user);
    };
    const auto problem = sfdae_test::problem_of(functions);
    MultibodyTerms free(problem->sizes()), limited(problem->sizes());
    MultibodyJacobian jacobian(problem->sizes());
    ASSERT_EQ(problem->at_velocity(t0, q0, v0, free).status, SFDAE_OK);
    EXPECT_GT(latest, t0);
    latest = 0.0;
    problem->set_limits(-10.0, t0 + room);
    ASSERT_EQ(problem->at_velocity(t0, q0, v0, limited).status, SFDAE_OK);
    ASSERT_EQ(problem->linearize({t0, q0, v0, a0, mu0}, limited, jacobian).status, SFDAE_OK);
    EXPECT_LE(latest, t0 + room);
    for (std::size_t i = 0; i < nl + nk; ++i)
      EXPECT_NEAR(limited.acceleration_rest[i], free.acceleration_rest[i], 1e-9) << room;
  }
}

// g = (sin(200 q1), 1e6 cos(q2 - 500 t)): fast, slow and badly scaled rows.
TEST(MultibodyCallbacks, FindTheSpacingOfDifferences) {
  sfdae_multibody_problem functions{};
  functions.num_positions = functions.num_constraints = 2;
  functions.forces = [](double, const double*, const double*, double*, void*) { return 0; };
  functions.constraints = [](double t, const double* q, double* g, void*) {
    g[0] = std::sin(200.0 * q[0]), g[1] = 1e6 * std::cos(q[1] - 500.0 * t);
    return 0;
  };
  functions.constraint_jacobian = [](double t, const double* q, double* g_q, void*) {
    g_q[0] = 200.0 * std::cos(200.0 * q[0]), g_q[3] = -1e6 * std::sin(q[1] - 500.0 * t);
    return 0;
  };
  functions.constraint_rate = [](double t, const double* q, double* g_t, void*) {
    g_t[1] = 5e8 * std::sin(q[1] - 500.0 * t);
    return 0;
  };
  const auto problem = sfdae_test::problem_of(functions);
  MultibodyTerms terms(problem->sizes());
  const double q[] = {0.3, 0.8}, v[] = {2.0, -7.0};
  ASSERT_EQ(problem->at_velocity(0.1, q, v, terms).status, SFDAE_OK);
  const double first = -4e4 * v[0] * v[0], second = -1e6 * (v[1] - 500.0) * (v[1] - 500.0);
  EXPECT_NEAR(terms.acceleration_rest[0], first * std::sin(200.0 * q[0]), 1e-9 * std::fabs(first));
  EXPECT_NEAR(terms.acceleration_rest[1], second * std::cos(q[1] - 50.0), 1e-9 * std::fabs(second));
}

// The rod hangs at q1 = 0; g_q exists for q1 < 1e-3 only.
TEST(MultibodyCallbacks, KeepDifferencesWithinTheDomainOfFunctions) {
  sfdae_multibody_problem functions{};
  functions.num_positions = functions.num_constraints = 1;
  functions.forces = [](double, const double*, const double*, double*, void*) { return 0; };
  functions.constraints = [](double, const double* q, double* g, void*) {
    g[0] = q[0] * q[0];
    return 0;
  };
  functions.constraint_jacobian = [](double, const double* q, double* g_q, void* user) {
    g_q[0] = 2.0 * q[0];
    return q[0] < 1e-3 ? 0 : *static_cast<const int*>(user);
  };
  int code = 1;
  functions.user = &code;
  const auto problem = sfdae_test::problem_of(functions);
  MultibodyTerms terms(problem->sizes());
  const double q[] = {0.0}, outside[] = {0.1}, v[] = {3.0};
  ASSERT_EQ(problem->at_velocity(0.0, q, v, terms).status, SFDAE_OK);
  EXPECT_NEAR(terms.acceleration_rest[0], 18.0, 1e-9);
  CallbackError error = problem->at_velocity(0.0, outside, v, terms);
  EXPECT_EQ(error.status, SFDAE_CALLBACK_FAILED);
  EXPECT_NE(error.message().find("constraint_jacobian returned 1"), std::string::npos) << error.message();
  code = -3;
  EXPECT_EQ(problem->at_velocity(0.0, q, v, terms).status, SFDAE_CALLBACK_STOPPED);
}

TEST(MultibodyCallbacks, NameEntriesThatAreNotFinite) {
  double mass = mass0;
  sfdae_multibody_problem functions = example<true>(Source::callbacks, mass);
  functions.kinematics = [](double, const double*, double* S, void*) {
    S[2 + 1 * nq] = std::numeric_limits<double>::quiet_NaN();
    return 0;
  };
  const auto problem = sfdae_test::problem_of(functions);
  MultibodyTerms terms(problem->sizes());
  const CallbackError error = problem->at_velocity(t0, q0, v0, terms);
  EXPECT_EQ(error.status, SFDAE_NOT_FINITE);
  EXPECT_EQ(error.row, 2);
  EXPECT_EQ(error.column, 1);
  EXPECT_NE(error.message().find("kinematics returned NaN"), std::string::npos) << error.message();
}

TEST(MultibodyCallbacks, ConstraintsThatMoveNeedTheirRate) {
  double mass = mass0;
  sfdae_multibody_problem functions = example<true>(Source::callbacks, mass);
  EXPECT_NO_THROW(sfdae_test::problem_of(functions)->check_rates(t0, q0));
  functions.constraint_rate = nullptr;
  for (const double limit : {1.0, 1e-9}) {
    const auto problem = sfdae_test::problem_of(functions);
    problem->set_limits(t0 - limit, t0);
    EXPECT_THROW(problem->check_rates(t0, q0), Failure);
  }
}

// A change of a parameter reaches all that is evaluated.
TEST(RecordedMultibody, SharesParameters) {
  double mass = mass0, other = 3.0;
  const auto problem = sfdae_test::problem_of(example<true>(Source::recorded, mass));
  const auto expected = sfdae_test::problem_of(example<true>(Source::recorded, other));
  TaylorEvaluator& evaluator = *problem->evaluator();
  ASSERT_TRUE(evaluator.find_parameter("mass"));
  evaluator.set_parameter(*evaluator.find_parameter("mass"), other);
  problem->parameters_changed();
  MultibodyTerms terms(problem->sizes()), right(problem->sizes());
  ASSERT_EQ(problem->at_position(t0, q0, terms).status, SFDAE_OK);
  ASSERT_EQ(expected->at_position(t0, q0, right).status, SFDAE_OK);
  EXPECT_EQ(terms.M(0, 0), right.M(0, 0));
  ASSERT_EQ(problem->at_velocity(t0, q0, v0, terms).status, SFDAE_OK);
  EXPECT_EQ(terms.M(0, 0), right.M(0, 0));
  // None of those that hold accelerations and multipliers has a name.
  EXPECT_FALSE(evaluator.find_parameter("a0"));
}

}  // namespace sfdae::core
