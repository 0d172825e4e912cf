// SPDX-License-Identifier: BSD-3-Clause
// DGELDA from C++: values, codes, and what it leaves in its arrays.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "dgelda_run.h"

using sfdae_test::DgeldaRun;
using sfdae_test::UserData;

namespace {

// E = [0 0; 1 -t], A = [-1 t; 0 0], f = (exp(-t), 0); x = ((1 + t) exp(-t), exp(-t)), characteristic values (1, 0, 2,
// 0).
UserData document_problem() {
  UserData data{2, {}, {}, {}};
  data.E = [](double t, int order, double* E) {
    if (order == 0) E[1] = 1.0;
    E[3] = order == 0 ? -t : order == 1 ? -1.0 : 0.0;
    return 0;
  };
  data.A = [](double t, int order, double* A) {
    if (order == 0) A[0] = -1.0;
    A[2] = order == 0 ? t : order == 1 ? 1.0 : 0.0;
    return 0;
  };
  data.f = [](double t, int order, double* f) {
    f[0] = order % 2 == 0 ? std::exp(-t) : -std::exp(-t);
    return 0;
  };
  return data;
}

// x1' = -x1 + cos t, 0 = x1 - x2: values (0, 1, 1, 0), E not read as constant. With x1(0) = 1 / 2:
// x1 = (cos t + sin t) / 2.
UserData decay(double rate = 1.0) {
  UserData data{2, {}, {}, {}};
  data.E = [](double, int order, double* E) {
    if (order == 0) E[0] = 1.0;
    return 0;
  };
  data.A = [rate](double, int order, double* A) {
    if (order == 0) A[0] = -rate, A[1] = 1.0, A[3] = -1.0;
    return 0;
  };
  data.f = [](double t, int order, double* f) {
    f[0] = std::cos(t + order * 1.5707963267948966);
    return 0;
  };
  return data;
}

double decay_exact(double t) { return 0.5 * (std::cos(t) + std::sin(t)); }

class Methods : public testing::TestWithParam<int> {};

INSTANTIATE_TEST_SUITE_P(Dgelda, Methods, testing::Values(1, 2),
                         [](const auto& parameter) { return parameter.param == 1 ? "Bdf" : "Radau"; });

template <class Integer>
void run_document_problem(int method, DgeldaEntry<Integer>* entry) {
  DgeldaRun<Integer> run(document_problem(), method);
  run.rtol[0] = run.atol[0] = 1e-5;
  ASSERT_EQ(run.call(0.0, entry), 4);
  EXPECT_EQ(run.info[0], 2);
  EXPECT_EQ(run.iwarn, 0);
  EXPECT_EQ(run.cval, (std::vector<Integer>{1, 0, 2, 0}));
  EXPECT_NEAR(run.x[0], 1.0, 1e-14);
  for (int i = 1; i <= 10; ++i) {
    const double t = 0.1 * i;
    ASSERT_EQ(run.call(t, entry), 3);
    EXPECT_EQ(run.info[0], 1);
    EXPECT_EQ(run.t, t);
    EXPECT_NEAR(run.x[0], (1.0 + t) * std::exp(-t), 1e-6);
    EXPECT_NEAR(run.x[1], std::exp(-t), 1e-6);
    EXPECT_NEAR(run.xprime[1], -std::exp(-t), 1e-6);
    EXPECT_GE(run.rw(4), t);
    EXPECT_GE(run.iw(11), i);
  }
}

}  // namespace

TEST_P(Methods, SolveTheProblemOfTheDocument) {
  run_document_problem<std::int32_t>(GetParam(), dgelda_);
  run_document_problem<std::int64_t>(GetParam(), dgelda_64_);
  run_document_problem<std::int64_t>(GetParam(), dgelda_64__);
}

TEST_P(Methods, KeepTheirAccuracyInEitherDirection) {
  for (double direction : {1.0, -1.0})
    for (int constant : {0, 1})
      for (int start : {0, 1}) {
        DgeldaRun run(decay(), GetParam());
        run.info[4] = constant;
        run.x = {0.5, 0.7};
        run.info[11] = 1;
        if (start == 1) {
          ASSERT_EQ(run.call(0.0), 4);
          EXPECT_NEAR(run.xprime[0], 0.5, 1e-12);
        }
        for (int i = 1; i <= 20; ++i) {
          ASSERT_EQ(run.call(direction * 0.1 * i), 3);
          EXPECT_NEAR(run.x[0], decay_exact(run.t), 1e-4);
          EXPECT_NEAR(run.x[1], decay_exact(run.t), 1e-4);
        }
        EXPECT_EQ(run.cval, (std::vector<std::int32_t>{0, 1, 1, 0}));
        if (constant == 1) {
          EXPECT_EQ(run.user.calls_E, 1);
          EXPECT_EQ(run.user.calls_A, 1);
        }
      }
}

// Work arrays, X and CVAL may be moved between calls and problems interleaved.
TEST_P(Methods, KeepNothingElseBetweenCalls) {
  DgeldaRun plain(decay(), GetParam());
  plain.x = {0.5, 0.5};
  DgeldaRun broken = plain;
  for (int i = 1; i <= 30; ++i) {
    plain.info[2] = broken.info[2] = i % 2;
    const double tout = std::max(0.1 * i, plain.t + 0.05);
    DgeldaRun moved = broken;
    DgeldaRun other(document_problem(), 3 - GetParam());
    ASSERT_EQ(other.call(1.0), 3);
    ASSERT_EQ(moved.call(tout), plain.call(tout));
    ASSERT_EQ(moved.t, plain.t);
    ASSERT_EQ(moved.x, plain.x);
    ASSERT_EQ(moved.xprime, plain.xprime);
    ASSERT_EQ(moved.iwork, plain.iwork);
    broken = moved;
  }
}

TEST_P(Methods, AnswerDamagedStatesWithACode) {
  DgeldaRun run(decay(), GetParam());
  run.x = {0.5, 0.5};
  EXPECT_EQ(DgeldaRun(run).call(1.0), 3);
  DgeldaRun fresh(decay(), GetParam());
  fresh.info[0] = 1;
  EXPECT_EQ(fresh.call(1.0), -101);
  EXPECT_EQ(fresh.info[0], -1);
  for (bool early : {true, false}) {
    DgeldaRun good = run;
    good.info[2] = 1;
    ASSERT_GT(good.call(early ? 0.0 : 1.0), 0);
    for (int position = 21; position <= good.lrw; ++position) {
      DgeldaRun damaged = good;
      double& value = damaged.rwork[static_cast<std::size_t>(position - 1)];
      if (std::isnan(value)) continue;
      value = value == 0.0 ? 1.0 : -value * 3.0;
      EXPECT_EQ(damaged.call(2.0), -101) << position;
    }
    for (int position : {16, 17, 18}) {
      DgeldaRun damaged = good;
      damaged.iwork[static_cast<std::size_t>(position - 1)] ^= 0x11;
      EXPECT_EQ(damaged.call(2.0), -101) << position;
    }
    DgeldaRun other_method = good;
    other_method.method = 3 - GetParam();
    EXPECT_EQ(other_method.call(2.0), -132);
    DgeldaRun other_order = good;
    other_order.n = 1;
    EXPECT_EQ(other_order.call(2.0), -101);
  }
}

namespace {

using Change = std::function<void(DgeldaRun<>&)>;

int code_after(const Change& change, int method = 1, double tout = 1.0) {
  DgeldaRun run(decay(), method);
  run.x = {0.5, 0.5};
  change(run);
  const std::vector<double> x = run.x, xprime = run.xprime;
  const double t = run.t;
  const int ierr = run.call(tout);
  EXPECT_EQ(run.info[0], -1);
  EXPECT_EQ(run.x, x);
  EXPECT_EQ(run.xprime, xprime);
  EXPECT_TRUE(run.t == t || std::isnan(t));
  EXPECT_TRUE(run.guards_are_intact());
  EXPECT_EQ(run.call(tout), -999);
  return ierr;
}

}  // namespace

TEST(Dgelda, NamesWhatIsWrongWithItsInput) {
  const auto flag = [](int k, int value) {
    return Change([=](DgeldaRun<>& r) { r.info[static_cast<std::size_t>(k - 1)] = value; });
  };
  const auto reals = [](int k, int first, std::vector<double> values) {
    return Change([=](DgeldaRun<>& r) {
      for (std::size_t i = 0; i < values.size(); ++i) r.set_real(k, first + static_cast<int>(i), values[i]);
    });
  };
  const auto integer = [](int k, int position, int value) {
    return Change([=](DgeldaRun<>& r) { r.set_integer(k, position, value); });
  };
  const auto real = [](int k, int position, double value) {
    return Change([=](DgeldaRun<>& r) { r.set_real(k, position, value); });
  };
  for (int k = 2; k <= 20; ++k) EXPECT_EQ(code_after(flag(k, 2)), -101) << k;
  EXPECT_EQ(code_after(flag(1, -2)), -101);
  EXPECT_EQ(code_after([](DgeldaRun<>& r) { r.n = 0; }), -102);
  EXPECT_EQ(code_after([](DgeldaRun<>& r) { r.n = 1000000; }), -102);
  EXPECT_EQ(code_after(integer(9, 3, 6)), -103);
  EXPECT_EQ(code_after(integer(9, 3, 0), 2), -103);
  EXPECT_EQ(code_after(integer(10, 4, -1)), -104);
  EXPECT_EQ(code_after([](DgeldaRun<>& r) { --r.lrw; }), -105);
  EXPECT_EQ(code_after([](DgeldaRun<>& r) { --r.liw; }), -106);
  EXPECT_EQ(code_after([](DgeldaRun<>& r) { --r.liw; }, 2), -106);
  for (int length : {0, 1, 3, 19, -5}) EXPECT_EQ(code_after([=](DgeldaRun<>& r) { r.liw = length; }), -106) << length;
  EXPECT_EQ(code_after(real(7, 2, 0.0)), -111);
  EXPECT_EQ(code_after(integer(14, 20, 0)), -120);
  EXPECT_EQ(code_after(reals(16, 11, {1.0, 5.0, 0.1})), -121);
  EXPECT_EQ(code_after(reals(16, 11, {0.9, 0.5, 0.1})), -122);
  EXPECT_EQ(code_after(reals(17, 14, {1.5, 2.0})), -123);
  EXPECT_EQ(code_after([](DgeldaRun<>& r) { r.rtol[0] = -1.0; }), -107);
  EXPECT_EQ(code_after([](DgeldaRun<>& r) { r.atol[0] = NAN; }), -108);
  EXPECT_EQ(code_after([](DgeldaRun<>& r) { r.rtol[0] = r.atol[0] = 0.0; }), -109);
  const auto other_method = [](DgeldaRun<>& r) {
    r = DgeldaRun<>(decay(), 2);
    r.method = 3;
  };
  EXPECT_EQ(code_after(other_method), -132);
  EXPECT_EQ(code_after([](DgeldaRun<>& r) { r.t = 1.0; }, 1, 1.0 + 4e-16), -115);
  EXPECT_EQ(code_after([](DgeldaRun<>& r) { r.t = NAN; }), -115);
  EXPECT_EQ(code_after([](DgeldaRun<>& r) {
              r.rtol[0] = 1e-3;
              r.atol[0] = 0.0;
              r.x = {0.0, 0.0};
            }),
            -114);
  EXPECT_EQ(code_after(real(8, 3, -0.1)), -112);
  EXPECT_EQ(code_after(real(8, 3, 0.0)), -113);
  EXPECT_EQ(code_after(real(4, 1, -1.0)), -116);
  EXPECT_EQ(code_after(real(4, 1, 0.5)), -110);
}

TEST(Dgelda, StoresTheLengthNeeded) {
  DgeldaRun run(decay(), 1);
  const int needed = run.lrw;
  run.lrw = 10;
  EXPECT_EQ(run.call(1.0), -105);
  EXPECT_EQ(run.iw(run.liw), needed);
}

TEST_P(Methods, RefuseIllegalContinuations) {
  DgeldaRun run(decay(), GetParam());
  run.x = {0.5, 0.5};
  ASSERT_EQ(run.call(1.0), 3);
  const DgeldaRun good = run;
  EXPECT_EQ(run.call(1.0), -119);
  run = good;
  EXPECT_EQ(run.call(0.5), -112);
  run = good;
  run.set_real(4, 1, 0.5);
  EXPECT_EQ(run.call(2.0), -116);
  run = good;
  run.set_real(4, 1, 1.5);
  if (run.rw(4) <= 1.5) {
    EXPECT_EQ(run.call(2.0), -110);
  }
  // What was illegal leaves the state as it was.
  run.info[0] = 1;
  run.info[3] = 0;
  EXPECT_EQ(run.call(2.0), 3);
  EXPECT_NEAR(run.x[0], decay_exact(2.0), 1e-4);
}

TEST_P(Methods, NeverEvaluateBeyondTheStopPoint) {
  double farthest = 0.0;
  UserData data = decay();
  const auto f = data.f;
  data.f = [&farthest, f](double t, int order, double* values) {
    farthest = std::max(farthest, t);
    return f(t, order, values);
  };
  DgeldaRun run(data, GetParam());
  run.x = {0.5, 0.5};
  run.set_real(4, 1, 1.0);
  run.info[2] = 1;
  while (run.call(1.0) == 1) {
  }
  EXPECT_TRUE(run.ierr == 2 || run.ierr == 3) << run.ierr;
  EXPECT_EQ(run.t, 1.0);
  EXPECT_LE(farthest, 1.0);
}

// Not even for the derivative of a solution that is given by constraints alone.
TEST(Dgelda, EvaluatesNothingBeyondToutWithRadau) {
  for (bool dynamic : {true, false}) {
    UserData data = dynamic ? decay() : document_problem();
    double limit = 0.0;
    const auto f = data.f;
    data.f = [&limit, f](double t, int order, double* values) { return t > limit ? -1 : f(t, order, values); };
    DgeldaRun run(data, 2);
    run.x = {0.5, 0.5};
    for (double tout : {0.1, 0.1 + 1e-9, 0.5, 1.0}) {
      limit = tout;
      ASSERT_EQ(run.call(tout), 3);
      if (!dynamic) {
        EXPECT_NEAR(run.xprime[1], -std::exp(-tout), 1e-9);
      }
    }
  }
}

TEST_P(Methods, GoOnAfterTheLimitOfSteps) {
  DgeldaRun run(decay(), GetParam());
  run.x = {0.5, 0.5};
  run.set_integer(14, 20, 3);
  int calls = 0;
  while (run.call(3.0) == -1 && ++calls < 1000) {
    EXPECT_EQ(run.info[0], -1);
    EXPECT_EQ(run.rw(4), run.t);
    EXPECT_EQ(DgeldaRun(run).call(3.0), -998);
    run.info[0] = 1;
  }
  EXPECT_EQ(run.ierr, 3);
  EXPECT_GT(calls, 1);
  EXPECT_NEAR(run.x[0], decay_exact(3.0), 1e-4);
}

TEST_P(Methods, EnlargeTolerancesThatAreTooSmall) {
  DgeldaRun run(decay(), GetParam());
  run.x = {0.5, 0.5};
  run.rtol[0] = 1e-16;
  run.atol[0] = 0.0;
  ASSERT_EQ(run.call(1.0), -2);
  EXPECT_NEAR(run.rtol[0], 100.0 * std::numeric_limits<double>::epsilon(), 1e-16);
  EXPECT_EQ(run.t, 0.0);
}

TEST_P(Methods, ReportErrorsOfTheFunctions) {
  struct CallbackError {
    double from;
    int order, answer, expected;
  };
  const double nowhere = -1e300;
  for (const CallbackError& error :
       {CallbackError{nowhere, 0, -1, -22}, CallbackError{nowhere, 0, -2, -21}, CallbackError{0.5, 0, -1, -10},
        CallbackError{0.5, 0, 7, -10}, CallbackError{0.5, 0, -2, -21}, CallbackError{0.5, 0, 100, -10},
        CallbackError{nowhere, 0, 100, -22}}) {
    UserData data = decay();
    const auto f = data.f;
    data.f = [&](double t, int order, double* values) {
      f(t, order, values);
      if (t < error.from || order < error.order) return 0;
      if (error.answer < 100) return error.answer;
      values[0] = NAN;
      return 0;
    };
    DgeldaRun run(data, GetParam());
    run.x = {0.5, 0.5};
    EXPECT_EQ(run.call(1.0), error.expected) << error.answer << " from " << error.from;
    EXPECT_EQ(run.info[0], -1);
    EXPECT_LE(run.t, 0.5);
    if (run.t > 0.0) {
      EXPECT_NEAR(run.x[0], decay_exact(run.t), 1e-4);
    }
  }
}

TEST_P(Methods, TellAnIndexAboveTheLimit) {
  DgeldaRun run(document_problem(), GetParam(), 5, 0);
  EXPECT_EQ(run.call(1.0), -22);
  EXPECT_EQ(run.cval[0], -1);
}

// E = diag(1, 1 - t) loses rank at t = 1; behind that, x2 is continued as if nothing had happened unless it is seen.
TEST_P(Methods, ReportAChangeOfCharacteristicValues) {
  UserData data{1, {}, {}, {}};
  data.E = [](double t, int order, double* E) {
    if (order == 0) E[0] = t < 1.0 ? std::pow(1.0 - t, 4) : 0.0;
    return 0;
  };
  data.A = [](double, int order, double* A) {
    if (order == 0) A[0] = -1.0;
    return 0;
  };
  data.f = [](double, int order, double* f) {
    if (order == 0) f[0] = 1.0;
    return 0;
  };
  DgeldaRun run(data, GetParam());
  run.x = {1.0};
  ASSERT_EQ(run.call(2.0), -26);
  EXPECT_EQ(run.cval, (std::vector<std::int32_t>{0, 0, 1, 0}));
  EXPECT_LE(run.t, 1.0);
  EXPECT_NEAR(run.x[0], 1.0, 1e-5);
  EXPECT_TRUE(run.guards_are_intact());
  run.info[0] = 1;
  EXPECT_EQ(run.call(2.0), -26);
}

TEST_P(Methods, StopWhereAWeightVanishes) {
  // x2 = 0 for all t: with atol = 0 its weight is zero after the first step; x2(0) = 1 by INFO(11).
  UserData data{2, {}, {}, {}};
  data.E = [](double, int order, double* E) {
    if (order == 0) E[0] = 1.0;
    return 0;
  };
  data.A = [](double, int order, double* A) {
    if (order == 0) A[0] = -1.0, A[3] = 1.0;
    return 0;
  };
  data.f = [](double, int, double*) { return 0; };
  DgeldaRun run(data, GetParam());
  run.x = {1.0, 1.0};
  run.info[10] = 1;
  run.rtol[0] = 1e-3;
  run.atol[0] = 0.0;
  ASSERT_EQ(run.call(1.0), -3);
  EXPECT_GT(run.t, 0.0);
  EXPECT_LT(run.t, 1.0);
  run.info[0] = 1;
  EXPECT_EQ(run.call(1.0), -3);
  run.info[0] = 1;
  run.atol[0] = 1e-6;
  EXPECT_EQ(run.call(1.0), 3);
  EXPECT_NEAR(run.x[0], std::exp(-1.0), 1e-2);
}

TEST(Dgelda, ChangesTheNullSpaceOfTheDifferentialEquationsOnly) {
  for (int only_null_space : {0, 1}) {
    DgeldaRun run(decay(), 1);
    run.x = {1.0, 5.0};
    run.info[11] = only_null_space;
    ASSERT_EQ(run.call(0.0), 4);
    EXPECT_NEAR(run.x[0], only_null_space == 1 ? 1.0 : 3.0, 1e-14);
    EXPECT_NEAR(run.x[1], only_null_space == 1 ? 1.0 : 3.0, 1e-14);
  }
}

// T = 0 is the right end of the interval: functions exist for t <= 0 only.
TEST(Dgelda, FindsInitialValuesAtEitherEndOfTheInterval) {
  for (int hint : {0, 1, 2}) {
    UserData data = decay();
    const auto f = data.f;
    data.f = [f](double t, int order, double* values) { return t > 0.0 ? -1 : f(t, order, values); };
    DgeldaRun run(data, 1);
    run.x = {0.5, 0.5};
    if (hint == 1) run.set_real(8, 3, -0.01);
    if (hint == 2) run.set_real(4, 1, -1.0);
    ASSERT_EQ(run.call(0.0), 4) << hint;
    ASSERT_EQ(run.call(-1.0), 3) << hint;
    EXPECT_NEAR(run.x[0], decay_exact(-1.0), 1e-4);
  }
}

TEST(Dgelda, TellsIntegersOfAnotherWidth) {
#if defined(__clang__)
#if __has_feature(undefined_behavior_sanitizer)
  GTEST_SKIP() << "functions are called with other INTEGERs than they have, on purpose";
#endif
#endif
  const auto code_of = [](const std::function<void(DgeldaRun<std::int64_t>&)>& change) {
    DgeldaRun<std::int64_t> run(decay(), 1);
    change(run);
    return run.call(1.0);
  };
  constexpr std::int64_t upper = std::int64_t(1) << 32;
  EXPECT_EQ(code_of([](auto& r) { r.n += upper; }), -140);
  EXPECT_EQ(code_of([](auto& r) { r.method += upper; }), -140);
  EXPECT_EQ(code_of([](auto& r) { r.info[4] += upper; }), -140);
  EXPECT_EQ(code_of([](auto& r) { r.liw += upper; }), -140);
  EXPECT_EQ(code_of([](auto&) {}), 3);
  // Functions of 64 bits called with 32.
  DgeldaRun run(decay(), 1);
  const auto f = run.user.f;
  run.user.f = [](double, int, double*) { return 0; };
  const int n = run.n;
  using Narrow = sfdae::f77::VectorFunction<std::int32_t>;
  const auto wide = [](const std::int64_t*, const double*, const std::int64_t*, double*, std::int64_t*, double*,
                       std::int64_t* ierr) { *ierr = 0; };
  void (*wide_function)(const std::int64_t*, const double*, const std::int64_t*, double*, std::int64_t*, double*,
                        std::int64_t*) = wide;
  double tout = 1.0, rpar = 0.0;
  UserData* pointer = &run.user;
  std::memcpy(&rpar, &pointer, sizeof pointer);
  std::int32_t ipar = 0;
  using Functions = sfdae_test::Callbacks<std::int32_t>;
  dgelda_(Functions::edif, Functions::adif, reinterpret_cast<Narrow>(reinterpret_cast<void (*)()>(wide_function)), &n,
          &run.t, &tout, run.x.data(), run.xprime.data(), run.cval.data(), &ipar, &rpar, run.iwork.data(), &run.liw,
          run.rwork.data(), &run.lrw, run.rtol.data(), run.atol.data(), &run.method, run.info.data(), &run.iwarn,
          &run.ierr);
  EXPECT_EQ(run.ierr, -140);
}

// The function behind f asks for derivatives up to mu only, also where the matrices are constant.
TEST_P(Methods, AskForDerivativesUpToMuOnly) {
  for (int constant : {0, 1})
    for (int mu : {0, 1}) {
      UserData data = mu == 0 ? decay() : document_problem();
      if (mu == 1 && constant == 1) continue;
      int highest = 0;
      const auto E = data.E, A = data.A, f = data.f;
      const auto noting = [&highest](const sfdae_test::Values& values) {
        return [&highest, values](double t, int order, double* to) {
          highest = std::max(highest, order);
          return values(t, order, to);
        };
      };
      data.E = noting(E), data.A = noting(A), data.f = noting(f);
      DgeldaRun run(data, GetParam());
      run.info[4] = constant;
      run.x = {0.5, 0.5};
      ASSERT_EQ(run.call(0.0), 4);
      ASSERT_EQ(run.call(1.0), 3);
      EXPECT_EQ(highest, mu) << "constant " << constant;
    }
}
