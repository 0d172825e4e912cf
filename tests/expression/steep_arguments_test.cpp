// SPDX-License-Identifier: BSD-3-Clause
// How accurately unknowns have to be known where exponentials depend on them.
#include "expression/steep_arguments.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "expression/taylor_evaluator.h"
#include "recorded.h"

namespace sfdae::core {

namespace {

using namespace sfdae_test;

// 1 / tolerances before and after, at x, of equations that `equations` makes of a recording of n unknowns.
template <class Equations>
std::vector<double> sharpened(const std::vector<double>& x, std::vector<double> inverse, double t,
                              Equations equations) {
  Recording recording(static_cast<int>(x.size()));
  const TaylorEvaluator evaluator(recording.finish(equations(recording)));
  SteepArguments arguments({&evaluator});
  arguments.sharpen(t, x.data(), inverse.data());
  return inverse;
}

}  // namespace

// 26 mV, and tolerances of 0.3 and 0.1 V: 0.4 / 0.026 = 15.4 may change by 0.01.
TEST(SteepArguments, OfADiode) {
  const auto diode = [](Recording& r) {
    return std::vector<Term>{r.x[2] - 1e-12 * (exp((r.x[0] - r.x[1]) / 0.026) - 1.0), r.x[0] - 5.0, r.x[1] - r.x[3],
                             r.x[3] - 1.0};
  };
  const std::vector<double> result = sharpened({300.0, 310.0, 0.5, 1.0}, {1 / 0.3, 1 / 0.1, 1e3, 1e3}, 0.0, diode);
  const double factor = 0.4 / 0.026 / 0.01;
  EXPECT_NEAR(result[0], factor / 0.3, 1e-9 * factor);
  EXPECT_NEAR(result[1], factor / 0.1, 1e-9 * factor);
  EXPECT_EQ(result[2], 1e3);
  EXPECT_EQ(result[3], 1e3);
}

// What is known well enough stays, to the last bit.
TEST(SteepArguments, ThatAreKnownChangeNothing) {
  const auto diode = [](Recording& r) { return std::vector<Term>{r.x[1] - exp(r.x[0] / 0.026), r.x[0] - 5.0}; };
  const std::vector<double> inverse{1e4, 1.0};
  EXPECT_EQ(sharpened({0.6, 1e3}, inverse, 0.0, diode), inverse);
}

// Quotients and products: a reaction's exp(-8000 / T) at 400 K is known to a hundredth for changes of 0.2 K; the
// other one for 0.05.
TEST(SteepArguments, OfQuotientsAndProducts) {
  const auto reaction = [](Recording& r) {
    return std::vector<Term>{r.x[1] - exp(-8000.0 / r.x[0]), r.x[2] - exp(2.0 * r.x[1] * r.x[2])};
  };
  const std::vector<double> result = sharpened({400.0, 0.1, 0.0}, {1.0, 1.0, 1e6}, 0.0, reaction);
  EXPECT_NEAR(result[0], 8000.0 / (400.0 * 400.0) / 0.01, 1e-9);
  EXPECT_NEAR(result[1], 1.0, 1e-9);
  const std::vector<double> other = sharpened({400.0, 0.1, 3.0}, {1e9, 10.0, 1e9}, 0.0, reaction);
  EXPECT_NEAR(other[1], 10.0 * (2.0 * 3.0 * 0.1 + 2.0 * 0.1 * 1e-9) / 0.01, 1e-4);
}

// Roundings of unknowns are not asked to be less than they are.
TEST(SteepArguments, AreNotKnownBeyondRoundingErrors) {
  const auto steep = [](Recording& r) { return std::vector<Term>{r.x[0] - exp(1e20 * r.x[0])}; };
  EXPECT_DOUBLE_EQ(sharpened({2.0}, {1.0}, 0.0, steep)[0], 1.0 / 2e-12);
}

// At a pole nothing is known.
TEST(SteepArguments, AtPolesAreLeftAlone) {
  const auto reaction = [](Recording& r) { return std::vector<Term>{r.x[0] - exp(-1.0 / r.x[0])}; };
  EXPECT_EQ(sharpened({0.0}, {3.0}, 0.0, reaction)[0], 3.0);
  const auto both = [](Recording& r) { return std::vector<Term>{r.x[0] - exp(-1.0 / r.x[0]) - exp(r.x[0] / 0.02)}; };
  EXPECT_NEAR(sharpened({0.0}, {3.0}, 0.0, both)[0], 1.0 / (0.02 * 0.01), 1e-6);
}

TEST(SteepArguments, FollowChangesOfParameters) {
  Recording recording(1);
  const Term V = recording.parameter("V", 0.025);
  TaylorEvaluator evaluator(recording.finish({recording.x[0] - exp(recording.x[0] / V)}));
  SteepArguments arguments({&evaluator});
  const double x = 0.6;
  for (const double value : {0.025, 0.05}) {
    evaluator.set_parameter(0, value);
    double inverse = 1.0;
    arguments.sharpen(0.0, &x, &inverse);
    EXPECT_NEAR(inverse, 1.0 / value / 0.01, 1e-6);
  }
}

// Sources in arguments, and hyperbolic functions. Arguments of t alone, or of functions whose changes are not
// followed, are left alone.
TEST(SteepArguments, OfOtherKinds) {
  const auto with_source = [](Recording& r) { return std::vector<Term>{r.x[0] - sinh(r.t * (r.x[0] - sin(r.t)))}; };
  EXPECT_NEAR(sharpened({1.0}, {1.0}, 5.0, with_source)[0], 500.0, 1e-9);
  const auto of_time = [](Recording& r) { return std::vector<Term>{r.x[0] - exp(100.0 * r.t)}; };
  EXPECT_EQ(sharpened({1.0}, {1.0}, 1.0, of_time)[0], 1.0);
  const auto of_sine = [](Recording& r) { return std::vector<Term>{r.x[0] - exp(100.0 * sin(r.x[0]))}; };
  EXPECT_EQ(sharpened({1.0}, {1.0}, 1.0, of_sine)[0], 1.0);
  const auto of_cosine = [](Recording& r) { return std::vector<Term>{r.x[0] - exp(100.0 * (r.x[0] + cos(r.x[0])))}; };
  EXPECT_EQ(sharpened({1.0}, {1.0}, 1.0, of_cosine)[0], 1.0);
  const auto of_cosh = [](Recording& r) { return std::vector<Term>{r.x[0] - exp(100.0 * r.x[0] / cosh(r.x[0]))}; };
  EXPECT_NEAR(sharpened({1.0}, {1.0}, 1.0, of_cosh)[0], 1.0 / 0.01, 1e-9);  // the argument of cosh
  const auto of_derivative = [](Recording& r) {
    return std::vector<Term>{r.x[0] - exp(100.0 * (r.x[0] + r.xdot[0]))};
  };
  EXPECT_EQ(sharpened({1.0}, {1.0}, 1.0, of_derivative)[0], 1.0);
}

// By more than two; exponentials that are nothing anywhere do not count, nor do those that rise.
TEST(SteepArguments, HaveFallen) {
  Recording recording(2);
  const Term V = recording.parameter("V", 0.025);
  TaylorEvaluator evaluator(
      recording.finish({recording.x[0] - exp((recording.x[0] - sin(recording.t)) / V), recording.x[1]}));
  SteepArguments arguments({&evaluator});
  const auto fallen = [&](double from, double to, double t_from = 0.0, double t_to = 0.0) {
    const double x_from[] = {from, 1.0}, x_to[] = {to, 2.0};
    return arguments.have_fallen({t_from, x_from}, {t_to, x_to});
  };
  EXPECT_TRUE(fallen(0.6, 0.549));
  EXPECT_FALSE(fallen(0.6, 0.551));
  EXPECT_FALSE(fallen(0.549, 0.6));
  EXPECT_FALSE(fallen(-2.6, -300.0));
  EXPECT_TRUE(fallen(0.6, 0.6, 0.0, 0.1));
  EXPECT_FALSE(fallen(0.6, 0.6, 0.1, 0.0));
  EXPECT_FALSE(fallen(NAN, 0.6));
  EXPECT_FALSE(fallen(0.6, NAN));
  evaluator.set_parameter(0, 0.05);
  EXPECT_FALSE(fallen(0.6, 0.549));
  EXPECT_TRUE(fallen(0.6, 0.499));
}

// On both sides of zero.
TEST(SteepArguments, OfHyperbolicFunctionsHaveFallen) {
  Recording recording(1);
  TaylorEvaluator evaluator(recording.finish({recording.x[0] - sinh(recording.x[0] / 0.05)}));
  SteepArguments arguments({&evaluator});
  const auto fallen = [&](double from, double to) { return arguments.have_fallen({0.0, &from}, {0.0, &to}); };
  EXPECT_TRUE(fallen(0.6, 0.49));
  EXPECT_TRUE(fallen(-0.6, -0.49));
  EXPECT_TRUE(fallen(-0.6, 0.49));
  EXPECT_FALSE(fallen(0.49, -0.6));
}

}  // namespace sfdae::core
