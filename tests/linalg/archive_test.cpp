// SPDX-License-Identifier: BSD-3-Clause
#include "linalg/archive.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

using namespace sfdae::core;

namespace {

enum class Colour { red, green };

struct State {
  int small = 0, negative = 0, large = 0, fourth = 0;
  bool flag = false;
  Colour colour = Colour::red;
  long count = 0, other = 0;
  double real = 0.0;
  std::vector<double> vector;

  void archive(Archive& archive) {
    archive.small(small, negative, large, fourth, flag, colour);
    archive.counts(count, other);
    archive.real(real);
    archive.reals(vector, 3);
  }
};

State example() {
  return {7,
          -1,
          65534,
          0,
          true,
          Colour::green,
          (1L << 26) - 1,
          12345L,
          -std::numeric_limits<double>::infinity(),
          {1.0, -0.0, 1e-310}};
}

std::vector<double> written(State state) {
  Archive counter = Archive::counter();
  state.archive(counter);
  std::vector<double> values(counter.size());
  Archive writer = Archive::writer(values.data(), values.size());
  state.archive(writer);
  EXPECT_EQ(writer.size(), counter.size());
  return values;
}

TEST(Archive, ReadsWhatItWrote) {
  const std::vector<double> values = written(example());
  EXPECT_EQ(values.size(), 2u + 1u + 1u + 3u);  // six small numbers in two doubles
  State read;
  Archive reader = Archive::reader(values.data(), values.size());
  read.archive(reader);
  const State expected = example();
  EXPECT_EQ(read.small, expected.small);
  EXPECT_EQ(read.negative, expected.negative);
  EXPECT_EQ(read.large, expected.large);
  EXPECT_EQ(read.fourth, expected.fourth);
  EXPECT_EQ(read.flag, expected.flag);
  EXPECT_EQ(read.colour, expected.colour);
  EXPECT_EQ(read.count, expected.count);
  EXPECT_EQ(read.other, expected.other);
  EXPECT_EQ(read.real, expected.real);
  EXPECT_EQ(read.vector, expected.vector);
}

TEST(Archive, NeverReadsBeyondTheEnd) {
  const std::vector<double> values = written(example());
  for (std::size_t length = 0; length < values.size(); ++length) {
    State read;
    Archive reader = Archive::reader(values.data(), length);
    EXPECT_THROW(read.archive(reader), DamagedArchive) << length;
  }
}

TEST(Archive, RefusesNaNEverywhere) {
  const std::vector<double> intact = written(example());
  for (std::size_t at = 0; at < intact.size(); ++at) {
    std::vector<double> values = intact;
    values[at] = std::numeric_limits<double>::quiet_NaN();
    State read;
    Archive reader = Archive::reader(values.data(), values.size());
    EXPECT_THROW(read.archive(reader), DamagedArchive) << at;
  }
}

TEST(Archive, RefusesNumbersThatItCannotHaveWritten) {
  for (double wrong :
       {0.5, -1.0, 1e300, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (std::size_t at : {0u, 2u}) {
      std::vector<double> values = written(example());
      values[at] = wrong;
      State read;
      Archive reader = Archive::reader(values.data(), values.size());
      EXPECT_THROW(read.archive(reader), DamagedArchive) << wrong << " at " << at;
    }
  }
}

}  // namespace
