// SPDX-License-Identifier: BSD-3-Clause
// Taylor coefficients of every operation and of random equations, and their gradients.
#include "expression/taylor_evaluator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "contour.h"
#include "expression/equation_source.h"
#include "expression/series.h"
#include "matrix_checks.h"
#include "operators.h"
#include "recorded.h"

namespace sfdae::core {

namespace {

using namespace sfdae_test;
using Numbers = std::vector<double>;

// Jets whose series converge well beyond the circles of the oracle.
Numbers smooth_jet(const Numbers& x0, int columns, std::uint64_t seed) {
  const Matrix random = random_matrix(static_cast<int>(x0.size()), columns, seed);
  Numbers jet;
  for (int k = 0; k < columns; ++k)
    for (int j = 0; j < random.rows(); ++j)
      jet.push_back(k == 0 ? x0[size(j)] : 0.1 * random(j, k) * std::pow(0.5, k));
  return jet;
}

class EveryOperation : public testing::TestWithParam<Operator> {
 protected:
  // F = op(x_0, x_1'), near x_0 = 0.7, x_1' = 0.45.
  EveryOperation() : recording(2) {
    record = recording.finish({GetParam().apply(recording.x[0], recording.xdot[1], recording)});
    jet = smooth_jet({0.7, 0.3}, series::highest_order + 2, 11);
    jet[3] = 0.45;
  }
  Recording recording;
  std::shared_ptr<const Record> record;
  Numbers jet;
};

// Largest |F| on the circle over radius^k bounds |F_k|, and rounding errors of the oracle scale alike.
constexpr double radius = 0.25;
double coefficient_tolerance(int k) { return 1e-13 * std::pow(radius, -k); }

// Central differences in one coefficient of the jet.
Numbers difference(const Record& record, const Numbers& jet, std::size_t entry, int order) {
  const int columns = static_cast<int>(jet.size()) / record.n();
  constexpr double step = 1e-4;
  Numbers shifted = jet, result;
  for (double sign : {1.0, -1.0}) {
    shifted[entry] = jet[entry] + sign * step;
    const Numbers F = contour_coefficients(ComplexEvaluation(record, 0.2, shifted, columns), order, radius);
    result.resize(F.size());
    for (std::size_t i = 0; i < F.size(); ++i) result[i] += sign * F[i] / (2.0 * step);
  }
  return result;
}

// dF_k / dx_l = (F_x)_(k-l) + l (F_x')_(k-l+1), where x_l is a coefficient of x.
void expect_gradients(const Record& record, const Numbers& jet, int order) {
  const int m = record.m(), n = record.n();
  const std::size_t area = size(m * n), blocks = size(order + 1);
  TaylorEvaluator evaluator(std::make_shared<const Record>(record));
  Numbers F(size(m) * blocks), F_xdot(area * blocks, 7.0), F_x(area * blocks, 7.0);
  ASSERT_TRUE(evaluator.gradients(0.2, jet.data(), {order, order, order}, F.data(), F_xdot.data(), F_x.data()))
      << evaluator.failure().message;
  for (int j = 0; j < n; ++j)
    for (int l = 0; l <= order; ++l) {
      const Numbers expected = difference(record, jet, size(j + l * n), order);
      for (int k = 0; k <= order; ++k)
        for (int i = 0; i < m; ++i) {
          const auto entry = [&](const Numbers& blocks_of, int block) {
            return block < 0 || block > order ? 0.0 : blocks_of[size(i + j * m) + size(block) * area];
          };
          if (k - l + 1 > order) continue;
          const double found = entry(F_x, k - l) + l * entry(F_xdot, k - l + 1);
          const double scale = std::fabs(expected[size(i + k * m)]) + std::pow(radius, -k);
          EXPECT_NEAR(found, expected[size(i + k * m)], 1e-6 * scale)
              << "equation " << i << ", unknown " << j << ", coefficient " << l << " of x, order " << k;
        }
    }
}

}  // namespace

TEST_P(EveryOperation, HasTheTaylorCoefficientsOfCauchysFormula) {
  TaylorEvaluator evaluator(record);
  const int columns = series::highest_order + 2;
  const Numbers expected =
      contour_coefficients(ComplexEvaluation(*record, 0.2, jet, columns), series::highest_order, radius);
  for (int order : {0, 1, 2, 3, 4, 5, 9, series::highest_order, 2}) {
    Numbers F(size(order + 1));
    ASSERT_TRUE(evaluator.values(0.2, jet.data(), order, F.data())) << evaluator.failure().message;
    for (int k = 0; k <= order; ++k)
      EXPECT_NEAR(F[size(k)], expected[size(k)], coefficient_tolerance(k)) << "order " << k << " of " << order;
  }
}

// With one number in a slot the tape itself is executed, with more a copy of it.
TEST_P(EveryOperation, HasTheSameValuesAndGradientsWithRoomForMore) {
  TaylorEvaluator plain(record), roomy(record);
  Numbers F(2), Fx(2), Fxdot(2), more(4);
  ASSERT_TRUE(roomy.values(0.2, jet.data(), 3, more.data()));
  Numbers roomy_F(F), roomy_Fx(Fx), roomy_Fxdot(Fxdot);
  ASSERT_TRUE(plain.gradients(0.2, jet.data(), {0, 0, 0}, F.data(), Fxdot.data(), Fx.data()));
  ASSERT_TRUE(roomy.gradients(0.2, jet.data(), {0, 0, 0}, roomy_F.data(), roomy_Fxdot.data(), roomy_Fx.data()));
  EXPECT_EQ(F, roomy_F);
  EXPECT_EQ(Fx, roomy_Fx);
  EXPECT_EQ(Fxdot, roomy_Fxdot);
  EXPECT_EQ(F[0], more[0]);
}

TEST_P(EveryOperation, HasTheGradientsOfDifferences) {
  for (int order : {0, 1, 3, 6}) {
    const Numbers shorter(jet.begin(), jet.begin() + 2 * (order + 2));
    expect_gradients(*record, shorter, order);
  }
}

TEST_P(EveryOperation, LowerOrdersArePartsOfHigherOnes) {
  TaylorEvaluator evaluator(record);
  Numbers F(7), F_xdot(2 * 7), F_x(2 * 7), low_F(3), low_F_xdot(2 * 2), low_F_x(2);
  ASSERT_TRUE(evaluator.gradients(0.2, jet.data(), {6, 6, 6}, F.data(), F_xdot.data(), F_x.data()));
  ASSERT_TRUE(evaluator.gradients(0.2, jet.data(), {2, 1, 0}, low_F.data(), low_F_xdot.data(), low_F_x.data()));
  const auto expect_equal = [](const Numbers& low, const Numbers& high) {
    for (std::size_t i = 0; i < low.size(); ++i)
      EXPECT_NEAR(low[i], high[i], rounding(1) * (1.0 + std::fabs(high[i])));
  };
  expect_equal(low_F, F);
  expect_equal(low_F_xdot, F_xdot);
  expect_equal(low_F_x, F_x);
}

INSTANTIATE_TEST_SUITE_P(Operators, EveryOperation, testing::ValuesIn(operators()),
                         [](const auto& tested) { return tested.param.name; });

namespace {

// Equations that share parts; everything stays of size 1.
std::shared_ptr<const Record> random_equations(int n, std::uint64_t seed) {
  RandomNumbers random(seed);
  Recording recording(n);
  std::vector<Term> pool{recording.t, recording.parameter("p", 0.8)};
  for (int j = 0; j < n; ++j) {
    pool.push_back(recording.x[size(j)]);
    pool.push_back(recording.xdot[size(j)]);
  }
  const auto pick = [&] { return pool[size(random.integer(0, static_cast<int>(pool.size()) - 1))]; };
  for (int i = 0; i < 12 * n; ++i) {
    const Term a = pick(), b = pick();
    switch (random.integer(0, 11)) {
      case 0: pool.push_back(0.5 * (a + b)); break;
      case 1: pool.push_back(0.5 * (a - b)); break;
      case 2: pool.push_back(a * b); break;
      case 3: pool.push_back(a / (1.5 + b * b)); break;
      case 4: pool.push_back(sin(a)); break;
      case 5: pool.push_back(cos(a - b)); break;
      case 6: pool.push_back(sqrt(2.0 + sin(a))); break;
      case 7: pool.push_back(choose(a - 0.3, a * b, cos(b))); break;
      case 8: pool.push_back(log(2.0 + cos(a))); break;
      case 9: pool.push_back(pow(2.0 + sin(a), 0.5 * cos(b))); break;
      case 10: pool.push_back(atan2(sin(a), 2.0 + sin(b))); break;
      default: pool.push_back(random.uniform(-1.0, 1.0) * a);
    }
  }
  return recording.finish({pool.end() - n, pool.end()});
}

}  // namespace

TEST(RandomEquations, HaveTheCoefficientsOfCauchysFormulaAndTheGradientsOfDifferences) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    const int n = 1 + static_cast<int>(seed % 5), order = static_cast<int>(seed % 4);
    const auto record = random_equations(n, seed);
    Numbers x0;
    for (int j = 0; j < n; ++j) x0.push_back(0.1 + 0.37 * j);
    const Numbers jet = smooth_jet(x0, order + 2, seed);
    const Numbers expected = contour_coefficients(ComplexEvaluation(*record, 0.2, jet, order + 2), order, radius);
    TaylorEvaluator evaluator(record);
    Numbers F(expected.size());
    ASSERT_TRUE(evaluator.values(0.2, jet.data(), order, F.data())) << evaluator.failure().message;
    for (std::size_t i = 0; i < F.size(); ++i)
      EXPECT_NEAR(F[i], expected[i], 10.0 * coefficient_tolerance(order)) << i;
    expect_gradients(*record, jet, order);
  }
}

namespace {

// Equations that are not formulas, for who asks.
class OtherEvaluator final : public EquationSource {
 public:
  explicit OtherEvaluator(std::shared_ptr<const Record> record) : evaluator_(std::move(record)) {}
  bool values(double t, const double* jet, int order, double* F) override {
    return evaluator_.values(t, jet, order, F);
  }
  bool entries(double t, const double* jet, int order, const std::vector<int>& limits, double* values) override {
    return evaluator_.entries(t, jet, order, limits, values);
  }

 private:
  TaylorEvaluator evaluator_;
};

}  // namespace

TEST(RandomEquations, HaveTheirGradientsFromASourceOfEntriesToo) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    const int n = 2 + static_cast<int>(seed % 4);
    const auto record = random_equations(n, seed);
    const Numbers jet = smooth_jet(Numbers(size(n), 0.3), 5, seed);
    std::vector<int> limits(size(n), 1);
    limits[0] = 0;
    const std::vector<int>* const all_limits[] = {nullptr, &limits};
    for (const SeriesOrders orders : {SeriesOrders{0, 0, 0}, {2, 1, 3}, {-1, 2, -1}, {1, -1, 0}})
      for (const std::vector<int>* const limit : all_limits) {
        TaylorEvaluator own(record), asked(record, std::make_shared<OtherEvaluator>(record));
        const std::size_t area = size(n) * size(n);
        Numbers F(size(n) * 3, 7.0), F_xdot(area * 4, 7.0), F_x(area * 4, 7.0), F_asked = F, F_xdot_asked = F_xdot,
                                                                                F_x_asked = F_x;
        ASSERT_TRUE(own.gradients(0.2, jet.data(), orders, F.data(), F_xdot.data(), F_x.data(), limit));
        ASSERT_TRUE(
            asked.gradients(0.2, jet.data(), orders, F_asked.data(), F_xdot_asked.data(), F_x_asked.data(), limit));
        EXPECT_EQ(F, F_asked);
        EXPECT_EQ(F_xdot, F_xdot_asked);
        EXPECT_EQ(F_x, F_x_asked);
      }
  }
}

}  // namespace sfdae::core
