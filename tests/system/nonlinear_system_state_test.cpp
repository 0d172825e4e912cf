// SPDX-License-Identifier: BSD-3-Clause
// Nonlinear systems with prescribed components, in checkpoints, and with units of their unknowns.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "array/nonlinear_system.h"
#include "integrate/radau_method.h"
#include "linalg/archive.h"
#include "matrix_checks.h"
#include "nonlinear_examples.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

using sfdae_test::NonlinearExample;
using sfdae_test::rounding;
using sfdae_test::size;
using Vector = std::vector<double>;

// Value and trouble of the prescribed x3 = 0.3 + t: from `bad_from` on to `bad_to` the code, or NaN for code 0.
struct Input {
  double bad_from = INFINITY, bad_to = INFINITY;
  int code = 1;
};
int input_values(double t, int, double* to, void* user) {
  const Input& input = *static_cast<const Input*>(user);
  to[0] = 0.3 + t;
  if (t < input.bad_from || t >= input.bad_to) return 0;
  to[0] = std::nan("");
  return input.code;
}

Vector values_of(const NonlinearSystem& system) {
  return {system.jet().x.data(), system.jet().x.data() + system.jet().n};
}

// Collocation from x = (1, 1, 0.3) at 0 to h with s stages.
PointStatus solve_stages(NonlinearSystem& system, int s, double h, Vector& x) {
  const std::size_t block = system.jet().x.size(), n = size(system.jet().n);
  const Vector start = values_of(system);
  Vector taylor(block * size(s), 0.0), before(block, 0.0), weights(n, 1e12), w(n * size(s));
  for (int i = 0; i < s; ++i)
    std::copy(start.begin(), start.end(), taylor.begin() + static_cast<std::ptrdiff_t>(block) * i);
  std::copy(start.begin(), start.end(), before.begin());
  x.resize(n * size(s));
  double reached = 0.0;
  if (system.move_to(h) != PointStatus::ok) return PointStatus::callback_error;
  return system.solve_stages(
      {radau_method(s).stages, 0.0, h, start.data(), start.data(), {taylor.data(), before.data(), weights.data()}},
      x.data(), w.data(), reached);
}

// One step of implicit Euler, the guess as constant as the point before.
Vector step_from(NonlinearSystem& system, const Vector& x0, double t) {
  const double c = 1.0 / (t - system.t());
  Vector rest(x0), taylor(system.jet().x.size(), 0.0), before(taylor), weights(x0.size(), 1e12), x(x0);
  for (double& value : rest) value *= -c;
  std::copy(x0.begin(), x0.end(), taylor.begin());
  std::copy(x0.begin(), x0.end(), before.begin());
  EXPECT_EQ(system.move_to(t), PointStatus::ok);
  EXPECT_EQ(system.solve({c, rest.data(), rest.data(), {taylor.data(), before.data(), weights.data()}}, x.data()),
            PointStatus::ok);
  return x;
}

bool same_bits(const Vector& a, const Vector& b) {
  bool same = a.size() == b.size();
  for (std::size_t i = 0; same && i < a.size(); ++i)
    same = std::bit_cast<std::uint64_t>(a[i]) == std::bit_cast<std::uint64_t>(b[i]);
  return same;
}

}  // namespace

// x1' = x1 x3 with x3 = 0.3 + t: implicit Euler gives x1 = 1 / (1 - h (0.3 + h)), Radau exp(0.3 h + h^2 / 2).
TEST(PrescribedComponents, TakeTheirValuesInStepsAndStages) {
  const double h = 0.1;
  for (int s : {0, 1, 3, 5}) {
    Input input;
    NonlinearExample e(sfdae_test::record_with_free_component(), {{2}, input_values, &input});
    e.analyze(0.0, 1.0, {1.0, 1.0, 0.3});
    EXPECT_EQ(e.system->undetermined(), 0);
    Vector x;
    if (s == 0) x = step_from(*e.system, values_of(*e.system), h);
    else ASSERT_EQ(solve_stages(*e.system, s, h, x), PointStatus::ok) << s;
    const std::size_t last = x.size() - 3;
    const double exact = s < 3 ? 1.0 / (1.0 - h * (0.3 + h)) : std::exp(0.3 * h + 0.5 * h * h);
    EXPECT_NEAR(x[last + 2], 0.3 + h, rounding(3)) << s;
    EXPECT_NEAR(x[last], exact, (s == 3 ? std::pow(h, 6) : 0.0) + 10.0 * rounding(3)) << s;
    EXPECT_NEAR(x[last + 1], x[last] * x[last], 10.0 * rounding(3)) << s;
  }
}

TEST(PrescribedComponents, MoveTheStartWhereItDiffers) {
  Input input;
  NonlinearExample e(sfdae_test::record_with_free_component(), {{2}, input_values, &input});
  e.analyze(0.0, 1.0, {1.0, 1.0, 7.0});
  e.system->apply_inputs();
  const Vector x = values_of(*e.system);
  EXPECT_NEAR(x[2], 0.3, rounding(3));
  EXPECT_NEAR(x[1], x[0] * x[0], 10.0 * rounding(3));
  EXPECT_NEAR(x[0], 1.0, 10.0 * rounding(3));
}

// At an inner stage, at the end, and everywhere: never a solution with other inputs than those prescribed.
TEST(PrescribedComponents, TroubleAtAnyStageIsTroubleOfTheStep) {
  for (int s : {1, 3, 5})
    for (const Input& bad :
         {Input{0.06, 0.09, 1}, Input{0.06, 0.09, -1}, Input{0.06, 0.09, 0}, Input{0.05, 9.0, 1}}) {
      Input input;
      NonlinearExample e(sfdae_test::record_with_free_component(), {{2}, input_values, &input});
      e.analyze(0.0, 1.0, {1.0, 1.0, 0.3});
      input = bad;
      Vector x;
      const bool is_met = s > 1 || bad.bad_to > 0.1;  // stages of s = 3: 0.016, 0.064; of s = 5: ..., 0.058, 0.086
      EXPECT_EQ(solve_stages(*e.system, s, 0.1, x), is_met ? PointStatus::callback_error : PointStatus::ok)
          << s << ", " << bad.bad_from << ", code " << bad.code;
    }
}

TEST(PrescribedComponents, AreRefusedWhereTheyDoNotDetermineTheRest) {
  for (const std::vector<int>& components : {std::vector<int>{0}, std::vector<int>{2, 0}}) {
    const auto values = [](double, int, double* to, void* user) {
      to[0] = to[static_cast<PrescribedInputs*>(user)->components.size() - 1] = 1.0;
      return 0;
    };
    PrescribedInputs inputs{components, values, nullptr};
    inputs.user = &inputs;
    NonlinearExample e(sfdae_test::record_with_free_component(), inputs);
    int status = SFDAE_OK;
    try {
      e.analyze(0.0, 1.0, {1.0, 1.0, 0.3});
    } catch (const Failure& failure) {
      status = failure.status();
    }
    // With x1 prescribed x1' = x1 x3 is an equation for x3 that needs a derivative: no differential equation is left.
    EXPECT_EQ(status, SFDAE_PRESCRIPTION_SINGULAR) << components.size();
  }
}

// What follows after a checkpoint is what would have followed without, bit for bit.
TEST(NonlinearSystem, GoesOnFromAnArchiveAsIfNothingHadHappened) {
  for (bool scaled : {false, true}) {
    NonlinearExample e(sfdae_test::record_of_pendulum());
    const double c = std::cos(0.6), s = std::sin(0.6);
    e.analyze(0.0, 1.0, {s, -c, 0.7 * c, 0.7 * s, 0.49 + sfdae_test::Pendulum::gravity * c});
    if (scaled)
      e.system = std::make_unique<NonlinearSystem>(*e.problem, e.settings, e.analysis,
                                                   Vector{1.0, 1.0, 4.0, 4.0, 0.125}, e.jet);
    Vector x = values_of(*e.system);
    for (int k = 1; k <= 30; ++k) {
      x = step_from(*e.system, x, 1e-3 * k);
      e.system->accept();
    }
    Archive counter = Archive::counter();
    e.system->archive(counter);
    Vector state(counter.size()), again(counter.size());
    Archive writer = Archive::writer(state.data(), state.size());
    e.system->archive(writer);
    sfdae_test::RecordPointer record = sfdae_test::record_of_pendulum();
    RecordedProblem other_problem(record, sfdae::core::PrescribedInputs{});
    Archive reader = Archive::reader(state.data(), state.size());
    NonlinearSystem restored(other_problem, e.settings, reader);
    EXPECT_EQ(reader.size(), state.size());
    EXPECT_EQ(restored.t(), e.system->t());
    Archive rewriter = Archive::writer(again.data(), again.size());
    restored.archive(rewriter);
    EXPECT_TRUE(same_bits(state, again));
    Vector y = x;
    for (int k = 31; k <= 80; ++k) {
      x = step_from(*e.system, x, 1e-3 * k);
      y = step_from(restored, y, 1e-3 * k);
      ASSERT_TRUE(same_bits(x, y)) << k << (scaled ? ", scaled" : "");
      e.system->accept();
      restored.accept();
    }
  }
}

// Steps of index 0 that change by less than a factor of 5/3 keep their factorization, which belongs to the state: saved
// after any number of steps.
TEST(NonlinearSystem, GoesOnWithTheFactorizationThatIsKept) {
  const auto time_of = [](int k) { return 1e-2 * k + 2e-3 * std::sin(1.3 * k); };
  for (int saved = 1; saved <= 24; ++saved) {
    NonlinearExample e(sfdae_test::record_of_hyperbola());
    e.analyze(0.0, 1.0, {1.0, 1.0});
    Vector x = values_of(*e.system);
    for (int k = 1; k <= saved; ++k) {
      x = step_from(*e.system, x, time_of(k));
      e.system->accept();
    }
    Archive counter = Archive::counter();
    e.system->archive(counter);
    Vector state(counter.size());
    Archive writer = Archive::writer(state.data(), state.size());
    e.system->archive(writer);
    RecordedProblem other_problem(sfdae_test::record_of_hyperbola(), sfdae::core::PrescribedInputs{});
    Archive reader = Archive::reader(state.data(), state.size());
    NonlinearSystem restored(other_problem, e.settings, reader);
    EXPECT_EQ(reader.size(), state.size());
    Vector y = x;
    for (int k = saved + 1; k <= saved + 30; ++k) {
      x = step_from(*e.system, x, time_of(k));
      y = step_from(restored, y, time_of(k));
      ASSERT_TRUE(same_bits(x, y)) << k << ", saved after " << saved;
      e.system->accept();
      restored.accept();
    }
  }
}

// x_i' = -x_i for four, z = x1 x2 + x3: errors of w = x keep x1, ..., x4 and become dz = x2 dx1 + x1 dx2 + dx3. So by
// the form that was judged and, once a step has been taken, by the kernel of E, in any units.
TEST(NonlinearSystem, MapsErrorsToTheConstraints) {
  const auto record = [] {
    sfdae_test::Recording r(5);
    return r.finish({r.xdot[0] + r.x[0], r.xdot[1] + r.x[1], r.xdot[2] + r.x[2], r.xdot[3] + r.x[3],
                     r.x[4] - r.x[0] * r.x[1] - r.x[2]});
  };
  for (bool scaled : {false, true}) {
    NonlinearExample e(record());
    e.analyze(0.0, 1.0, {1.0, 0.5, 2.0, 3.0, 2.5});
    if (scaled)
      e.system = std::make_unique<NonlinearSystem>(*e.problem, e.settings, e.analysis,
                                                   Vector{4.0, 1.0, 0.25, 8.0, 0.5}, e.jet);
    Vector at = values_of(*e.system), x = at;  // where the Jacobian is from
    for (int k = 0; k < 3; ++k) {
      const Vector dw{1e-3, -2e-3, 5e-4, 1e-2, 7.0, 0.0, 1.0, 0.0, -1.0, 3.0};
      Vector dx(10, NAN);
      e.system->error_in_x(dw.data(), 2, dx.data());
      for (std::size_t j : {0u, 5u}) {
        for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(dx[j + i], dw[j + i], 10.0 * rounding(5));
        EXPECT_NEAR(dx[j + 4], at[1] * dw[j] + at[0] * dw[j + 1] + dw[j + 2], 10.0 * rounding(5)) << k;
      }
      x = step_from(*e.system, x, 1e-3 * (k + 1));
      e.system->accept();
    }
  }
}

TEST(NonlinearSystem, RefusesDamagedArchives) {
  NonlinearExample e(sfdae_test::record_of_hyperbola());
  e.analyze(0.0, 1.0, {1.0, 1.0});
  Archive counter = Archive::counter();
  e.system->archive(counter);
  Vector state(counter.size());
  Archive writer = Archive::writer(state.data(), state.size());
  e.system->archive(writer);
  const auto read = [&](const Vector& from) {
    Archive reader = Archive::reader(from.data(), from.size());
    NonlinearSystem restored(*e.problem, e.settings, reader);
  };
  EXPECT_NO_THROW(read(state));
  for (std::size_t length = 1; length < state.size(); ++length)
    EXPECT_THROW(read(Vector(state.begin(), state.begin() + static_cast<std::ptrdiff_t>(length))), DamagedArchive)
        << length;
  for (std::size_t i = 0; i < state.size(); ++i) {
    Vector damaged = state;
    damaged[i] = std::nan("");
    EXPECT_THROW(read(damaged), DamagedArchive) << i;
  }
}

// The unknowns may have any units: steps are the same up to rounding.
TEST(NonlinearSystem, StepsDoNotDependOnUnitsOfTheUnknowns) {
  Vector reference;
  for (const Vector& units : {Vector{}, Vector{1.0, 1.0, 64.0, 0.25, 1024.0}, Vector{1e-3, 8.0, 1.0, 1.0, 1.0}}) {
    NonlinearExample e(sfdae_test::record_of_pendulum());
    const double c = std::cos(0.6), s = std::sin(0.6);
    e.analyze(0.0, 1.0, {s, -c, 0.7 * c, 0.7 * s, 0.49 + sfdae_test::Pendulum::gravity * c});
    NonlinearSystem system(*e.problem, e.settings, e.analysis, units, e.jet);
    Vector x = values_of(system), xdot(5);
    ASSERT_TRUE(system.exact_derivative(x.data(), xdot.data()));
    Vector restored = x;
    for (double& value : restored) value += 1e-3;
    system.restore(restored.data(), restored.data(), restored.data());
    EXPECT_NEAR(restored[0] * restored[0] + restored[1] * restored[1], 1.0, 10.0 * rounding(5));
    for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(xdot[i], x[i + 2], 100.0 * rounding(5));
    // Z1 depends on the units; what it solves at small h does not.
    x = step_from(system, x, 1e-4);
    EXPECT_NEAR(x[0] * x[2] + x[1] * x[3], 0.0, 10.0 * rounding(5));
    if (reference.empty()) reference = x;
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(x[i], reference[i], 40.0 * 1e-8) << i;
  }
}

}  // namespace sfdae::core
