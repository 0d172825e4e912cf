// SPDX-License-Identifier: BSD-3-Clause
// Where ranks along a jet are not clear, the message names tolerances, and these give what it says.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "nonlinear_run.h"

namespace {

using namespace sfdae_test;

// x1' = -x1 + x2, eps x2' = -x2 - x2^3 + x1: an ODE, or mu = 0 with d = 1, a = 1.
NonlinearEquations nearly_algebraic(double eps) {
  return equations_of(2, 2, [eps](const auto&, const auto* x, const auto* xdot, auto* F) {
    F[0] = xdot[0] + x[0] - x[1];
    F[1] = eps * xdot[1] + x[1] + x[1] * x[1] * x[1] - x[0];
  });
}

struct Named {
  double rank_tol;
  std::string values;
};
// Of what the message says about one rank.
Named named_in(const std::string& message, std::size_t at) {
  const std::size_t tolerance = message.find("rank_tol = ", at) + 11, values = message.find("mu = ", at);
  return {std::strtod(message.c_str() + tolerance, nullptr),
          message.substr(values, message.find('.', values) - values)};
}

TEST(UnclearRanks, AreNamedWithTolerancesForEitherResult) {
  int unclear = 0;
  for (const double eps : {1e-15, 3e-15, 1e-14, 3e-14, 1e-13, 1e-12}) {
    SCOPED_TRACE(eps);
    sfdae_options options = options_with(1e-6);
    options.structure = SFDAE_STRUCTURE_OFF;  // which says that the coefficient is there
    NonlinearRun run(nearly_algebraic(eps), options);
    const int status = run.start(0.0, 1.0, {1.0, 0.6823278038280193});
    if (status >= 0) continue;
    ASSERT_EQ(status, SFDAE_RANK_UNCLEAR) << run.message();
    ++unclear;
    const std::string message = run.message();
    const std::size_t keeping = message.find("With rank "), dropping = message.find("With rank ", keeping + 1);
    ASSERT_NE(dropping, std::string::npos) << message;
    for (const Named& named : {named_in(message, keeping), named_in(message, dropping)}) {
      options.rank_tol = named.rank_tol;
      NonlinearRun decided(nearly_algebraic(eps), options);
      ASSERT_GE(decided.start(0.0, 1.0, {1.0, 0.6823278038280193}), 0) << message << " / " << decided.message();
      const CharacteristicValues v = decided.values();
      EXPECT_EQ(named.values, "mu = " + std::to_string(v.mu) + ", d = " + std::to_string(v.d) +
                                  ", a = " + std::to_string(v.a) + ", u = " + std::to_string(v.u) +
                                  ", v = " + std::to_string(v.v));
    }
    EXPECT_NE(named_in(message, keeping).values, named_in(message, dropping).values);
  }
  EXPECT_GE(unclear, 1);
}

}  // namespace
