// SPDX-License-Identifier: BSD-3-Clause
// Derivatives that are no numbers, evaluated alone, are those of all together.
#include "expression/varying_entries.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "expression/taylor_evaluator.h"
#include "matrix_checks.h"
#include "operators.h"
#include "recorded.h"

namespace sfdae::core {

namespace {

using namespace sfdae_test;
using Numbers = std::vector<double>;

// At a sequence of points near x0, with the values left from point to point.
void expect_equal_along(TaylorEvaluator& source, VaryingEntries& varying, Numbers& values, const Numbers& x0,
                        std::uint64_t seed) {
  const int n = source.record().n();
  const Matrix random = random_matrix(2 * n, 4, seed);
  const std::vector<int> none(size(source.record().m()), 0);
  values.resize(source.tape().targets.size());
  for (int point = 0; point < random.cols(); ++point) {
    Numbers jet;
    for (int j = 0; j < n; ++j) jet.push_back(x0[size(j)] * (1.0 + 0.02 * random(j, point)));
    for (int j = 0; j < n; ++j) jet.push_back(random(n + j, point));
    const double t = 0.3 + 0.1 * (point / 2);
    Numbers all(values.size());
    TaylorEvaluator other = source;
    ASSERT_TRUE(other.entries(t, jet.data(), 0, none, all.data()));
    ASSERT_TRUE(source.entries(t, jet.data(), varying, values.data()));
    for (std::size_t e = 0; e < all.size(); ++e) EXPECT_EQ(values[e], all[e]) << "point " << point << ", entry " << e;
  }
}

class EveryOperationThatVaries : public testing::TestWithParam<Operator> {};

TEST_P(EveryOperationThatVaries, HasTheDerivativesOfAllEntries) {
  Recording recording(3);
  const auto& x = recording.x;
  const Term p = recording.parameter("p", 2.0);
  const Term f = GetParam().apply(x[0], x[1], recording);
  // Numbers, sums of numbers and others, factors that are computed by others.
  TaylorEvaluator source(recording.finish({recording.xdot[0] + 3.0 * x[0] - p * x[2], f + x[2] * 2.0 - p * p * x[0],
                                           x[2] * f + sin(recording.t) * x[1] + x[2]}));
  VaryingEntries varying;
  Numbers values;
  expect_equal_along(source, varying, values, {0.7, 0.45, 1.5}, 1);
  source.set_parameter(0, 0.5);
  expect_equal_along(source, varying, values, {0.7, 0.45, 1.5}, 2);
  // Series in every slot from here on.
  Numbers F(9);
  const Numbers jet{0.7, 0.45, 1.5, 0.1, 0.2, 0.3, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0};
  ASSERT_TRUE(source.values(0.2, jet.data(), 2, F.data()));
  expect_equal_along(source, varying, values, {0.7, 0.45, 1.5}, 3);
}

INSTANTIATE_TEST_SUITE_P(Operators, EveryOperationThatVaries, testing::ValuesIn(operators()),
                         [](const auto& instance) { return instance.param.name; });

TEST(VaryingEntries, LeaveOutWhatIsConstant) {
  Recording recording(3);
  const auto& x = recording.x;
  TaylorEvaluator source(recording.finish({recording.xdot[0] + 3.0 * x[0] - x[2], x[0] * x[1] + 4.0 * (x[2] - x[0]),
                                           exp(recording.parameter("p", 1.0)) * x[2] + sin(recording.t)}));
  VaryingEntries varying;
  varying.set(source.tape(), 1);
  ASSERT_EQ(varying.rows().size(), 1u);
  const VaryingEntries::Row& row = varying.rows()[0];
  // Of equation 1.
  EXPECT_GE(varying.target(row.first_target), source.tape().first_target[1]);
  EXPECT_LT(varying.target(row.last_target - 1), source.tape().first_target[2]);
  // By x_0 and x_1, not by x_2; factors are unknowns, so that nothing is computed.
  EXPECT_EQ(row.last_target - row.first_target, 2u);
  EXPECT_TRUE(varying.instructions().empty());
}

// Derivatives that are not wanted keep their values, and nothing is evaluated for them: not even where they do not
// exist.
TEST(VaryingEntries, LeaveOutWhatIsNotWanted) {
  Recording recording(2);
  const auto& x = recording.x;
  TaylorEvaluator source(recording.finish({x[1] * x[1] * recording.xdot[0] - sqrt(x[0])}));
  const Tape& tape = source.tape();
  std::vector<char> is_wanted;
  for (const Tape::Variable& leaf : tape.targets) is_wanted.push_back(leaf.derivative ? 1 : 0);
  VaryingEntries varying(is_wanted);
  Numbers values(tape.targets.size());
  const double first[] = {4.0, 2.0, 1.0, 0.0}, second[] = {0.0, 3.0, 1.0, 0.0};
  ASSERT_TRUE(source.entries(0.0, first, varying, values.data()));
  const Numbers before = values;
  ASSERT_EQ(varying.rows().size(), 1u);
  ASSERT_TRUE(source.entries(0.0, second, varying, values.data()));
  for (std::size_t e = 0; e < values.size(); ++e) EXPECT_EQ(values[e], is_wanted[e] != 0 ? 9.0 : before[e]);
  // The square, not the root and what it is taken from.
  EXPECT_EQ(varying.instructions().all().size(), 1u);
}

TEST(VaryingEntries, NameWhatCannotBeEvaluated) {
  Recording recording(1);
  TaylorEvaluator source(recording.finish({log(recording.x[0]) + recording.xdot[0]}));
  VaryingEntries varying;
  Numbers values(source.tape().targets.size());
  for (double x : {1.0, 2.0}) {
    const double jet[] = {x, 0.0};
    ASSERT_TRUE(source.entries(0.0, jet, varying, values.data()));
  }
  for (double x : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    const double jet[] = {x, 0.0};
    EXPECT_FALSE(source.entries(0.0, jet, varying, values.data()));
    EXPECT_FALSE(source.failure().message.empty());
    const double good[] = {4.0, 0.0};
    ASSERT_TRUE(source.entries(0.0, good, varying, values.data()));
    EXPECT_EQ(*std::min_element(values.begin(), values.end()), 0.25);
  }
}

}  // namespace

}  // namespace sfdae::core
