// SPDX-License-Identifier: BSD-3-Clause
// How far up the derivative array an analysis along jets goes: level mu where its ranks are final, else the level
// above; and how often it evaluates the problem for the units of the unknowns.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "nonlinear_examples.h"
#include "reduction/usual_units.h"

namespace sfdae::core {

namespace {

using sfdae_test::NonlinearExample;
using sfdae_test::Recording;

// Counts what is asked of consistent jets.
class CountedJets final : public CoefficientSource {
 public:
  explicit CountedJets(ConsistentJets& jets) : jets_(jets) {}
  int m() const override { return jets_.m(); }
  int n() const override { return jets_.n(); }
  bool is_constant() const override { return false; }
  bool checks_next_level() const override { return true; }
  bool is_along_jet() const override { return true; }
  CallbackError evaluate(double t, Orders orders, double time_scale, TaylorData& data, RowScaling rows,
                         const std::vector<double>* preferred_rows) override {
    highest = std::max(highest, orders.E);
    ++evaluations;
    return jets_.evaluate(t, orders, time_scale, data, rows, preferred_rows);
  }
  void set_units(Units units) override { jets_.set_units(std::move(units)); }

  int highest = -1, evaluations = 0;

 private:
  ConsistentJets& jets_;
};

struct Course {
  CharacteristicValues values;
  int highest;  // level
};

Course course_of(const NonlinearExample& example, double t, const std::vector<double>& x) {
  ConsistentJets jets(*example.problem, t, x.data(), {});
  CountedJets counted(jets);
  Arena arena;
  std::vector<RankDecision> decisions;
  const CharacteristicValues values = analyze_index(counted, t, t + 1.0, {}, arena, decisions).values;
  return {values, counted.highest};
}

TEST(LevelAbove, IsNotAskedForWhereRanksOfRegularProblemsAreClear) {
  const double c = std::cos(0.6), s = std::sin(0.6), v = 0.7, g = sfdae_test::Pendulum::gravity;
  const Course pendulum =
      course_of(NonlinearExample(sfdae_test::record_of_pendulum()), 0.0, {s, -c, v * c, v * s, v * v + g * c});
  EXPECT_EQ(pendulum.values, (CharacteristicValues{2, 2, 3, 0, 0}));
  EXPECT_EQ(pendulum.highest, 2);
  const Course hyperbola = course_of(NonlinearExample(sfdae_test::record_of_hyperbola()), 0.0, {1.0, 1.0});
  EXPECT_EQ(hyperbola.values, (CharacteristicValues{0, 1, 1, 0, 0}));
  EXPECT_EQ(hyperbola.highest, 0);
}

// How many equations are redundant, and which components are free, one level alone does not say.
TEST(LevelAbove, IsAskedForWhereProblemsAreNotRegular) {
  const Course redundant = course_of(NonlinearExample(sfdae_test::record_with_redundant_equation()), 1.0, {0.5, 0.5});
  EXPECT_EQ(redundant.values, (CharacteristicValues{0, 1, 1, 0, 1}));
  EXPECT_EQ(redundant.highest, 1);
  const Course free = course_of(NonlinearExample(sfdae_test::record_with_free_component()), 0.0, {2.0, 4.0, 0.3});
  EXPECT_EQ(free.values, (CharacteristicValues{0, 1, 1, 1, 0}));
  EXPECT_EQ(free.highest, 1);
}

// x1' = -x1^2, eps x2' = x1 - x2: a pivot of eps stands 1e5 above rounding errors, with eps = 1e-11, and might be one.
TEST(LevelAbove, IsAskedForWhereValuesKeptAreSmall) {
  for (const auto& [eps, highest] : {std::pair{1e-11, 1}, std::pair{1e-3, 0}}) {
    Recording r(2);
    const NonlinearExample example(
        r.finish({r.xdot[0] + r.x[0] * r.x[0], eps * r.xdot[1] + r.x[1] * r.x[0] - r.x[0]}));
    const Course course = course_of(example, 0.0, {1.0, 1.0});
    EXPECT_EQ(course.values, (CharacteristicValues{0, 2, 0, 0, 0})) << eps;
    EXPECT_EQ(course.highest, highest) << eps;
  }
}

// The data that are returned with the units are those that the source has in them, in every bit; it is evaluated once.
TEST(UsualUnits, TakeASingleEvaluation) {
  for (double unit : {1.0, 1e-7, 1e9}) {
    SCOPED_TRACE(unit);
    Recording r(3);
    const NonlinearExample example(r.finish({r.xdot[0] + 3.0 * r.x[0] * r.x[0] - unit * r.x[2],
                                             r.xdot[1] * 0.7 - r.x[0], (unit * r.x[2]) - 5.0 * r.x[1] * r.x[0]}));
    const std::vector<double> x = {0.3, 0.7, 5.0 * 0.7 * 0.3 / unit};
    ConsistentJets jets(*example.problem, 0.0, x.data(), {});
    CountedJets counted(jets);
    const UsualUnits found = usual_units(counted, 0.0);
    EXPECT_EQ(counted.evaluations, 1);
    // Rows scale what is large in all their entries of a column.
    EXPECT_EQ(found.units.are_one(), unit >= 1.0);
    const TaylorData expected = data_in_units(counted, 0.0, found.units);
    EXPECT_EQ(found.data.time_scale, expected.time_scale);
    EXPECT_EQ(found.data.row_scale, expected.row_scale);
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(found.data.E(0)(i, j), expected.E(0)(i, j));
        EXPECT_EQ(found.data.A(0)(i, j), expected.A(0)(i, j));
      }
  }
}

}  // namespace

}  // namespace sfdae::core
