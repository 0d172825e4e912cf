// SPDX-License-Identifier: BSD-3-Clause
// A chord iteration ends when the error that it leaves is below the target, and not before.
#include "system/chord_iteration.h"

#include <gtest/gtest.h>

#include <cmath>

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

// Newton's method on an exponential far above its solution, with the matrix of the guess, beside what is linear: the
// first change is large, those after it are what is left of exp(-z), 1 / k.
TEST(ChordIteration, IsNotDeceivedByTheMatrixOfAGuess) {
  const double changes[] = {4539.0, 10.84, 7.5, 5.9, 4.9};
  for (bool is_in_doubt : {false, true}) {
    ChordIteration chord;
    const DoubtedMatrix doubt(chord, is_in_doubt);
    int last = 0;
    while (last < 5 && !chord.has_converged({0.03, 0.001}, last, changes[last], last > 0 ? changes[last - 1] : 0.0))
      ++last;
    EXPECT_EQ(last, is_in_doubt ? 5 : 1);
  }
  // What converges does so with one change more; nothing is in doubt afterwards.
  ChordIteration chord;
  {
    const DoubtedMatrix doubt(chord);
    EXPECT_EQ(end_of(chord, {0.03, 0.001}, 100.0, 1e-4), 2);
  }
  EXPECT_EQ(end_of(chord, {0.03, 0.001}, 100.0, 1e-4), 1);
}

// The matrix has an entry that is a thousand times too large: the first change solves what is linear, those that
// follow are a thousandth of the error that is left, which is 100 tolerances.
TEST(ChordIteration, IsNotDeceivedByAMatrixThatIsOutOfDate) {
  for (bool is_out_of_date : {false, true}) {
    ChordIteration chord;
    const double rate = 1.0 - 1e-3;
    int last = 0;
    double before = 0.0, norm = 1e5;
    for (; last < 10; ++last, before = norm, norm = last == 1 ? 0.1 : norm * rate) {
      if (chord.has_converged({0.03, 0.001}, last, norm, before, [&] { return is_out_of_date; })) break;
      if (ChordIteration::is_too_slow(last, norm, before)) break;
    }
    // It is given up.
    EXPECT_EQ(last, is_out_of_date ? 2 : 1);
    EXPECT_EQ(ChordIteration::is_too_slow(last, norm, before), is_out_of_date);
    EXPECT_EQ(chord.is_slow(), is_out_of_date);
  }
}

// Nor where what is left is far below the target, but does not become less.
TEST(ChordIteration, CertainConvergenceNeedsTwoChangesThatSayHowFast) {
  ChordIteration chord;
  const auto out_of_date = [] { return true; };
  EXPECT_FALSE(chord.has_converged({0.03, 0.001}, 1, 1e-3, 100.0, out_of_date));
  EXPECT_FALSE(chord.has_converged({0.03, 0.001}, 2, 9.9e-4, 1e-3, out_of_date));
  EXPECT_TRUE(chord.has_converged({0.03, 0.001}, 3, 1e-4, 9.9e-4, out_of_date));
  EXPECT_TRUE(chord.has_converged({0.03, 0.001}, 0, 1e-10, 0.0, out_of_date));
  EXPECT_FALSE(chord.has_converged({0.03, 0.001}, 1, 1.0, 100.0, out_of_date));
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
