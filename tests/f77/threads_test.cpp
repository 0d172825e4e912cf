// DGELDA in several threads, for both widths of INTEGER and under all its names.
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "dgelda_family_run.h"

namespace {

using namespace sfdae_test;

// The result of one run in the caller's arrays: IERR and T, X, XPRIME, the counters.
struct Outcome {
  int ierr = 0;
  std::vector<double> numbers;
  std::vector<long> counters;

  bool operator==(const Outcome& other) const {
    return ierr == other.ierr && counters == other.counters && numbers.size() == other.numbers.size() &&
           std::memcmp(numbers.data(), other.numbers.data(), numbers.size() * sizeof(double)) == 0;
  }
};

template <class Integer>
Outcome solve(const std::shared_ptr<const LinearFamily>& family, int method,
              DgeldaFunction<Integer>* entry = dgelda_entry<Integer>()) {
  DgeldaFamily<Integer> functions(family);
  Dgelda<Integer> call = functions.arguments(method);
  call.entry = entry;
  Outcome outcome;
  for (double tout : {0.3, 0.7, 1.0}) {
    outcome.ierr = call.call(tout);
    outcome.numbers.push_back(call.t);
    for (int i = 1; i <= family->n(); ++i) {
      outcome.numbers.push_back(call.x(i));
      outcome.numbers.push_back(call.xprime(i));
    }
    for (int i : {11, 12, 13, 14}) outcome.counters.push_back(static_cast<long>(call.iwork(i)));
    for (int i = 1; i <= 4; ++i) outcome.counters.push_back(static_cast<long>(call.cval(i)));
  }
  EXPECT_EQ(functions.wrong_arguments, 0);
  EXPECT_TRUE(call.guards_intact());
  return outcome;
}

std::vector<std::shared_ptr<const LinearFamily>> problems() {
  std::vector<std::shared_ptr<const LinearFamily>> all;
  for (int mu = 0; mu <= 3; ++mu) all.push_back(kron(8, mu, 0.5));
  all.push_back(kron(7, 1, 0.5, 1));
  all.push_back(chain(4, 1));
  return all;
}

class DgeldaEntries : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Methods, DgeldaEntries, testing::Values(1, 2), method_name);

TEST_P(DgeldaEntries, ThreadsGetTheBitsOfASingleOne) {
  const auto families = problems();
  std::vector<Outcome> alone;
  for (const auto& family : families) alone.push_back(solve<std::int32_t>(family, GetParam()));
  for (const Outcome& outcome : alone) EXPECT_EQ(outcome.ierr, 3);

  constexpr std::size_t copies = 4;
  std::vector<Outcome> together(copies * families.size());
  std::vector<std::thread> threads;
  for (std::size_t k = 0; k < together.size(); ++k)
    threads.emplace_back([&, k] { together[k] = solve<std::int32_t>(families[k % families.size()], GetParam()); });
  for (std::thread& thread : threads) thread.join();
  for (std::size_t k = 0; k < together.size(); ++k) EXPECT_EQ(together[k], alone[k % families.size()]) << k;
}

TEST_P(DgeldaEntries, IntegersOf64BitsGiveTheSameBits) {
  for (const auto& family : problems()) {
    SCOPED_TRACE(family->name());
    const Outcome narrow = solve<std::int32_t>(family, GetParam());
    EXPECT_EQ(narrow.ierr, 3);
    EXPECT_EQ(solve<std::int64_t>(family, GetParam()), narrow);
  }
}

TEST_P(DgeldaEntries, SecondUnderscoreIsTheSameEntry) {
  const std::shared_ptr<const LinearFamily> family = kron(6, 1, 0.5);
  const Outcome outcome = solve<std::int64_t>(family, GetParam());
  EXPECT_EQ(outcome.ierr, 3);
  EXPECT_EQ(solve<std::int64_t>(family, GetParam(), dgelda_64__), outcome);
}

// ---- Callbacks compiled for the other width: x' = -x ---------------------------------------------------------

// Writes IERR with the width Written, whatever the entry hands over.
template <class Integer, class Written>
struct Decay {
  static Written code;
  static void store(Integer* ierr) { std::memcpy(static_cast<void*>(ierr), &code, sizeof code); }
  static void edif(const Integer*, const double*, const Integer* idif, double* values, const Integer*, Integer*,
                   double*, Integer* ierr) {
    values[0] = *idif == 0 ? 1.0 : 0.0;
    store(ierr);
  }
  static void adif(const Integer*, const double*, const Integer* idif, double* values, const Integer*, Integer*,
                   double*, Integer* ierr) {
    values[0] = *idif == 0 ? -1.0 : 0.0;
    store(ierr);
  }
  static void fdif(const Integer*, const double*, const Integer*, double* values, Integer*, double*, Integer* ierr) {
    values[0] = 0.0;
    store(ierr);
  }
  static Dgelda<Integer> arguments(int method, Written returned) {
    code = returned;
    Dgelda<Integer> call(1, method);
    call.functions(edif, adif, fdif);
    call.x(1) = 1.0;
    return call;
  }
};
template <class Integer, class Written>
Written Decay<Integer, Written>::code = 0;

constexpr int wrong_width = -140;

TEST_P(DgeldaEntries, FunctionsOfTheRightWidthAreNotSuspected) {
  auto narrow = Decay<std::int32_t, std::int32_t>::arguments(GetParam(), 0);
  EXPECT_EQ(narrow.call(1.0), 3);
  EXPECT_LE(std::fabs(narrow.x(1) - std::exp(-1.0)), 10.0 * 1e-6 * (std::exp(-1.0) + 1.0));
  auto wide = Decay<std::int64_t, std::int64_t>::arguments(GetParam(), 0);
  EXPECT_EQ(wide.call(1.0), 3);
  EXPECT_EQ(wide.x(1), narrow.x(1));
}

TEST_P(DgeldaEntries, FunctionsThatWrite64BitsToTheNarrowEntryAreNoticed) {
  for (std::int64_t code : {0, -1, -2}) {
    auto call = Decay<std::int32_t, std::int64_t>::arguments(GetParam(), code);
    EXPECT_EQ(call.call(1.0), wrong_width) << code;
    EXPECT_EQ(call.info(1), -1);
    EXPECT_TRUE(call.guards_intact());
  }
}

// A zero of 32 bits leaves no trace in a zero of 64; a negative number does.
TEST_P(DgeldaEntries, FunctionsThatWrite32BitsToTheWideEntryAreNoticedWhenTheyFail) {
  auto unnoticed = Decay<std::int64_t, std::int32_t>::arguments(GetParam(), 0);
  EXPECT_EQ(unnoticed.call(1.0), 3);
  for (std::int32_t code : {-1, -2}) {
    auto call = Decay<std::int64_t, std::int32_t>::arguments(GetParam(), code);
    EXPECT_EQ(call.call(1.0), wrong_width) << code;
    EXPECT_EQ(call.info(1), -1);
  }
}

// ---- All arguments of the other width ------------------------------------------------------------------------

// Every INTEGER followed by words that make it no number of 64 bits that could be meant.
TEST_P(DgeldaEntries, ACallerOf32BitsAtTheWideEntryIsNoticed) {
  struct Words {
    std::int32_t value[2];
    explicit Words(std::int32_t first) : value{first, 12345} {}
    std::int64_t* address() { return reinterpret_cast<std::int64_t*>(value); }
  };
  using Functions = Decay<std::int64_t, std::int64_t>;
  alignas(8) Words neq(1), method(GetParam());
  std::vector<std::int64_t> iwork(60, 0), info(20, 0), cval(4, 0);
  std::vector<double> rwork(1000, 0.0);
  double t = 0.0, tout = 1.0, x = 1.0, xprime = 0.0, tol = 1e-6;
  std::int64_t liw = 60, lrw = 1000, iwarn = 0;
  Words ierr(0);
  dgelda_64_(Functions::edif, Functions::adif, Functions::fdif, neq.address(), &t, &tout, &x, &xprime, cval.data(),
             nullptr, nullptr, iwork.data(), &liw, rwork.data(), &lrw, &tol, &tol, method.address(), info.data(),
             &iwarn, ierr.address());
  EXPECT_EQ(ierr.value[0], wrong_width);
  EXPECT_EQ(ierr.value[1], 12345);  // belongs to somebody else
  EXPECT_EQ(t, 0.0);
  EXPECT_EQ(x, 1.0);
}

// ---- From within user functions ------------------------------------------------------------------------------

// x' = -x, whose FDIF solves another problem by DGELDA.
TEST_P(DgeldaEntries, UserFunctionsMaySolveProblemsThemselves) {
  using Plain = Decay<std::int32_t, std::int32_t>;
  static int method;
  method = GetParam();
  const auto nesting = [](const std::int32_t* n, const double* at, const std::int32_t* idif, double* values,
                          std::int32_t* ipar, double* rpar, std::int32_t* ierr) {
    auto inner = Plain::arguments(method, 0);
    if (inner.call(0.5) != 3) *ierr = -2;
    else Plain::fdif(n, at, idif, values, ipar, rpar, ierr);
  };
  auto plain = Plain::arguments(method, 0), outer = Plain::arguments(method, 0);
  outer.fdif = nesting;
  EXPECT_EQ(plain.call(1.0), 3);
  EXPECT_EQ(outer.call(1.0), 3);
  EXPECT_EQ(outer.x(1), plain.x(1));
}

}  // namespace
