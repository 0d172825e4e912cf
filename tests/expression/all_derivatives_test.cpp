// SPDX-License-Identifier: BSD-3-Clause
// Formulas of all derivatives have the Taylor coefficients that sweeps backward find, and those of F_p.
#include "expression/all_derivatives.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "expression/parameter_gradient.h"
#include "expression/taylor_evaluator.h"
#include "operators.h"
#include "recorded.h"

namespace sfdae::core {

namespace {

using namespace sfdae_test;
using Numbers = std::vector<double>;

class EveryDerivative : public testing::TestWithParam<Operator> {};

TEST_P(EveryDerivative, IsAFormula) {
  constexpr int order = 2;
  Recording recording(3);
  const auto& x = recording.x;
  const Term p = recording.parameter("p", 2.0);
  const Term f = GetParam().apply(x[0], x[1], recording);
  TaylorEvaluator source(recording.finish({recording.xdot[0] * x[1] + 3.0 * x[0] - p * x[2], f + x[2] * p * f,
                                           x[2] * f + sin(recording.t) * recording.xdot[1] + p * p}));
  const std::vector<int> parameters{0}, limits(3, order);
  const auto record = all_derivatives(source.record(), source.tape(), parameters, 100000);
  ASSERT_NE(record, nullptr);
  EXPECT_EQ(all_derivatives(source.record(), source.tape(), parameters, 3), nullptr);
  const ParameterGradient gradient = parameter_gradient(source.record(), parameters);
  const std::size_t targets = source.tape().targets.size(), places = gradient.places.size(), length = order + 1;
  ASSERT_EQ(static_cast<std::size_t>(record->m()), targets + places);
  const Numbers jet{0.7, 0.45, 1.5, 0.1, 0.2, 0.3, 0.02, 0.1, 0.01, 0.0, 0.03, 0.0};
  Numbers all((targets + places) * length), entries(targets * length), F_p(places * length);
  TaylorEvaluator formulas(record), of_parameters(gradient.formulas);
  ASSERT_TRUE(formulas.values(0.3, jet.data(), order, all.data()));
  ASSERT_TRUE(source.entries(0.3, jet.data(), order, limits, entries.data()));
  ASSERT_TRUE(of_parameters.values(0.3, jet.data(), order, F_p.data()));
  for (std::size_t k = 0; k < length; ++k) {
    for (std::size_t e = 0; e < targets; ++e) {
      const double expected = entries[e * length + k];
      EXPECT_NEAR(all[e + k * (targets + places)], expected, 1e-12 * (1.0 + std::fabs(expected))) << e << ", " << k;
    }
    for (std::size_t e = 0; e < places; ++e)
      EXPECT_NEAR(all[targets + e + k * (targets + places)], F_p[e + k * places],
                  1e-12 * (1.0 + std::fabs(F_p[e + k * places])));
  }
}

INSTANTIATE_TEST_SUITE_P(Operators, EveryDerivative, testing::ValuesIn(operators()),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace

}  // namespace sfdae::core
