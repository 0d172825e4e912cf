// SPDX-License-Identifier: BSD-3-Clause
// Entries of a function and its supplied derivative: the loop over all of them at once says what is said one by one.
#include "problem/supplied_line.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "linalg/index.h"
#include "linalg/random.h"

namespace sfdae::core {

namespace {

// Entry e: size sin(rate t + phase), or something that is not smooth, not finite, zero or constant; its derivative
// times `factor`.
struct LineEntry {
  int kind;
  double size, rate, phase, factor;
  double value(double t) const {
    switch (kind) {
      case 0: return 0.0;
      case 1: return size;
      case 2: return std::numeric_limits<double>::quiet_NaN();
      case 3: return 1e200 * size;
      case 4: return size * std::fabs(t - 0.3004);
      default: return size * std::sin(rate * t + phase);
    }
  }
  double derivative(double t) const {
    switch (kind) {
      case 0:
      case 1: return factor == 1.0 ? 0.0 : factor - 1.0;
      case 2: return 1.0;
      case 3: return 0.0;
      case 4: return t < 0.3004 ? -size : size;
      default: return factor * size * rate * std::cos(rate * t + phase);
    }
  }
};

std::vector<LineEntry> random_entries(int count, unsigned seed) {
  std::minstd_rand generator(seed);
  std::vector<LineEntry> entries;
  for (int e = 0; e < count; ++e) {
    const int kind = static_cast<int>(generator() % 40);
    const double size = std::exp2(20.0 * symmetric_random(generator));
    const double rate = std::exp2(8.0 * symmetric_random(generator));
    const double factor = generator() % 8 == 0 ? 1.0 + std::exp2(10.0 * symmetric_random(generator) - 6.0) : 1.0;
    entries.push_back({kind, size, rate, symmetric_random(generator), factor});
  }
  return entries;
}

// terms: the size of values is given for each entry, which are then looked at one by one; none is larger than a value.
std::vector<int> unconfirmed(const std::vector<LineEntry>& entries, double origin, double reach, bool with_terms) {
  const int count = static_cast<int>(entries.size());
  SuppliedLine line{count, count, origin, reach, {}, std::vector<double>(2 * entries.size())};
  line.evaluate = [&](double offset, double* values) {
    for (std::size_t e = 0; e < entries.size(); ++e) {
      values[e] = entries[e].value(origin + offset);
      values[e + entries.size()] = entries[e].derivative(origin + offset);
    }
    return CallbackError{};
  };
  line.evaluate(0.0, line.base.data());
  if (with_terms) line.terms.assign(entries.size(), 0.0);
  return unconfirmed_entries(line);
}

}  // namespace

TEST(SuppliedLine, EntriesAtOnceAreJudgedAsOneByOne) {
  int found = 0;
  for (unsigned seed = 1; seed <= 60; ++seed)
    for (int count : {1, 7, 513, 1500}) {
      // Numbers that are not finite do not share a block with all others.
      std::vector<LineEntry> entries = random_entries(count, seed);
      if (seed % 2 == 0)
        for (LineEntry& entry : entries) entry.kind = entry.kind == 2 || entry.kind == 3 ? 5 : entry.kind;
      const double origin = seed % 3 == 0 ? 0.0 : 0.3, reach = seed % 5 == 0 ? -2.0 : 1.0;
      const std::vector<int> at_once = unconfirmed(entries, origin, reach, false);
      EXPECT_EQ(at_once, unconfirmed(entries, origin, reach, true)) << "seed " << seed << ", " << count;
      found += static_cast<int>(at_once.size());
    }
  EXPECT_GT(found, 1000);
}

}  // namespace sfdae::core
