// SPDX-License-Identifier: BSD-3-Clause
// Sparse factors that go on from an archive: with the same pivots, in every bit.
#include "linalg/known_pivots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "linalg/index.h"
#include "linalg/planned_lu.h"
#include "linalg/random.h"

namespace {

using namespace sfdae::core;
using Vector = std::vector<double>;

// Four entries in each column.
SparsePattern pattern_of(int n) {
  SparsePattern pattern;
  pattern.size = n;
  pattern.first.assign(1, 0);
  for (int j = 0; j < n; ++j) {
    std::vector<int> rows = {j, (j + 1) % n, (7 * j + 3) % n, (5 * j + 11) % n};
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    pattern.row.insert(pattern.row.end(), rows.begin(), rows.end());
    pattern.first.push_back(static_cast<int>(pattern.row.size()));
  }
  return pattern;
}

Vector random_values(std::size_t count, std::minstd_rand& random) {
  Vector values(count);
  for (double& value : values) value = symmetric_random(random);
  return values;
}

// Other values, for which the pivots are good enough and others would be better.
Vector near(const Vector& values, std::minstd_rand& random) {
  Vector result(values);
  for (double& value : result) value += 0.1 * symmetric_random(random);
  return result;
}

template <class Owner, class... Arguments>
Vector saved(Owner& owner, Arguments&&... arguments) {
  Archive counter = Archive::counter();
  owner.archive(counter, arguments...);
  Vector values(counter.size());
  Archive writer = Archive::writer(values.data(), values.size());
  owner.archive(writer, arguments...);
  return values;
}

TEST(KnownPivots, AreThoseOfTheFactorizationThatHasChosenThem) {
  if (!klu_is_available()) GTEST_SKIP();
  constexpr int n = 60;
  std::minstd_rand random(3);
  const SparsePattern pattern = pattern_of(n);
  const std::size_t entries = pattern.row.size();
  SparseLu<double> lu, again, fresh;
  for (SparseLu<double>* each : {&lu, &again, &fresh}) each->analyze(pattern, SparseMethod::klu);
  KnownPivots pivots, read;
  const Vector first = random_values(entries, random), second = near(first, random), b = random_values(n, random);
  ASSERT_TRUE(pivots.factor(lu, first));
  ASSERT_TRUE(pivots.factor(lu, second));
  ASSERT_FALSE(lu.has_new_pivots());
  Vector archived = saved(pivots, lu, entries);
  Archive reader = Archive::reader(archived.data(), archived.size());
  read.archive(reader, again, entries);
  EXPECT_TRUE(reader.has_ended());
  const Vector third = near(first, random);
  ASSERT_TRUE(pivots.factor(lu, third));
  ASSERT_TRUE(read.factor(again, third));
  ASSERT_TRUE(fresh.factor(third.data()));
  ASSERT_FALSE(lu.has_new_pivots());
  Vector x(b), y(b), z(b);
  lu.solve(x.data());
  again.solve(y.data());
  fresh.solve(z.data());
  EXPECT_EQ(x, y);
  EXPECT_NE(x, z);  // as pivots of its own give other roundings
}

TEST(KnownPivots, AreNoneAfterASingularMatrix) {
  if (!klu_is_available()) GTEST_SKIP();
  constexpr int n = 30;
  std::minstd_rand random(4);
  const SparsePattern pattern = pattern_of(n);
  SparseLu<double> lu;
  lu.analyze(pattern, SparseMethod::klu);
  KnownPivots pivots;
  const Vector regular = random_values(pattern.row.size(), random);
  ASSERT_TRUE(pivots.factor(lu, regular));
  const std::size_t length = saved(pivots, lu, pattern.row.size()).size();
  EXPECT_FALSE(pivots.factor(lu, Vector(regular.size(), 0.0)));
  EXPECT_LT(saved(pivots, lu, pattern.row.size()).size(), length);
  ASSERT_TRUE(pivots.factor(lu, regular));
  EXPECT_TRUE(lu.has_new_pivots());
}

TEST(PlannedLu, GoesOnWithThePivotsOfAnArchive) {
  constexpr int n = 40;
  std::minstd_rand random(5);
  const SparsePattern pattern = pattern_of(n);
  PlannedLu planned, again, fresh;
  for (PlannedLu* each : {&planned, &again, &fresh}) each->analyze(pattern);
  const Vector first = random_values(pattern.row.size(), random), b = random_values(3 * n, random);
  Vector x(3 * n), y(3 * n), z(3 * n);
  ASSERT_TRUE(planned.solve(first.data(), b.data(), 3, x.data()));
  Vector archived = saved(planned);
  Archive reader = Archive::reader(archived.data(), archived.size());
  again.archive(reader);
  EXPECT_TRUE(reader.has_ended());
  for (int k = 0; k < 20; ++k) {
    const Vector next = near(first, random);
    ASSERT_EQ(planned.solve(next.data(), b.data(), 3, x.data()), again.solve(next.data(), b.data(), 3, y.data()));
    EXPECT_EQ(x, y) << k;
    EXPECT_EQ(planned.plans(), again.plans());
    EXPECT_EQ(planned.is_suitable(), again.is_suitable());
  }
  // Pivots of its own give other roundings.
  const Vector last = near(first, random);
  ASSERT_TRUE(planned.solve(last.data(), b.data(), 3, x.data()));
  ASSERT_TRUE(fresh.solve(last.data(), b.data(), 3, z.data()));
  EXPECT_NE(x, z);
}

TEST(PlannedLu, RefusesAnArchiveOfAMatrixThatCannotBeFactored) {
  const SparsePattern pattern = pattern_of(20);
  std::minstd_rand random(6);
  PlannedLu planned;
  planned.analyze(pattern);
  ASSERT_TRUE(planned.plan(random_values(pattern.row.size(), random).data()));
  Vector archived = saved(planned);
  std::fill(archived.end() - static_cast<std::ptrdiff_t>(pattern.row.size()), archived.end(), 0.0);
  PlannedLu other;
  other.analyze(pattern);
  Archive reader = Archive::reader(archived.data(), archived.size());
  EXPECT_THROW(other.archive(reader), DamagedArchive);
}

}  // namespace
