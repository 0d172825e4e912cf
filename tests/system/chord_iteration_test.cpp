// SPDX-License-Identifier: BSD-3-Clause
// A chord iteration ends when the error that it leaves is below the target, and not before.
#include "system/chord_iteration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace sfdae::core {

namespace {

// Changes of a linear iteration with the given rate: norm rate^k; the error left after change k is the sum of all
// later ones. Returns the iteration at which it ends, -1 if it does not within 200.
int end_of(ChordIteration& chord, const ChordTarget& target, double first, double rate) {
  double before = 0.0, norm = first;
  for (int k = 0; k < 200; ++k, before = norm, norm *= rate)
    if (chord.has_converged(target, k, norm, before)) return k;
  return -1;
}

double error_left(double first, double rate, int last) { return first * std::pow(rate, last + 1) / (1.0 - rate); }

}  // namespace

TEST(ChordIteration, LeavesAnErrorBelowTheTargetForEveryRateAboveTheLeast) {
  for (double rate : {0.05, 0.2, 0.5, 0.69})
    for (double first : {1e-3, 1.0, 300.0})
      for (double tolerance : {0.003, 0.02}) {
        ChordIteration chord;
        const int last = end_of(chord, {tolerance, 0.03}, first, rate);
        ASSERT_GE(last, 0);
        EXPECT_LE(error_left(first, rate, last), tolerance * 1.0000001) << rate << ' ' << first;
        if (last > 1) {
          EXPECT_GT(error_left(first, rate, last - 1), 0.1 * tolerance) << rate << ' ' << first;
        }
      }
}

// One equation f(x) = 0 solved with a fixed slope; what was asked is counted.
struct OneEquation {
  std::function<double(double)> f;
  double slope, x, tolerance = 1.0;  // of x
  double size = 0.0;                 // of what is added up in f
  double last_change = 0.0;
  int evaluations = 0;

  std::size_t num_rows() const { return 1; }
  PointStatus evaluate(double* rows) {
    ++evaluations;
    rows[0] = -f(x);
    return PointStatus::ok;
  }
  void add(RowSums kind, double* rows) const {
    rows[0] += kind == RowSums::of_values       ? size
               : kind == RowSums::of_tolerances ? std::fabs(slope) * tolerance
                                                : std::fabs(slope * last_change);
  }
  double change(const double* rows) {
    last_change = rows[0] / slope;
    x += last_change;
    return std::fabs(last_change) / tolerance;
  }
  bool may_end(int) const { return true; }
};

TEST(ChordIteration, AsksTheEquationsBeforeItEnds) {
  OneEquation equation{[](double x) { return x - 3.0; }, 1.0, 2.9999};
  ChordIteration chord;
  chord.set_rate(1e-3);
  ASSERT_EQ(chord.solve({0.02, 1e-3}, equation), PointStatus::ok);
  EXPECT_EQ(equation.evaluations, 2);
  EXPECT_NEAR(equation.x, 3.0, 1e-12);
}

// However small its changes are.
TEST(ChordIteration, RefusesAMatrixThatIsTooLargeByAnyFactor) {
  for (double factor : {4.0, 1e2, 1e6, 1e12, 1e17, 1e30}) {
    OneEquation equation{[](double x) { return x - 3.0; }, factor, 0.0};
    ChordIteration chord;
    chord.set_rate(1e-3);
    EXPECT_EQ(chord.solve({0.02, 1e-3}, equation), PointStatus::not_converged) << factor;
  }
}

// The error left is below the tolerance for each factor by which the matrix is wrong.
TEST(ChordIteration, LeavesAnErrorBelowTheToleranceWhereItEnds) {
  int solved = 0;
  for (double factor = 0.6; factor < 3.4; factor += 0.05)
    for (double first : {1e-3, 0.1, 10.0, 1e4}) {
      OneEquation equation{[](double x) { return x - 3.0; }, factor, 3.0 + first};
      ChordIteration chord;
      chord.set_rate(1e-3);
      if (chord.solve({0.02, 1e-3}, equation) != PointStatus::ok) continue;
      ++solved;
      EXPECT_LE(std::fabs(equation.x - 3.0), 0.0200001) << factor << ' ' << first;
    }
  EXPECT_GT(solved, 100);
}

// Newton's method on an exponential far above its solution, with the matrix of the guess: residuals become smaller by
// a factor of e with each change.
TEST(ChordIteration, IsNotDeceivedByTheMatrixOfAGuess) {
  for (double start : {8.0, 15.0, 40.0}) {
    OneEquation equation{[](double x) { return std::exp(x) - 2.0; }, std::exp(start), start, 100.0};
    ChordIteration chord;
    chord.set_rate(1e-3);
    const DoubtedMatrix doubt(chord);
    EXPECT_NE(chord.solve({0.05, 1e-3}, equation), PointStatus::ok) << start;
  }
}

// Residuals that are rounding errors of their terms say nothing.
TEST(ChordIteration, ExcusesRoundingErrors) {
  OneEquation rounded{[](double x) { return 1e8 + x - (1e8 + 0.3); }, 1.0, 0.3 + 1e-10, 1e-6, 1e8};
  ChordIteration chord;
  chord.set_rate(1e-3);
  EXPECT_EQ(chord.solve({0.02, 1e-3}, rounded), PointStatus::ok);
}

// Sums that overflow say nothing about roundoff.
TEST(ChordIteration, DoesNotExcuseByInfiniteSums) {
  {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    OneEquation equation{[](double x) { return x - 3.0; }, 1e17, 0.0, 1e-6, infinite};
    ChordIteration chord;
    chord.set_rate(1e-3);
    EXPECT_EQ(chord.solve({0.02, 1e-3}, equation), PointStatus::not_converged);
  }
}

// A residual that was 0 before the change and is not after it has no ratio, whatever its sign.
TEST(ResidualTest, RefusesResidualsThatWereZero) {
  for (const double before : {0.0, -0.0})
    for (const double now : {1.0, -1.0}) {
      ResidualTest test;
      test.begin();
      *test.next(1) = before;
      test.note();
      *test.next(1) = now;
      test.note();
      const auto add = [](RowSums kind, double* rows) { rows[0] += kind == RowSums::of_change ? 1.0 : 1e-6; };
      EXPECT_FALSE(test.allows({0.01, 1e-4, 0.7}, true, add)) << before << ' ' << now;
    }
}

// How much roundoff there is may be exaggerated by the matrix of a guess: it counts only as long as no value moves.
TEST(ChordIteration, ExcusesRoundingErrorsAtAGuessUntilValuesMove) {
  for (double start : {3.0, 3.0 + 1e-9}) {
    OneEquation equation{[](double x) { return (x - 3.0) + 1e-15; }, 1e8, start, 1e-6, 1e3};
    ChordIteration chord;
    chord.set_rate(1e-3);
    const DoubtedMatrix doubt(chord);
    EXPECT_EQ(chord.solve({0.02, 1e-3}, equation) == PointStatus::ok, start == 3.0) << start;
  }
}

// x and y that correct each other in turn: the second change is as large as the first, and the third one is tiny. A
// small first change at the next point must not be taken for the last one.
TEST(ChordIteration, CarriesTheLargestRatioOfChangesToTheNextPoint) {
  ChordIteration chord;
  EXPECT_FALSE(chord.has_converged({0.02, 1e-3}, 0, 1.0, 0.0));
  EXPECT_FALSE(chord.has_converged({0.02, 1e-3}, 1, 0.9, 1.0));
  EXPECT_TRUE(chord.has_converged({0.02, 1e-3}, 2, 1e-6, 0.9));
  EXPECT_FALSE(chord.has_converged({0.02, 1e-3}, 0, 0.1, 0.0));
}

// A fresh matrix knows no rate: the first change alone never ends the iteration unless it is negligible.
TEST(ChordIteration, DoesNotEndWithTheFirstChangeBeforeARateIsKnown) {
  ChordIteration chord;
  EXPECT_FALSE(chord.has_converged({0.02, 0.03}, 0, 0.01, 0.0));
  EXPECT_TRUE(chord.has_converged({0.02, 0.03}, 0, 1e-10, 0.0));
}

TEST(ChordIteration, EndsWithASmallFirstChangeWhereTheRateOfTheLastPointIsGood) {
  ChordIteration chord;
  chord.set_rate(1e-3);
  EXPECT_TRUE(chord.has_converged({0.02, 0.03}, 0, 0.01, 0.0));
  chord.set_rate(1e-3);
  EXPECT_FALSE(chord.has_converged({0.02, 0.03, true}, 0, 0.01, 0.0));
}

TEST(ChordIteration, NeverEndsWhereChangesGrow) {
  ChordIteration chord;
  EXPECT_EQ(end_of(chord, {0.02, 0.03}, 1.0, 1.3), -1);
  EXPECT_TRUE(ChordIteration::is_too_slow(2, 1.3, 1.0));
  EXPECT_TRUE(ChordIteration::is_too_slow(2, 0.71, 1.0));
  EXPECT_FALSE(ChordIteration::is_too_slow(2, 0.69, 1.0));
  EXPECT_FALSE(ChordIteration::is_too_slow(1, 0.9, 1.0));
}

TEST(ChordIteration, IsSlowWithManyIterationsOrAPoorRate) {
  ChordIteration chord;
  chord.begin();
  chord.has_converged({1e-8, 1e-3}, 1, 0.1, 1.0);
  EXPECT_FALSE(chord.is_slow());
  chord.has_converged({1e-8, 1e-3}, 1, 0.4, 1.0);
  EXPECT_TRUE(chord.is_slow());
  chord.has_converged({1e-8, 1e-3}, 3, 1e-4, 1e-2);
  EXPECT_TRUE(chord.is_slow());
  chord.begin();
  EXPECT_FALSE(chord.is_slow());
}

}  // namespace sfdae::core
