// SPDX-License-Identifier: BSD-3-Clause
// Formulas that are numbers are evaluated once, until parameters change.
#include "extension/derivative_formulas.h"

#include <gtest/gtest.h>

#include <vector>

#include "problem/nonlinear_problem.h"
#include "recorded.h"

namespace sfdae::core {

namespace {

using namespace sfdae_test;

// One that knows numbers, at three points with parameters that change between them, and one that does not.
TEST(DerivativeFormulas, AreThoseOfNewOnes) {
  Recording recording(2);
  const auto& x = recording.x;
  const Term p = recording.parameter("p", 2.0);
  RecordedProblem problem(recording.finish({recording.xdot[0] * p + sin(recording.t) * x[0] - 3.0 * x[1],
                                            x[1] * p * p - x[0] * x[0] + recording.xdot[1]}),
                          PrescribedInputs{});
  const std::vector<int> parameters{0};
  ParameterSeries series(problem, parameters);
  DerivativeFormulas known(problem, series, parameters);
  ASSERT_TRUE(known.are_there());
  for (int order : {0, 2, 1})
    for (int point = 0; point < 3; ++point) {
      SCOPED_TRACE(testing::Message() << "order " << order << ", point " << point);
      const double t = 0.3 * point;
      const std::vector<double> jet{0.7 + t, 0.4 - t, 1.5, t, 0.2, 0.3, 0.02, 0.1};
      if (point == 2) {
        problem.evaluator().set_parameter(0, problem.evaluator().parameter(0) + 0.7);
        series.take_parameters();
        known.take_parameters();
      }
      DerivativeFormulas unknown(problem, series, parameters);
      const double* const found = known.evaluate(t, jet.data(), order);
      ASSERT_NE(found, nullptr);
      const double* const expected = unknown.evaluate(t, jet.data(), order);
      ASSERT_NE(expected, nullptr);
      int numbers = 0;
      for (std::size_t e = 0; e < known.count(); ++e) {
        numbers += known.is_number(e) ? 1 : 0;
        for (int k = 0; k <= order; ++k)
          EXPECT_EQ(found[e + index(k) * known.count()], expected[e + index(k) * known.count()]) << e << ", " << k;
      }
      // p, 3, p^2 and 1, but not sin(t), 2 x, x' and 2 p x.
      EXPECT_EQ(numbers, 4);
    }
}

}  // namespace

}  // namespace sfdae::core
