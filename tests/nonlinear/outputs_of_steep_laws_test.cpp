// Outputs between steps where a law is so steep that roundoff in the algebraic unknown is larger than what iterations
// take for roundoff: differentiated unknowns must not move there.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "nonlinear_run.h"
#include "random_family.h"
#include "sfdae/sfdae.h"

namespace sfdae_test {
namespace {

// 0 = g(t) (exp(z / e) - 1) + z - u, u' = c - u - z / 2 with g = exp(k cos(a t)); x = (scale z, u).
struct SteepLaw {
  double scale, e, c, a, k;

  explicit SteepLaw(RandomNumbers& random)
      : scale(std::pow(10.0, random.uniform(-5.0, 5.0))),
        e(random.uniform(0.05, 0.4)),
        c(random.uniform(1.0, 2.0)),
        a(random.uniform(2.0, 6.0)),
        k(random.uniform(8.0, 14.0)) {}

  NonlinearEquations equations() const {
    const SteepLaw law = *this;
    return equations_of(2, 2, [law](const auto& t, const auto* x, const auto* xdot, auto* F) {
      using std::exp, std::cos;
      const auto z = x[0] / law.scale;
      F[0] = exp(law.k * cos(law.a * t)) * (exp(z / law.e) - 1.0) + z - x[1];
      F[1] = xdot[1] - law.c + x[1] + 0.5 * z;
    });
  }
  double z(double t, double u) const {
    const double g = std::exp(k * std::cos(a * t));
    double low = std::min(0.0, u), high = std::max(0.0, u);
    for (int i = 0; i < 200 && high - low > 0.0; ++i) {
      const double middle = 0.5 * (low + high);
      (g * std::expm1(middle / e) + middle < u ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }
  // u at the outputs, from 1 at t = 0, by the classical method of Runge and Kutta.
  std::vector<double> reference(const std::vector<double>& outputs) const {
    constexpr int parts = 400;
    std::vector<double> values;
    double t = 0.0, u = 1.0;
    const auto slope = [this](double at, double value) { return c - value - 0.5 * z(at, value); };
    for (double output : outputs) {
      const double h = (output - t) / parts;
      for (int i = 0; i < parts; ++i, t += h) {
        const double k1 = slope(t, u), k2 = slope(t + 0.5 * h, u + 0.5 * h * k1),
                     k3 = slope(t + 0.5 * h, u + 0.5 * h * k2), k4 = slope(t + h, u + h * k3);
        u += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
      }
      t = output;
      values.push_back(u);
    }
    return values;
  }
};

}  // namespace

// Ten of 288 runs were wrong at outputs, by up to 1.5, with SFDAE_OK: any consistent values were taken there.
TEST(OutputsOfSteepLaws, KeepWhatIsDifferentiated) {
  RandomNumbers random(71);
  std::vector<double> outputs;
  for (int i = 1; i <= 20; ++i) outputs.push_back(0.1 * i);
  for (int number = 0; number < 12; ++number) {
    const SteepLaw law(random);
    const std::vector<double> reference = law.reference(outputs);
    for (const int method : {SFDAE_METHOD_BDF, SFDAE_METHOD_RADAU})
      for (const int structure : {SFDAE_STRUCTURE_AUTOMATIC, SFDAE_STRUCTURE_OFF, SFDAE_STRUCTURE_REQUIRED})
        for (const double tolerance : {1e-4, 1e-5, 1e-6, 1e-7}) {
          SCOPED_TRACE(testing::Message() << "number " << number << ", method " << method << ", structure "
                                          << structure << ", tolerance " << tolerance);
          const std::vector<double> atol = {tolerance * law.scale, tolerance};
          sfdae_options options = options_with(tolerance, method);
          options.structure = structure;
          options.atol_vector = atol.data();
          NonlinearRun run(law.equations(), options);
          ASSERT_GE(run.start(0.0, 2.0, {law.scale * law.z(0.0, 1.0), 1.0}), SFDAE_OK) << run.message();
          for (std::size_t i = 0; i < outputs.size(); ++i) {
            ASSERT_EQ(run.advance(outputs[i]), SFDAE_OK) << run.message();
            EXPECT_NEAR(run.x[1], reference[i], 30.0 * tolerance) << outputs[i];
            EXPECT_NEAR(law.z(run.t, run.x[1]), run.x[0] / law.scale, 1e-9) << outputs[i];
          }
        }
  }
}

}  // namespace sfdae_test
