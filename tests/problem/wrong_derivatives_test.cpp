// SPDX-License-Identifier: BSD-3-Clause
// Derivatives compared with their functions from one side: right ones are never called wrong, whatever the functions
// are like; wrong ones are found, and named.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "problem/derivative_check.h"
#include "problem/failure.h"

namespace sfdae::core {

namespace {

constexpr double pi = 3.141592653589793;

enum class Kind {
  constant,
  sine,
  exponential,
  cubic,
  offset_sine,
  kink,
  stairs,
  sawtooth,
  triangle,
  noisy,
  power,
  tanh_step,
  single_precision,
  wild,
  count
};
constexpr Kind first_rough = Kind::kink;

// A function of t with derivatives of all orders; those from first_rough on have two orders, 0 and 1.
struct TestedFunction {
  Kind kind = Kind::constant;
  double size = 1.0, rate = 1.0, shift = 0.0, small = 0.0;

  double value(double t, int order) const {
    const double s = t - shift;
    switch (kind) {
      case Kind::constant: return order == 0 ? size : 0.0;
      case Kind::sine: return size * std::pow(rate, order) * std::sin(rate * s + order * pi / 2.0);
      case Kind::exponential:
        // Without overflow on the way.
        return -rate * s > 300.0 ? HUGE_VAL : size * std::pow(-rate, order) * std::exp(-rate * s);
      case Kind::cubic: {
        const double r = rate * s,
                     all[] = {1.0 + r + r * r - r * r * r, 1.0 + 2.0 * r - 3.0 * r * r, 2.0 - 6.0 * r, -6.0};
        return order > 3 ? 0.0 : size * std::pow(rate, order) * all[order];
      }
      case Kind::offset_sine:
        return (order == 0 ? size : 0.0) + small * std::pow(rate, order) * std::sin(rate * s + order * pi / 2.0);
      case Kind::kink: return order == 0 ? size * std::fabs(rate * s) : s < 0.0 ? -size * rate : size * rate;
      case Kind::stairs: return order == 0 ? size * std::floor(rate * s) : 0.0;
      case Kind::sawtooth: return order == 0 ? size * (rate * s - std::floor(rate * s)) : size * rate;
      case Kind::triangle: {
        const double phase = rate * s - std::floor(rate * s);
        return order == 0 ? size * std::fabs(phase - 0.5) : phase < 0.5 ? -size * rate : size * rate;
      }
      case Kind::noisy: return order == 0 ? size * (1.0 + rate * s + small * hash(t)) : size * rate;
      case Kind::power: return order == 0 ? size * std::pow(rate * s, 1.5) : size * 1.5 * rate * std::sqrt(rate * s);
      case Kind::tanh_step: {
        const double y = std::tanh(rate * s);
        return order == 0 ? size * y : size * rate * (1.0 - y * y);
      }
      case Kind::single_precision:
        return static_cast<double>(static_cast<float>(order == 0 ? std::sin(rate * s) : rate * std::cos(rate * s)));
      case Kind::wild: {  // s^2 sin(1/s), whose derivative is not continuous at 0
        const double r = rate * s;
        if (r == 0.0) return 0.0;
        return order == 0 ? size * r * r * std::sin(1.0 / r)
                          : size * rate * (2.0 * r * std::sin(1.0 / r) - std::cos(1.0 / r));
      }
      default: return 0.0;
    }
  }

  static double hash(double t) {
    std::uint64_t bits;
    std::memcpy(&bits, &t, sizeof bits);
    bits = (bits ^ (bits >> 31)) * 0x9e3779b97f4a7c15u;
    bits = (bits ^ (bits >> 29)) * 0xbf58476d1ce4e5b9u;
    return static_cast<double>(bits >> 11) * 0x1p-52 - 1.0;
  }
};

struct Mistake {
  char function = 0;
  int order = 0, entry = 0;
  double factor = 1.0, offset = 0.0;
};

constexpr int n = 3;

struct TestProblem {
  double t0 = 0.0, span = 1.0;
  bool backward = false;
  int highest = 1;
  TestedFunction E[n * n], A[n * n], f[n];
  Mistake mistake;

  double toward() const { return backward ? t0 - span : t0 + span; }
  const TestedFunction& entry(char which, int i) const { return which == 'E' ? E[i] : which == 'A' ? A[i] : f[i]; }

  int write(char which, double t, int order, double* values) const {
    if (order > highest) return SFDAE_ORDER_NOT_AVAILABLE;
    // One-sided: nothing is defined on the other side of t0, nor at or beyond the end.
    const double along = backward ? t0 - t : t - t0;
    EXPECT_GE(along, 0.0);
    if (along < 0.0 || along > span) return 1;
    for (int i = 0; i < (which == 'f' ? n : n * n); ++i) {
      values[i] = entry(which, i).value(t, order);
      if (which == mistake.function && order == mistake.order && i == mistake.entry)
        values[i] = mistake.factor * values[i] + mistake.offset;
    }
    return 0;
  }

  template <char which>
  static int callback(double t, int order, double* values, void* user) {
    return static_cast<const TestProblem*>(user)->write(which, t, order, values);
  }
  LinearFunctions functions() {
    return {.m = n,
            .n = n,
            .E = callback<'E'>,
            .A = callback<'A'>,
            .f = callback<'f'>,
            .user = this,
            .inputs = {},
            .names = {}};
  }
};

class Random {
 public:
  explicit Random(unsigned seed) : generator_(seed) {}
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(generator_); }
  double power(double low, double high) { return std::pow(10.0, uniform(low, high)); }
  int below(int count) { return std::uniform_int_distribution<int>(0, count - 1)(generator_); }

 private:
  std::mt19937 generator_;
};

// rates: of functions, in 1 / span, powers of ten.
TestedFunction random_entry(Random& random, const TestProblem& problem, Kind kind, double low, double high) {
  TestedFunction entry;
  entry.kind = kind;
  entry.size = random.power(-12.0, 12.0) * (random.below(2) == 0 ? 1.0 : -1.0);
  entry.rate = random.power(low, high) / problem.span * (problem.backward && kind == Kind::power ? -1.0 : 1.0);
  entry.shift = problem.t0;
  const double direction = problem.backward ? -1.0 : 1.0;
  if (kind == Kind::kink || kind == Kind::stairs || kind == Kind::tanh_step || kind == Kind::wild)
    entry.shift += random.below(3) == 0 ? 0.0 : direction * problem.span * random.power(-12.0, 0.0);
  if (kind == Kind::sine || kind == Kind::sawtooth || kind == Kind::triangle || kind == Kind::single_precision)
    entry.shift += problem.span * random.uniform(-1.0, 1.0);
  // Steps that a derivative of zero ignores are noise where they are small.
  entry.small = kind == Kind::noisy ? random.power(-17.0, -1.0) : entry.size * random.power(-15.0, 0.0);
  return entry;
}

TestProblem random_problem(Random& random, bool smooth, double low, double high) {
  TestProblem problem;
  problem.span = random.power(-12.0, 12.0);
  const int place = random.below(4);
  problem.t0 = place == 0 ? 0.0 : problem.span * (place == 1 ? random.uniform(-3.0, 3.0) : random.power(-3.0, 6.0));
  problem.backward = random.below(4) == 0;
  problem.highest = smooth ? 1 + random.below(4) : 1;
  const auto fill = [&](TestedFunction& entry) {
    const int kinds = static_cast<int>(smooth ? first_rough : Kind::count);
    entry = random_entry(random, problem, static_cast<Kind>(random.below(kinds)), low, high);
  };
  for (TestedFunction& entry : problem.E) fill(entry);
  for (TestedFunction& entry : problem.A) fill(entry);
  for (TestedFunction& entry : problem.f) fill(entry);
  return problem;
}

// What is said of the problem; empty if nothing is.
std::string verdict(TestProblem& problem) {
  LinearProblem linear(problem.functions());
  try {
    demand_derivatives(linear, problem.t0, problem.toward(), problem.highest);
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.status(), SFDAE_WRONG_DERIVATIVES);
    return failure.what();
  }
  return "";
}

std::string describe(const TestProblem& problem, const std::string& what) {
  std::string text = what + "\n t0 " + format("%.17g", problem.t0) + " span " + format("%.17g", problem.span);
  for (const char which : {'E', 'A', 'f'})
    for (int i = 0; i < (which == 'f' ? n : n * n); ++i) {
      const TestedFunction& e = problem.entry(which, i);
      text += format("\n  %c %d: kind %d, size %g, rate %g / span, shift %g span, small %g", which, i,
                     static_cast<int>(e.kind), e.size, e.rate * problem.span, (e.shift - problem.t0) / problem.span,
                     e.small);
    }
  return text;
}

void expect_silence(bool smooth, double low, double high, int count, unsigned seed) {
  Random random(seed);
  for (int i = 0; i < count; ++i) {
    TestProblem problem = random_problem(random, smooth, low, high);
    const std::string said = verdict(problem);
    ASSERT_EQ(said, "") << describe(problem, "problem " + std::to_string(i));
  }
}

int count_by_environment(int count) {
  const char* scale = std::getenv("SFDAE_TEST_WRONG_DERIVATIVES");
  return scale != nullptr ? static_cast<int>(count * std::atof(scale)) : count;
}

}  // namespace

TEST(WrongDerivatives, AreNotSeenInRightOnesOfSmoothFunctions) {
  expect_silence(true, -3.0, 3.0, count_by_environment(1500), 1);
}

TEST(WrongDerivatives, AreNotSeenInFunctionsOfAnySpeed) {
  expect_silence(true, -9.0, 9.0, count_by_environment(1500), 2);
}

TEST(WrongDerivatives, AreNotSeenInKinksJumpsAndNoise) {
  expect_silence(false, -3.0, 6.0, count_by_environment(1500), 3);
}

TEST(WrongDerivatives, AreFoundInSmoothFunctions) {
  Random random(4);
  int tried = 0, found = 0, misnamed = 0;
  const int count = count_by_environment(1500);
  for (int i = 0; i < count; ++i) {
    TestProblem problem = random_problem(random, true, -2.0, 3.0);
    Mistake& m = problem.mistake;
    m.function = "EAf"[random.below(3)];
    m.order = 1 + random.below(problem.highest);
    m.entry = random.below(m.function == 'f' ? n : n * n);
    const TestedFunction& entry = problem.entry(m.function, m.entry);
    const double right = entry.value(problem.t0, m.order);
    switch (random.below(5)) {
      case 0: m.factor = -1.0; break;                               // a sign
      case 1: m.factor = random.below(2) == 0 ? 2.0 : 0.5; break;   // a factor
      case 2: m.factor = 0.0; break;                                // forgotten
      case 3: m.factor = 1.0 / (entry.rate * problem.span); break;  // an inner derivative
      default:                                                      // the order ignored
        m.factor = 0.0;
        m.offset = entry.value(problem.t0, m.order - 1);
    }
    const double wrong = m.factor * right + m.offset;
    // No mistake, or one that cannot be told from rounding errors of the function itself.
    if (std::fabs(wrong - right) <= 0.05 * std::max(std::fabs(wrong), std::fabs(right))) continue;
    const double change_by_it = std::fabs(wrong - right) * problem.span;
    if (change_by_it < 1e-6 * std::fabs(entry.value(problem.t0, m.order - 1))) continue;
    ++tried;
    const std::string said = verdict(problem);
    if (said.empty()) continue;
    ++found;
    const std::string name = format("derivative %d of %c contradicts differences in row %d, column %d", m.order,
                                    m.function, m.entry % n, m.entry / n);
    // Where the order itself is seen too badly, that above contradicts it.
    if (said.find(name) == std::string::npos) ++misnamed;
  }
  RecordProperty("tried", tried);
  RecordProperty("found", found);
  printf("%d of %d mistakes found, %d of them at another place\n", found, tried, misnamed);
  EXPECT_GE(tried, count / 2);
  EXPECT_GE(found, 0.98 * tried);
  EXPECT_LE(misnamed, 0.01 * tried);
}

// The commonest mistake: the function itself, whatever the order.
TEST(WrongDerivatives, AreFoundWhereTheOrderIsIgnored) {
  struct Ignoring {
    bool varies;
    static int E(double t, int, double* values, void* user) {
      for (int i = 0; i < n; ++i)
        values[i * (n + 1)] = static_cast<Ignoring*>(user)->varies ? 2.0 + std::sin(t) : 1.0;
      return 0;
    }
    static int A(double, int order, double* values, void*) {
      for (int i = 0; i < n && order == 0; ++i) values[i * (n + 1)] = -1.0;
      return 0;
    }
  };
  for (const double span : {1e-9, 1.0, 1e3})
    for (const bool varies : {false, true}) {
      Ignoring user{varies};
      LinearProblem problem(
          {.m = n, .n = n, .E = Ignoring::E, .A = Ignoring::A, .user = &user, .inputs = {}, .names = {}});
      try {
        demand_derivatives(problem, 0.5, 0.5 + span, 1);
        ADD_FAILURE() << span << varies;
      } catch (const Failure& failure) {
        EXPECT_EQ(failure.status(), SFDAE_WRONG_DERIVATIVES);
        EXPECT_NE(std::string(failure.what()).find("derivative 1 of E"), std::string::npos) << failure.what();
      }
    }
}

// What only the check evaluates may fail, but a callback that wants to stop is obeyed.
TEST(WrongDerivatives, LeaveFailuresOfCallbacksAlone) {
  struct Failing {
    int code;
    static int E(double t, int, double* values, void* user) {
      values[0] = 1.0;  // wrong for order 1
      return t > 0.5 ? static_cast<Failing*>(user)->code : 0;
    }
    static int A(double, int, double*, void*) { return 0; }
  };
  for (const int code : {1, -1}) {
    Failing user{code};
    LinearProblem problem(
        {.m = 1, .n = 1, .E = Failing::E, .A = Failing::A, .user = &user, .inputs = {}, .names = {}});
    int status = SFDAE_OK;
    try {
      demand_derivatives(problem, 0.5, 1.0, 1);
    } catch (const Failure& failure) {
      status = failure.status();
    }
    EXPECT_EQ(status, code > 0 ? SFDAE_OK : SFDAE_CALLBACK_STOPPED);
    EXPECT_EQ(problem.evaluations('E'), 0);
    EXPECT_GT(problem.check_evaluations(), 0);
  }
}

}  // namespace sfdae::core
