// SPDX-License-Identifier: BSD-3-Clause
// The search for zeros, apart from any integration: functions with known zeros, rough values that are off, rounding
// errors.
#include "watch/event_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

using namespace sfdae::core;

namespace {

using Vector = std::vector<double>;
using Functions = std::function<void(double, Vector&)>;

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double pi = 3.14159265358979323846;

// Exact values, and rough ones from another function.
class Known final : public EventValues {
 public:
  Known(int count, Functions exact, Functions rough = nullptr)
      : exact_(std::move(exact)), rough_(std::move(rough)), g_(static_cast<std::size_t>(count)) {}

  bool approximate(double t, double* g) override {
    if (!rough_) return false;
    Vector values(g_.size());
    rough_(t, values);
    std::copy(values.begin(), values.end(), g);
    return true;
  }
  void determine(double t, bool, double* g) override {
    ++calls;
    if (t >= fails_from) throw 1;
    exact_(t, g_);
    std::copy(g_.begin(), g_.end(), g);
    determined_ = t;
  }
  void rounding(double* noise) override { std::fill_n(noise, g_.size(), noise_level); }
  void keep() override { candidate_ = determined_; }
  void accept() override { accepted = candidate_; }

  int calls = 0;
  double noise_level = 0.0;
  double fails_from = std::numeric_limits<double>::infinity();
  double accepted = std::numeric_limits<double>::quiet_NaN();

 private:
  Functions exact_, rough_;
  Vector g_;
  double determined_ = 0.0, candidate_ = 0.0;
};

// All events from the start to the end, in steps.
struct Found {
  double t;
  std::vector<int> fired;
};
std::vector<Found> find_all(EventSearch& search, Known& values, double start, double end, int steps) {
  search.start(values, start, 100 * epsilon * std::fabs(end - start));
  std::vector<Found> found;
  for (int i = 1; i <= steps; ++i) {
    const double to = start + (end - start) * i / steps;
    while (search.search(values, to, 3)) {
      EXPECT_EQ(values.accepted, search.t());
      found.push_back({search.t(), search.fired()});
      if (found.size() > 1000) return found;
    }
    EXPECT_EQ(search.t(), to);
    EXPECT_EQ(values.accepted, to);
  }
  return found;
}

// ---- ZeroBracket ----

// Evaluations until the bracket of a function that is positive at a and not at b is resolved; its zero.
std::pair<int, double> resolve(const std::function<double(double)>& g, double a, double b) {
  ZeroBracket bracket;
  bracket.resize(1);
  bracket.start({1}, a, {g(a)}, b, {g(b)});
  int count = 0;
  while (!bracket.is_resolved() && count < 500) {
    const double t = bracket.next();
    if (t == bracket.before() || t == bracket.after()) break;
    EXPECT_TRUE((t - bracket.before()) * (bracket.after() - t) > 0.0);
    const bool lost = bracket.place(t, {g(t)});
    EXPECT_EQ(lost, g(t) <= 0.0);
    ++count;
  }
  EXPECT_GT(g(bracket.before()), 0.0);
  EXPECT_LE(g(bracket.after()), 0.0);
  return {count, bracket.after()};
}

TEST(ZeroBracket, ResolvesZerosToRoundingInFewEvaluations) {
  const struct {
    std::function<double(double)> g;
    double a, b, zero;
    int most;
  } cases[] = {
      {[](double t) { return 0.3 - t; }, 0.0, 1.0, 0.3, 5},
      {[](double t) { return 0.3 - t; }, 1e-9, 1e9, 0.3, 5},
      {[](double t) { return t + 0.3; }, 1.0, -1.0, -0.3, 5},  // backward
      {[](double t) { return std::cos(t); }, 0.0, 3.0, pi / 2, 10},
      {[](double t) { return std::exp(-t) - 1e-3; }, 0.0, 50.0, std::log(1e3), 40},
      {[](double t) { return std::pow(2.0 - t, 9); }, 0.0, 3.1, 2.0, 120},  // of ninth order
      {[](double t) { return t < 0.7 ? 1.0 : -1e-9; }, 0.0, 1.0, 0.7, 70},  // jumps
      {[](double t) { return t < 0.7 ? 1e-9 : -1.0; }, 0.0, 1.0, 0.7, 70},
      {[](double t) { return std::max(0.0, 0.7 - t); }, 0.0, 1.0, 0.7, 70},  // stays zero
      {[](double t) { return 1e-300 * (0.3 - t); }, 0.0, 1.0, 0.3, 5},
      {[](double t) { return -1e300 * t; }, -1.0, 1.0, 0.0, 60},  // at t = 0
  };
  for (const auto& c : cases) {
    const auto [count, zero] = resolve(c.g, c.a, c.b);
    EXPECT_LE(count, c.most) << c.zero;
    EXPECT_NEAR(zero, c.zero, 4 * epsilon * std::fabs(c.zero) + 1e-6 * epsilon * std::fabs(c.b - c.a)) << count;
  }
}

TEST(ZeroBracket, NeedsNoMoreThanAFewTimesBisectionEver) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int i = 0; i < 2000; ++i) {
    const double zero = uniform(random), power = std::exp(6 * uniform(random) - 3),
                 left = std::exp(40 * uniform(random) - 20);
    const auto g = [&](double t) {
      const double value = std::pow(std::fabs(t - zero), power);
      return t < zero ? left * value : t > zero ? -value : 0.0;
    };
    if (!(g(0.0) > 0.0)) continue;
    const auto [count, found] = resolve(g, 0.0, 1.0);
    EXPECT_LE(count, 160) << power << " " << left;
    // Where g underflows there is no better zero.
    if (power < 5) {
      EXPECT_NEAR(found, zero, 4 * epsilon * zero + 1e-6 * epsilon);
    }
  }
}

// ---- EventSearch ----

TEST(EventSearch, FindsZerosInOrderWithTheirDirections) {
  for (double direction : {1.0, -1.0}) {
    Known values(2, [=](double t, Vector& g) { g[0] = std::sin(t), g[1] = direction * t - 4.0; });
    EventSearch search({0, 0});
    const auto found = find_all(search, values, direction * 0.5, direction * 10.0, 7);
    ASSERT_EQ(found.size(), 4u);
    const double expected[] = {pi, 4.0, 2 * pi, 3 * pi};
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(direction * found[i].t, expected[i], 4 * epsilon * expected[i]);
    // In the direction of integration: sin falls at pi and, backward, rises at -pi.
    EXPECT_EQ(found[0].fired, (std::vector<int>{direction > 0 ? -1 : 1, 0}));
    EXPECT_EQ(found[1].fired, (std::vector<int>{0, 1}));
    EXPECT_EQ(found[2].fired, (std::vector<int>{direction > 0 ? 1 : -1, 0}));
  }
}

TEST(EventSearch, LooksAtTheDirectionsAskedFor) {
  for (int direction : {-1, 0, 1}) {
    Known values(1, [](double t, Vector& g) { g[0] = std::sin(t); });
    EventSearch search({direction});
    EXPECT_EQ(find_all(search, values, 0.5, 20.0, 9).size(), direction == 0 ? 6u : 3u);
  }
}

/// Zeros at 0.3 and 0.3 + w: three points of a parabola show that it dips, however narrow.
TEST(EventSearch, FindsTwoZerosBetweenTwoPoints) {
  for (double width : {0.1, 1e-2, 1e-3})
    for (double scale : {1.0, 1e-200, 1e200})
      for (double start : {0.0, 0.29999}) {
        Known values(1, [=](double t, Vector& g) { g[0] = scale * (t - 0.3) * (t - 0.3 - width); });
        EventSearch search({0});
        const auto found = find_all(search, values, start, 2.0, 1);
        ASSERT_EQ(found.size(), 2u) << width << " " << scale;
        EXPECT_NEAR(found[0].t, 0.3, 4 * epsilon);
        EXPECT_NEAR(found[1].t, 0.3 + width, 1e-13);
      }
}

TEST(EventSearch, IsSilentWhereNothingHappens) {
  const Functions silent[] = {
      [](double, Vector& g) { g[0] = 0.0; },                         // always zero
      [](double t, Vector& g) { g[0] = t <= 1.0 ? 0.0 : t - 1.0; },  // leaves zero
      [](double t, Vector& g) { g[0] = t; },                         // zero at the start
      [](double t, Vector& g) { g[0] = t - 1e-17; },                 // but for rounding errors
      [](double t, Vector& g) { g[0] = (t - 0.3) * (t - 0.3) + 1e-12; },
      [](double t, Vector& g) { g[0] = 1.0 / (1.0 + t); },
  };
  for (const Functions& g : silent) {
    Known values(1, g);
    EventSearch search({0});
    EXPECT_EQ(find_all(search, values, 0.0, 2.0, 5).size(), 0u);
    EXPECT_LE(values.calls, 400);
  }
}

TEST(EventSearch, FiresOnceWhereAFunctionBecomesZeroAndStays) {
  Known values(1, [](double t, Vector& g) { g[0] = std::max(0.0, 0.7 - t); });
  EventSearch search({0});
  const auto found = find_all(search, values, 0.0, 2.0, 5);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].t, 0.7, 4 * epsilon);
  EXPECT_EQ(found[0].fired[0], -1);
}

TEST(EventSearch, IsSilentAboutRoundingErrors) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> noise(-1e-16, 1e-16);
  Known values(2, [&](double t, Vector& g) {
    g[0] = noise(random);
    g[1] = std::max(0.0, 0.7 - t) + noise(random);
  });
  values.noise_level = 4e-16;
  EventSearch search({0, 0});
  const auto found = find_all(search, values, 0.0, 20.0, 50);
  // Where errors take over, one of them, not positive, at a point looked at.
  ASSERT_EQ(found.size(), 1u);
  EXPECT_GE(found[0].t, 0.7 - 1e-15);
  EXPECT_LE(found[0].t, 0.7 + 0.1);
}

TEST(EventSearch, JumpsAreEvents) {
  Known values(1, [](double t, Vector& g) { g[0] = std::fmod(t, 1.0) < 0.5 ? 1.0 : -1.0; });
  EventSearch search({0});
  const auto found = find_all(search, values, 0.1, 3.1, 3);
  ASSERT_EQ(found.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(found[i].t, 0.5 * static_cast<double>(i + 1), 8 * epsilon);
}

TEST(EventSearch, PutsTogetherWhatHappensAtOnce) {
  Known values(4, [](double t, Vector& g) {
    g[0] = t - 0.3, g[1] = 0.1 - t / 3.0, g[2] = 1e6 * (t - 0.3) * (1.0 + 2 * epsilon), g[3] = t - 0.3 - 1e-9;
  });
  EventSearch search({0, 0, 0, 0});
  const auto found = find_all(search, values, 0.0, 1.0, 1);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].fired, (std::vector<int>{1, -1, 1, 0}));
  EXPECT_EQ(found[1].fired, (std::vector<int>{0, 0, 0, 1}));
}

/// At the end of a search is inside; at its start it was the last one's.
TEST(EventSearch, EndsBelongToTheSearch) {
  Known values(1, [](double t, Vector& g) { g[0] = t - 1.0; });
  EventSearch search({0});
  const auto found = find_all(search, values, 0.0, 2.0, 2);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].t, 1.0);
}

/// The rough values are off by 1e-6: events are those of the exact ones, none twice, and few evaluations are exact.
TEST(EventSearch, RoughValuesLeadButDoNotDecide) {
  for (double offset : {1e-6, -1e-6, 1e-3, -1e-3}) {
    Known values(
        1, [](double t, Vector& g) { g[0] = std::sin(t); },
        [=](double t, Vector& g) { g[0] = std::sin(t) + offset * std::cos(30 * t); });
    EventSearch search({0});
    const auto found = find_all(search, values, 0.5, 20.0, 40);
    ASSERT_EQ(found.size(), 6u) << offset;
    for (std::size_t i = 0; i < 6; ++i) {
      const double zero = pi * static_cast<double>(i + 1);
      EXPECT_NEAR(found[i].t, zero, 4 * epsilon * zero);
      EXPECT_LE(std::fabs(std::sin(found[i].t)), 4 * epsilon * zero);
    }
    EXPECT_LE(values.calls, 40 + 6 * 20);
  }
}

/// Rough values that show a zero where there is none, or do not know anything.
TEST(EventSearch, FalseAlarmsAreHarmless) {
  Known values(
      1, [](double t, Vector& g) { g[0] = 1e-4 + (t - 0.3) * (t - 0.3); },
      [](double t, Vector& g) { g[0] = -1e-4 + (t - 0.3) * (t - 0.3); });
  EventSearch search({0});
  EXPECT_EQ(find_all(search, values, 0.0, 1.0, 2).size(), 0u);

  Known stupid(
      1, [](double t, Vector& g) { g[0] = t - 0.3; }, [](double, Vector& g) { g[0] = 1.0; });
  EventSearch second({0});
  EXPECT_EQ(find_all(second, stupid, 0.0, 1.0, 1).size(), 1u);
}

/// A hump after a restart at an event, small in comparison with the step, like that of a ball.
TEST(EventSearch, AFunctionThatFiredIsArmedByWhatFollows) {
  for (double residue : {0.0, 1e-16, -1e-16}) {
    double since = 0.0, speed = 0.0;
    const auto g = [&](double t, Vector& values) {
      const double s = t - since;
      values[0] = speed == 0.0 ? 1.0 - 0.5 * t * t : residue + speed * s - 0.5 * s * s;
    };
    Known values(1, g, g);
    EventSearch search({-1});
    search.start(values, 0.0, 1e-14);
    ASSERT_TRUE(search.search(values, 3.0, 2));
    EXPECT_NEAR(search.t(), std::sqrt(2.0), 8 * epsilon);
    for (speed = 1.0; speed > 1e-2; speed *= 0.7) {
      since = search.t();
      search.reset();
      search.start(values, since, 1e-14);
      ASSERT_TRUE(search.search(values, since + 4.0, 2)) << speed << " " << residue;
      EXPECT_NEAR(search.t(), since + 2 * speed, 1e-12);
    }
  }
}

/// Restarted at the event with quite another value: that arms, be it large or small, of whatever sign.
TEST(EventSearch, AFunctionThatWasChangedAtItsEventIsArmed) {
  for (double level : {1e-3, 1.0, 1e3, -1e-3, -1.0, -1e3}) {
    double start = 0.0, shift = 0.0;
    Known values(1, [&](double t, Vector& g) { g[0] = shift == 0.0 ? 1.0 - t : shift * (1.0 - (t - start)); });
    EventSearch search({0});
    search.start(values, 0.0, 1e-14);
    ASSERT_TRUE(search.search(values, 3.0, 2));
    shift = level;
    start = search.t();
    search.reset();
    search.start(values, start, 1e-14);
    ASSERT_TRUE(search.search(values, start + 3.0, 2)) << level;
    EXPECT_NEAR(search.t(), start + 1.0, 4 * epsilon);
    EXPECT_EQ(search.fired()[0], level > 0.0 ? -1 : 1);
  }
}

TEST(EventSearch, FailuresLeaveThePointSearchedLast) {
  Known values(1, [](double t, Vector& g) { g[0] = std::sin(t); });
  EventSearch search({0});
  search.start(values, 0.5, 0.0);
  values.fails_from = 6.0;
  EXPECT_TRUE(search.search(values, 5.0, 3));
  EXPECT_FALSE(search.search(values, 5.0, 3));
  EXPECT_THROW(search.search(values, 7.0, 3), int);
  EXPECT_EQ(search.t(), 5.0);
  values.fails_from = 100.0;
  EXPECT_TRUE(search.search(values, 7.0, 3));
  EXPECT_NEAR(search.t(), 2 * pi, 8 * epsilon * pi);
}

/// Sums of sines with up to ten zeros in an interval: all of them are found that a fine grid finds, but for pairs
/// that are closer than the grid.
TEST(EventSearch, MissesNothingThatMattersInRandomFunctions) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  int missed = 0, total = 0;
  for (int run = 0; run < 300; ++run) {
    double a[5], phase[5];
    for (int k = 0; k < 5; ++k) a[k] = normal(random), phase[k] = 3 * normal(random);
    const double level = 0.5 * normal(random);
    const auto g = [&](double t, Vector& values) {
      values[0] = -level;
      for (int k = 0; k < 5; ++k) values[0] += a[k] * std::sin((k + 1) * t + phase[k]);
    };
    Known values(1, g, g);
    EventSearch search({0});
    const auto found = find_all(search, values, 0.0, 2 * pi, 4);
    int exact = 0;
    Vector old(1), now(1);
    g(0.0, old);
    for (int i = 1; i <= 20000; ++i) {
      g(2 * pi * i / 20000.0, now);
      exact += old[0] * now[0] < 0.0 ? 1 : 0;
      old = now;
    }
    missed += std::abs(exact - static_cast<int>(found.size()));
    total += exact;
  }
  EXPECT_GT(total, 1000);
  EXPECT_EQ(missed, 0) << "of " << total;
}

TEST(EventSearch, GoesOnFromAnArchive) {
  const auto g = [](double t, Vector& values) { values[0] = std::sin(t), values[1] = std::cos(2 * t); };
  Known values(2, g, g), restored_values(2, g, g);
  EventSearch plain({0, 0});
  plain.start(values, 0.1, 1e-14);
  for (double to : {0.5, 2.0, 3.0, 5.0, 9.0}) {
    Archive counter = Archive::counter();
    plain.archive(counter);
    Vector saved(counter.size());
    Archive writer = Archive::writer(saved.data(), saved.size());
    plain.archive(writer);
    EventSearch restored({0, 0});
    Archive reader = Archive::reader(saved.data(), saved.size());
    restored.archive(reader);
    EXPECT_EQ(plain.search(values, to, 3), restored.search(restored_values, to, 3));
    EXPECT_EQ(plain.t(), restored.t());
    EXPECT_EQ(plain.fired(), restored.fired());
  }
}

}  // namespace
