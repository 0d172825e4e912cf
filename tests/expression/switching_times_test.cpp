// SPDX-License-Identifier: BSD-3-Clause
// Switching times of random functions of t, against branches at many points; pulses, however short; touching zeros.
#include "expression/switching_times.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <vector>

#include "expression/spline.h"
#include "expression/taylor_evaluator.h"
#include "linalg/quiet_arithmetic.h"
#include "recorded.h"

namespace sfdae::core {

namespace {

using namespace sfdae_test;

std::unique_ptr<TaylorEvaluator> evaluator_of(Recording& r, const std::vector<Term>& inputs) {
  Term sum(0.0);
  for (const Term& input : inputs) sum = sum + r.x[0] * input;
  return std::make_unique<TaylorEvaluator>(r.finish({r.xdot[0] - sum}));
}

// All gaps from one time to another, in that order, as steps of `step` find them; as far as they are known.
struct Known {
  std::vector<SwitchingGap> gaps;
  bool is_all = true;
};
Known all_known(const TaylorEvaluator& evaluator, double from, double to, double step) {
  SwitchingTimes times({&evaluator});
  times.set_size(std::max(std::fabs(from), std::fabs(to)));
  const double direction = to > from ? 1.0 : -1.0;
  Known known;
  std::vector<SwitchingGap>& found = known.gaps;
  double t = from;
  while ((to - t) * direction > 0.0) {
    const double toward = t + direction * std::min(step, std::fabs(to - t));
    std::vector<SwitchingGap> gaps = times.find(t, toward);
    if (direction < 0.0) std::reverse(gaps.begin(), gaps.end());
    double next = (times.known_to() - toward) * direction < 0.0 ? times.known_to() : toward;
    for (const SwitchingGap& gap : gaps) {
      const double near = direction > 0.0 ? gap.start : gap.end, far = direction > 0.0 ? gap.end : gap.start;
      if ((far - t) * direction <= 0.0 || (near - next) * direction > 0.0) continue;
      if (found.empty() || gap.start != found.back().start) found.push_back(gap);
      next = far;
      break;
    }
    known.is_all = next != t;
    if (!known.is_all) break;
    t = next;
  }
  return known;
}

std::vector<SwitchingGap> all_gaps(const TaylorEvaluator& evaluator, double from, double to, double step) {
  Known known = all_known(evaluator, from, to, step);
  EXPECT_TRUE(known.is_all);
  return known.gaps;
}

class RandomFunction {
 public:
  RandomFunction(Recording& recording, unsigned seed) : r_(recording), random_(seed) {}

  Term function(int depth) {
    if (depth == 0) return (number(3) == 0 ? 1e-3 : real(0.3, 2.0)) * r_.t + real(-1.0, 1.0);
    const Term a = function(depth - 1) + 0.1 * r_.t;
    switch (number(14)) {
      case 0: return a + function(depth - 1);
      case 1: return a - function(depth - 1);
      case 2: return 0.5 * a * function(depth - 1);
      case 3: return sin(real(0.5, 20.0) * a);
      case 4: return cos(a);
      case 5: return exp(0.1 * sin(a));
      case 6: return a / (2.0 + cos(function(depth - 1)));
      case 7: return abs(a);
      case 8: return max(a, Term(real(-1.0, 1.0)));
      case 9: return min(a, function(depth - 1));
      case 10: return floor(a);
      case 11: return modulo(a, Term(real(0.3, 2.0)));
      case 12: return choose(a, function(depth - 1), Term(real(-1.0, 1.0)));
      default: return choose(a, Term(1.0), Term(0.0)) * function(depth - 1);
    }
  }

 private:
  int number(int count) { return static_cast<int>(random_() % static_cast<unsigned>(count)); }
  double real(double a, double b) { return a + (b - a) * static_cast<double>(random_()) / 4294967296.0; }

  Recording& r_;
  std::mt19937 random_;
};

// Samples in a gap, and those at which rounding errors decide, say nothing.
struct Counts {
  long switches = 0, missed = 0, invented = 0, unknown = 0;
};

void compare(const TaylorEvaluator& evaluator, double from, double to, Counts& counts) {
  const QuietArithmetic quiet;
  SwitchingFunctions functions(evaluator);
  if (functions.count() == 0) return;
  Known known = all_known(evaluator, from, to, 0.37);
  if (!known.is_all) {
    ++counts.unknown;
    return;
  }
  std::vector<SwitchingGap>& gaps = known.gaps;
  if (from > to) std::reverse(gaps.begin(), gaps.end());
  counts.switches += static_cast<long>(gaps.size());
  constexpr int samples = 3000;
  std::vector<Branch> before(functions.count()), now(before);
  const auto differ = [&] {
    for (std::size_t k = 0; k < now.size(); ++k)
      if (before[k].is_used && now[k].is_used && std::fabs(before[k].number - now[k].number) > 0.0) return true;
    return false;
  };
  std::size_t next_gap = 0;
  bool has_before = false;
  for (int i = 0; i <= samples; ++i) {
    const double t = std::min(from, to) + std::fabs(to - from) * i / samples;
    while (next_gap < gaps.size() && gaps[next_gap].end < t) ++next_gap, has_before = false;
    functions.find_branches(Interval::of(t), now.data());
    if (next_gap < gaps.size() && gaps[next_gap].start < t) continue;
    if (has_before && differ()) ++counts.missed;
    before = now;
    has_before = true;
  }
  for (const SwitchingGap& gap : gaps) {
    functions.find_branches(Interval::of(gap.start), before.data());
    functions.find_branches(Interval::of(gap.end), now.data());
    bool is_known = true;
    for (std::size_t k = 0; k < now.size(); ++k)
      if ((before[k].is_used && std::isnan(before[k].number)) || (now[k].is_used && std::isnan(now[k].number)))
        is_known = false;
    if (is_known && !differ()) ++counts.invented;
  }
}

TEST(SwitchingTimes, OfRandomFunctionsAreAllFound) {
  Counts counts;
  for (unsigned seed = 1; seed <= 150; ++seed) {
    Recording recording(1);
    RandomFunction random(recording, seed);
    const auto evaluator = evaluator_of(recording, {random.function(4), random.function(3)});
    SCOPED_TRACE(seed);
    if (seed % 3 == 0) compare(*evaluator, 3.0, -2.0, counts);
    else compare(*evaluator, -2.0, 3.0, counts);
  }
  EXPECT_GT(counts.switches, 1500);
  EXPECT_EQ(counts.missed, 0);
  EXPECT_EQ(counts.invented, 0);
  // As floor(a - modulo(a, 0.7)), which rounding errors decide.
  EXPECT_LE(counts.unknown, 3);
}

Term is_above(const Term& a) { return choose(a, Term(1.0), Term(0.0)); }

Term pulse(const Recording& r, double start, double width) {
  return is_above(r.t - start) * is_above(start + width - r.t);
}

TEST(SwitchingTimes, OfPulsesAreFoundHoweverShortTheyAre) {
  for (const double width : {1e-9, 1e-6, 1e-3}) {
    Recording r(1);
    std::mt19937 random(7);
    std::vector<double> edges;
    std::vector<Term> inputs;
    for (int i = 0; i < 10; ++i) {
      Term input(0.0);
      for (int k = 0; k < 10; ++k) {
        const double start = static_cast<double>(random()) / 4294967296.0;
        input = input + pulse(r, start, width);
        edges.insert(edges.end(), {start, start + width});
      }
      inputs.push_back(input);
    }
    const auto evaluator = evaluator_of(r, inputs);
    const std::vector<SwitchingGap> gaps = all_gaps(*evaluator, 0.0, 1.1, 1.0);
    std::sort(edges.begin(), edges.end());
    ASSERT_EQ(gaps.size(), edges.size()) << width;
    for (std::size_t k = 0; k < gaps.size(); ++k) {
      EXPECT_GE(edges[k], gaps[k].start);
      EXPECT_LE(edges[k], gaps[k].end);
      EXPECT_LE(gaps[k].end - gaps[k].start, 1e-13);
    }
  }
}

TEST(SwitchingTimes, AreNoneWhereZerosAreTouchedOrBranchesNotUsed) {
  const auto gaps_of = [](auto input_of) {
    Recording r(1);
    const auto evaluator = evaluator_of(r, {input_of(r.t)});
    return all_gaps(*evaluator, 0.01, 10.0, 0.7).size();
  };
  EXPECT_EQ(gaps_of([](const Term& t) { return is_above(-pow(t - 1.0, 2.0)); }), 0u);
  EXPECT_EQ(gaps_of([](const Term& t) { return is_above(2.0 * t - t * t - 1.0); }), 0u);
  EXPECT_EQ(gaps_of([](const Term& t) { return is_above(max(t - 5.0, Term(0.0))); }), 1u);
  // A fast signal that counts up to t = 1.
  EXPECT_EQ(gaps_of([](const Term& t) { return choose(1.0 - t, modulo(t, Term(0.125)), Term(0.0)); }), 8u);
}

// From one end to the other and back, in steps that are short at first.
TEST(SwitchingTimes, AreTheEndsOfDataToo) {
  const std::function<Term(const Term&)> arguments[] = {
      [](const Term& t) { return t; },
      [](const Term& t) { return 5.0 - 0.5 * (10.0 - 2.0 * t); },
      [](const Term& t) { return min(max(t, Term(0.0)), Term(10.0)); },
  };
  for (const auto& argument : arguments)
    for (const double first_step : {1e-13, 1e-7, 1.0})
      for (const bool is_forward : {true, false}) {
        Recording r(1);
        const auto table = Spline::through({1, {0.0, 3.0, 7.0, 10.0}, {0.0, 1.0, 0.0, 2.0}});
        const auto evaluator = evaluator_of(r, {call(table, {argument(r.t)})});
        SwitchingTimes times({evaluator.get()});
        times.set_size(10.0);
        double t = is_forward ? 0.0 : 10.0, step = first_step;
        const double end = is_forward ? 10.0 : 0.0, direction = is_forward ? 1.0 : -1.0;
        int found = 0;
        while ((end - t) * direction > 1e-14) {
          const double toward = t + direction * step;
          bool is_gap = false;
          double next = toward;
          for (const SwitchingGap& gap : times.find(t, toward)) {
            const double near = is_forward ? gap.start : gap.end, far = is_forward ? gap.end : gap.start;
            if ((far - t) * direction <= 0.0 || (near - toward) * direction > 0.0) continue;
            if (is_gap && (far - next) * direction > 0.0) continue;
            next = far;
            is_gap = true;
          }
          ASSERT_NE(times.known_to(), t);
          found += is_gap ? 1 : 0;
          t = next;
          step *= 2.0;
        }
        EXPECT_NEAR(t, end, 1e-12);
        EXPECT_GE(found, 3);
      }
}

TEST(SwitchingTimes, ThatAreRoundingErrorsAloneAreNamed) {
  Recording r(1);
  const auto evaluator = evaluator_of(r, {is_above(pow(sin(r.t), 2.0) + pow(cos(r.t), 2.0) - 1.0)});
  EXPECT_FALSE(all_known(*evaluator, 0.0, 1.0, 0.1).is_all);
}

}  // namespace

}  // namespace sfdae::core
